"""A recorded flight from raw columns. Where the file leaves units, frame or faulty rows open, there is a question."""

from collections.abc import Mapping
from dataclasses import field, replace

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.formats import stamps, units
from rangenav.formats.flight_rows import FlightRows, used_rows, with_own_rows
from rangenav.formats.import_result import (
    ImportResult,
    Question,
    answer,
    kept_rows,
    lines,
    spacing,
)
from rangenav.formats.recorded_flight import Flight, Frame
from rangenav.formats.text import Table
from rangenav.inputs import Vec3, require
from rangenav.number_format import vector
from rangenav.results import result

FRAMES = ("z-up", "z-down")
LEAST_ROWS = 8
UPRIGHT = 0.9
"""Least cosine between the mean specific force and the vertical for an attitude that tells which way z points."""
LARGEST = 1e9
"""Largest value, in any unit; stamps may be larger."""


@result
class FlightColumns:
    """The columns of a file, unchanged; `stated` holds the units that the file states."""

    table: Table
    """The table that the columns come from; messages name its lines."""
    format: str
    time: Float[Array, "n"]
    gyro: Float[Array, "n 3"]
    accel: Float[Array, "n 3"]
    mag: Float[Array, "n 3"] | None = None
    range: Float[Array, "n"] | None = None
    """m, on the rows of the table; NaN in rows without a range."""
    ranges: tuple[Float[Array, "m"], Float[Array, "m"]] | None = None
    """(stamps, distances) in the unit of `time` and in m, if ranges have a file of their own."""
    rotation: Float[Array, "n 3 3"] | None = None
    position: Float[Array, "n 3"] | None = None
    moving: Bool[Array, "n"] | None = None
    stated: Mapping[str, str] = field(default_factory=dict)
    frame: Frame | None = None
    gravity: Vec3 | None = None
    magnetic: Vec3 | None = None
    anchor: Vec3 | None = None
    findings: tuple[str, ...] = ()
    unconfirmed: tuple[str, ...] = ()
    """Columns of `rotation` and `position` whose names do not say that they are the truth."""
    of_format: tuple[str, ...] = ()
    """Quantities whose unit is that of the format; it is asked only if the numbers contradict it."""
    questions: tuple[Question, ...] = ()
    """What the names of the columns leave open."""


def flight(raw: FlightColumns, confirm: Mapping[str, str]) -> ImportResult:
    """The flight, or the questions that are open. Raises ValueError for faults that no answer can correct."""
    table, questions, findings = raw.table, list(raw.questions), list(raw.findings)
    _require_rows(len(raw.time), "", table.source)
    for name in ("gyro", "accel", "mag", "range"):
        values = getattr(raw, name)
        if values is not None:
            size = float(np.max(np.abs(np.nan_to_num(values)), initial=0.0))
            require(size <= LARGEST, f"{table.source}: {name} must not exceed {LARGEST:g}, got {size:.3g}")
    raw = _unwrapped(raw, confirm, questions, findings)
    others = tuple(values for values in (raw.mag, raw.rotation, raw.position) if values is not None)
    imu = np.column_stack([raw.gyro, raw.accel])
    rows = used_rows(table, raw.time, imu, raw.range, others, confirm, questions, findings)
    kept = rows.imu
    _require_rows(int(kept.sum()), " with a stamp, gyro and accelerometer", table.source)
    raw = _with_own_rows(raw, rows)
    chosen = _units(raw, kept, confirm, questions, findings)
    frame = _frame(raw, kept, confirm, questions)
    if raw.frame not in (None, frame):
        findings.append(f"frame: {frame} instead of {raw.frame} in the file, as confirmed")
    if raw.mag is None:
        findings.append("no magnetometer: the attitude about the vertical cannot be observed")
    elif np.isnan(raw.mag).all():
        findings.append("the magnetometer's columns are empty")
    time = (raw.time[kept] - raw.time[kept][0]) * units.UNITS["time"][chosen["time"]]
    rate = spacing(time, kept_rows(table, kept), findings)
    recorded = None if questions else _flight(raw, rows, time, chosen, frame, findings)
    return ImportResult(
        source=table.source,
        format=raw.format,
        rows=len(raw.time),
        rate=rate,
        duration=float(time[-1] - time[0]),
        frame=frame,
        findings=tuple(findings),
        questions=tuple(questions),
        flight=recorded,
    )


