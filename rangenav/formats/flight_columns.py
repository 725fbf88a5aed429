"""A recorded flight from raw columns. Where the file leaves units, frame or faulty rows open, there is a question."""

from collections.abc import Mapping
from dataclasses import field

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.formats import units
from rangenav.formats.import_result import (
    ImportResult,
    Question,
    answer,
    broken_lines,
    kept_rows,
    last_row_twice,
    lines,
    repeated,
    spacing,
)
from rangenav.formats.recorded_flight import Flight, Frame
from rangenav.formats.text import Table
from rangenav.inputs import Vec3, require
from rangenav.results import result

FRAMES = ("z-up", "z-down")
LEAST_ROWS = 8
ROUNDED = 0.2
"""Largest share of repeated stamps. With more of them, dropping lines would not repair the record."""
LARGEST = 1e9
"""Largest value, in any unit; stamps may be larger."""
REST = 3.0
"""s from the start, in which a vehicle usually rests: the accelerometer's reading there tells which way is up."""


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
    """(stamps, distances) in s and m, if ranges have a file of their own."""
    rotation: Float[Array, "n 3 3"] | None = None
    position: Float[Array, "n 3"] | None = None
    moving: Bool[Array, "n"] | None = None
    stated: Mapping[str, str] = field(default_factory=dict)
    frame: Frame | None = None
    gravity: Vec3 | None = None
    magnetic: Vec3 | None = None
    anchor: Vec3 | None = None
    findings: tuple[str, ...] = ()


def flight(raw: FlightColumns, confirm: Mapping[str, str]) -> ImportResult:
    """The flight, or the questions that are open. Raises ValueError for faults that no answer can correct."""
    table, questions, findings = raw.table, [], list(raw.findings)
    require(len(raw.time) >= LEAST_ROWS, f"{table.source}: {len(raw.time)} rows are no record")
    for name in ("gyro", "accel", "mag", "range"):
        values = getattr(raw, name)
        if values is not None:
            size = float(np.max(np.abs(np.nan_to_num(values)), initial=0.0))
            require(size <= LARGEST, f"{table.source}: {name} must not exceed {LARGEST:g}, got {size:.3g}")
    kept, ranged = _kept(raw, confirm, questions, findings)
    require(int(kept.sum()) >= LEAST_ROWS, f"{table.source}: {int(kept.sum())} usable rows are no record")
    factors = _factors(raw, kept, confirm, questions, findings)
    frame = _frame(raw, kept, confirm, questions)
    if raw.mag is None:
        findings.append("no magnetometer: the attitude about the vertical cannot be observed")
    elif np.isnan(raw.mag).all():
        findings.append("the magnetometer's columns are empty")
    time = (raw.time[kept] - raw.time[kept][0]) * factors["time"]
    rate = spacing(time, kept_rows(table, kept), findings)
    recorded = None if questions else _flight(raw, kept, ranged, time, factors, frame, findings)
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


def _kept(
    raw: FlightColumns, confirm: Mapping[str, str], questions: list[Question], findings: list[str]
) -> tuple[Bool[Array, "n"], Bool[Array, "n"]]:
    """Masks of the rows whose IMU and of the rows whose range can be used. Other rows are dropped only if confirmed."""
    imu = np.isfinite(np.column_stack([raw.gyro, raw.accel]))
    stamped = np.isfinite(raw.time)
    distance = stamped & np.isfinite(raw.range) if raw.range is not None else np.zeros_like(stamped)
    between = ~imu.any(axis=-1) & distance  # a range with a row of its own
    missing = ~(imu.all(axis=-1) & stamped) & ~between
    twice = last_row_twice(np.column_stack([raw.time, raw.gyro, raw.accel, raw.table.values]))
    if twice.any():
        findings.append(f"the last row repeats the row before it: {lines(raw.table.lines[-1:])} is not used")
    missing &= ~twice
    again = np.zeros_like(missing)
    again[~missing & ~twice] = repeated(raw.time[~missing & ~twice])
    share = float(again.mean())
    rule = f"{raw.table.source}: {share:.0%} of the stamps repeat or go back: rounded, as spreadsheets do, or no clock"
    require(share <= ROUNDED, rule)
    faults = []
    if missing.any():
        faults.append(f"numbers are missing on {lines(raw.table.lines[missing])}")
    if again.any():
        faults.append(f"stamps repeat or go back on {lines(raw.table.lines[again])}")
    if faults:
        questions += broken_lines(" and ".join(faults), confirm, findings)
    whole = ~(missing | again | twice)
    return np.asarray(whole & ~between), np.asarray(whole & distance)


