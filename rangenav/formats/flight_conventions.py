"""The units and the inertial frame of a recorded flight: what its file states, what its data suggest, what is asked."""

from collections.abc import Mapping

import numpy as np
from numpy import ndarray as Array

from rangenav.formats import units
from rangenav.formats.import_result import Question, answer
from rangenav.formats.raw_flight import FlightColumns
from rangenav.formats.recorded_flight import Frame
from rangenav.number_format import vector

FRAMES = ("z-up", "z-down")
UPRIGHT = 0.9
"""Least cosine between the mean specific force and the vertical for an attitude that tells which way z points."""


def units_of(
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


def frame_of(raw: FlightColumns, kept: Array, confirm: Mapping[str, str], questions: list[Question]) -> Frame:
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