def _require_rows(count: int, kind: str, source: str) -> None:
    there = f"1 row{kind} is" if count == 1 else f"{count} rows{kind} are"
    require(count >= LEAST_ROWS, f"{source}: {there} no record, which has {LEAST_ROWS} rows at least")


def _unwrapped(
    raw: FlightColumns, confirm: Mapping[str, str], questions: list[Question], findings: list[str]
) -> FlightColumns:
    """The columns with stamps that go on where the clock began again, which has to be confirmed."""
    wraps = stamps.wraps(raw.time)
    if wraps is None:
        return raw
    times = "once" if len(wraps.rows) == 1 else f"{len(wraps.rows)} times"
    before = lines(raw.table.lines[wraps.rows])
    evidence = f"the clock goes back {times} by its period of {wraps.period:.10g} ({wraps.name}), before {before}"
    answered = answer(confirm, "stamps", stamps.UNWRAP)
    if answered is None:
        asks = "may the stamps go on where the clock began again"
        options = stamps.UNWRAP
        questions.append(
            Question(
                key="stamps", flag="--stamps", asks=asks, options=options, suggestion=options[0], evidence=evidence
            )
        )
    else:
        findings.append(f"{evidence}: unwrapped, as asked")
    return replace(raw, time=wraps.unwrapped(raw.time))


def _with_own_rows(raw: FlightColumns, rows: FlightRows) -> FlightColumns:
    """The columns with field and truth of rows of their own on the nearest row of the IMU."""
    filled = {
        name: None if values is None else with_own_rows(raw.time, values, rows)
        for name, values in (("mag", raw.mag), ("rotation", raw.rotation), ("position", raw.position))
    }
    return replace(raw, **filled)


def _units(
    raw: FlightColumns, kept: Array, confirm: Mapping[str, str], questions: list[Question], findings: list[str]
) -> dict[str, str]:
    """The unit of each quantity. A stated SI unit is used if nothing contradicts it, another unit if the data agree.

    Every other unit must be confirmed. The magnetometer is divided by its own length, so that its unit changes nothing.
    """
    used, time, seconds = {}, raw.time[kept], raw.time[kept]
    turning = raw.mag if raw.mag is not None and np.isfinite(raw.mag).any() else raw.accel
    turning_name = "the field" if turning is raw.mag else "gravity"
    for kind, known in units.UNITS.items():
        values = getattr(raw, kind)
        if values is None:
            continue
        stated, answered = raw.stated.get(kind), answer(confirm, kind, tuple(known))
        columns = values[kept] if values.ndim == 2 else values[kept][:, None]
        guess = units.guess(kind, columns, time=seconds, turning=turning[kept], turning_name=turning_name)
        chosen = answered or stated
        usual = kind in raw.of_format or stated == units.SI[kind] or (kind == "mag" and stated in known)
        agreed = stated is not None and stated in known and stated == guess.unit
        if answered is None and not agreed and (not usual or _doubtful(kind, stated, guess)):
            questions.append(_unit_question(kind, stated, guess))
            chosen = stated or guess.unit
        used[kind] = chosen if chosen in known else units.SI[kind]
        if kind == "time":
            seconds = time * known[used[kind]]
        other = f' instead of "{stated}" in the file' if answered and stated in known and stated != answered else ""
        how = "as confirmed" if answered else f'the file says "{stated}"' if stated else "not stated"
        if answered is None and stated in known and stated != units.SI[kind] and kind not in raw.of_format:
            how = f"as the file states; {guess.evidence}"
        findings.append(f"{units.WORDS[kind]}: {chosen or 'unit unknown'}{other}, {how}")
    return used


def _doubtful(kind: str, stated: str | None, guess: units.Guess) -> bool:
    """Whether the data contradict a usual unit: the step of the stamps, the size of gravity, the turn of the field."""
    return kind in ("time", "accel", "gyro") and guess.unit not in (None, stated) and stated not in guess.possible