def _factors(
    raw: FlightColumns, kept: Array, confirm: Mapping[str, str], questions: list[Question], findings: list[str]
) -> dict[str, float]:
    """Factors from the file's units to SI. A stated SI unit is used; every other unit must be confirmed."""
    factors, time = {}, raw.time[kept]
    turning = raw.mag if raw.mag is not None and np.isfinite(raw.mag).any() else raw.accel
    turning_name = "the field" if turning is raw.mag else "gravity"
    for kind, known in units.UNITS.items():
        values = getattr(raw, kind)
        if values is None:
            continue
        stated, answered = raw.stated.get(kind), answer(confirm, kind, tuple(known))
        columns = values[kept] if values.ndim == 2 else values[kept][:, None]
        guess = units.guess(kind, columns, time=time, turning=turning[kept], turning_name=turning_name)
        chosen = answered or stated
        if answered is None and (stated != units.SI[kind] or _doubtful(kind, guess)):
            questions.append(_unit_question(kind, stated, guess))
            chosen = stated or guess.unit
        factors[kind] = known.get(chosen or units.SI[kind], 1.0)
        how = "as confirmed" if answered else f'the file says "{stated}"' if stated else "not stated"
        findings.append(f"{units.WORDS[kind]}: {chosen or 'unit unknown'}, {how}")
    return factors


def _doubtful(kind: str, guess: units.Guess) -> bool:
    """Whether the data contradict a stated SI unit, by the size of gravity or by the turn of the magnetic field."""
    return kind in ("accel", "gyro") and guess.unit is not None and guess.unit != units.SI[kind]


def _unit_question(kind: str, stated: str | None, guess: units.Guess) -> Question:
    stated_text = f'the file says "{stated}"; ' if stated else "the file does not say; "
    known = tuple(units.UNITS[kind])
    suggestion = guess.unit or (stated if stated in known else None)
    return Question(
        key=kind,
        flag=units.FLAGS[kind],
        asks=f"in which unit {'are' if kind in ('time', 'range') else 'is'} {units.WORDS[kind]}",
        options=known,
        suggestion=suggestion,
        evidence=stated_text + guess.evidence,
    )


def _frame(raw: FlightColumns, kept: Array, confirm: Mapping[str, str], questions: list[Question]) -> Frame:
    answered = answer(confirm, "frame", FRAMES)
    if answered is not None or raw.frame is not None:
        return "z-down" if (answered or raw.frame) == "z-down" else "z-up"
    rest = raw.accel[kept][: max(1, int(np.sum(kept) // 50))].mean(axis=0)
    axis = int(np.argmax(np.abs(rest)))
    up = axis == 2 and rest[2] > 0
    down = axis == 2 and rest[2] < 0
    at = f"at first the accelerometer reads ({rest[0]:.3g}, {rest[1]:.3g}, {rest[2]:.3g})"
    suggestion = "z-up" if up else "z-down" if down else None
    evidence = (
        f"{at}, so the body's z points {'up' if up else 'down'}" if suggestion else f"{at}, which points along no z"
    )
    asks = "which way does the world's z point"
    questions.append(
        Question(key="frame", flag="--frame", asks=asks, options=FRAMES, suggestion=suggestion, evidence=evidence)
    )
    return "z-down" if down else "z-up"


def _flight(
    raw: FlightColumns,
    kept: Array,
    ranged: Array,
    time: Array,
    factors: dict[str, float],
    frame: Frame,
    findings: list[str],
) -> Flight:
    range_time, distance = np.empty(0), np.empty(0)
    first = raw.time[kept][0]
    if raw.range is not None:
        range_time, distance = (raw.time[ranged] - first) * factors["time"], raw.range[ranged] * factors["range"]
    elif raw.ranges is not None:
        range_time, distance = raw.ranges[0] - first * factors["time"], raw.ranges[1]
    inside = (range_time >= time[0]) & (range_time <= time[-1])
    range_time, distance = range_time[inside], distance[inside]
    if len(distance) == 0:
        findings.append("no ranges")
    mag = None
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
    )