def _unit_question(kind: str, stated: str | None, guess: units.Guess) -> Question:
    stated_text = f'the file says "{stated}"; ' if stated else "the file does not say; "
    known = tuple(units.UNITS[kind])
    suggestion = guess.unit or (stated if stated in known and not guess.denied else None)
    return Question(
        key=kind,
        flag=units.FLAGS[kind],
        asks=f"in which unit {'are' if kind in ('time', 'range') else 'is'} {units.WORDS[kind]}",
        options=known,
        suggestion=suggestion,
        evidence=stated_text + guess.evidence,
    )


def _frame(raw: FlightColumns, kept: Array, confirm: Mapping[str, str], questions: list[Question]) -> Frame:
    """The inertial frame. The attitude in the file tells it; without one, body axes with z down tell nothing of it."""
    answered = answer(confirm, "frame", FRAMES)
    if answered is not None or raw.frame is not None:
        return "z-down" if (answered or raw.frame) == "z-down" else "z-up"
    suggestion, evidence = _frame_evidence(raw, kept)
    asks = "which way does the world's z point"
    questions.append(
        Question(key="frame", flag="--frame", asks=asks, options=FRAMES, suggestion=suggestion, evidence=evidence)
    )
    return "z-down" if suggestion == "z-down" else "z-up"


def _frame_evidence(raw: FlightColumns, kept: Array) -> tuple[Frame | None, str]:
    accel = raw.accel[kept]
    if raw.rotation is not None:
        force = np.einsum("nij,nj->ni", raw.rotation[kept], accel)
        force = force[np.isfinite(force).all(axis=-1)]
        mean = force.mean(axis=0) if len(force) else np.zeros(3)
        if abs(mean[2]) > UPRIGHT * np.linalg.norm(mean):
            way = "up" if mean[2] > 0 else "down"
            turned = "turned by the file's attitude, the accelerometer reads"
            return ("z-up" if way == "up" else "z-down"), f"{turned} {vector(mean)} on average: z points {way}"
    rest = accel[: max(1, len(accel) // 50)].mean(axis=0)
    at = f"at first the accelerometer reads {vector(rest)}"
    if int(np.argmax(np.abs(rest))) != 2:
        return None, f"{at}, which points along no z"
    if rest[2] > 0:
        return "z-up", f"{at}, so the body's z points up"
    return None, f"{at}: the body's z points down, in a z-down world, or upside down in a z-up world; the anchor tells"


def _flight(
    raw: FlightColumns,
    rows: FlightRows,
    time: Array,
    chosen: Mapping[str, str],
    frame: Frame,
    findings: list[str],
) -> Flight:
    kept, ranged = rows.imu, rows.ranged
    factors = {kind: units.UNITS[kind][unit] for kind, unit in chosen.items()}
    range_time, distance, range_lines = np.empty(0), np.empty(0), None
    first = raw.time[kept][0]
    if raw.range is not None:
        range_time, distance = (raw.time[ranged] - first) * factors["time"], raw.range[ranged] * factors["range"]
        range_lines = raw.table.lines[ranged]
    elif raw.ranges is not None:
        range_time, distance = (raw.ranges[0] - first) * factors["time"], raw.ranges[1]
    inside = (range_time >= time[0]) & (range_time <= time[-1])
    order = np.flatnonzero(inside)[np.argsort(range_time[inside], kind="stable")]
    range_time, distance = range_time[order], distance[order]
    if len(distance) == 0:
        findings.append("no ranges")
    mag, strength = None, 1.0
    if raw.mag is not None and np.isfinite(raw.mag[kept]).all(axis=-1).any():
        strength = float(np.nanmedian(np.linalg.norm(raw.mag[kept], axis=-1)))
        require(strength > 0, f"{raw.table.source}: the magnetometer reads nothing but zero")
        mag = raw.mag[kept] / strength
    return Flight(
        time=time,
        gyro=raw.gyro[kept] * factors["gyro"],
        accel=raw.accel[kept] * factors["accel"],
        mag=mag,
        range_time=range_time,
        range=distance,
        rotation=None if raw.rotation is None else raw.rotation[kept],
        position=None if raw.position is None else raw.position[kept],
        moving=None if raw.moving is None else raw.moving[kept],
        frame=frame,
        gravity=raw.gravity,
        magnetic=raw.magnetic,
        anchor=raw.anchor,
        unconfirmed=raw.unconfirmed,
        units=chosen,
        field_length=strength,
        lines=raw.table.lines[kept],
        range_lines=None if range_lines is None else range_lines[order],
    )
