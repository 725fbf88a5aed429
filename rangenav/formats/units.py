"""Units of a recorded flight: those that a header states, and those that the numbers suggest for a person to confirm.

The wild has gyros in deg/s, accelerometers in g and magnetometers in µT, often under the same column names. SI that is
stated is taken; everything else becomes a question with its evidence: the size of gravity at rest, the strength of the
earth's field, and for the gyro whether the magnetic vector turns as fast as it says: ṁ = −ω × m.
"""

import math
import re
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

UNITS: dict[str, dict[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "gyro": {"rad/s": 1.0, "deg/s": math.pi / 180},
    "accel": {"m/s2": 1.0, "g": 9.80665, "mg": 9.80665e-3},
    "mag": {"1": 1.0, "T": 1.0, "mT": 1.0, "uT": 1.0, "nT": 1.0, "G": 1.0},
    "range": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
}
"""Factors to SI; the magnetic vector is only used for its direction, so it is divided by its own length instead."""
SI = {"time": "s", "gyro": "rad/s", "accel": "m/s2", "mag": "1", "range": "m"}
FLAGS = {kind: f"--{kind}-unit" for kind in UNITS}
WORDS = {
    "time": "the stamps",
    "gyro": "the gyro",
    "accel": "the accelerometer",
    "mag": "the magnetometer",
    "range": "the ranges",
}
SPELLINGS = {
    "sec": "s", "seconds": "s", "µs": "us", "μs": "us",
    "rad s^-1": "rad/s", "rads": "rad/s", "rps": "rad/s", "dps": "deg/s", "°/s": "deg/s", "deg s^-1": "deg/s",
    "m s^-2": "m/s2", "m/s^2": "m/s2", "m/s²": "m/s2", "mps2": "m/s2", "ms2": "m/s2",
    "µt": "uT", "μt": "uT", "ut": "uT", "gauss": "G", "tesla": "T", "t": "T", "nt": "nT", "mt": "mT",
}  # fmt: skip
BRACKETED = re.compile(r"[(\[]([^()\[\]]*)[)\]]\s*$")
FIELD_STRENGTH = {"uT": (15.0, 90.0), "G": (0.15, 0.9), "T": (1.5e-5, 9e-5), "mT": (0.015, 0.09), "nT": (1.5e4, 9e4)}
"""The strength of the earth's field in each unit, with a margin for iron nearby."""
NEAR = 0.35
"""Relative: the median length of a shaken accelerometer's reading is this near to gravity."""
STEADY, REMOVED = 25, 0.2
"""Samples of a steady stretch, and the share of the median length below which its mean length is no gravity."""
LAG = 0.05
"""s between the two magnetic vectors that are compared."""
PAIRS = 4000
USUAL_STEPS = {"s": (1e-4, 0.5), "ms": (0.5, 500.0), "us": (500.0, 5e5), "ns": (5e5, 1e9)}
SLOWEST = 2.0
"""The least and the largest usual step of an IMU's stamps in each unit, and the largest in s if the file states it."""


@dataclass(frozen=True, kw_only=True)
class Guess:
    """The unit that the numbers suggest, and the evidence."""

    unit: str | None
    evidence: str
    denied: bool = False
    """Whether the numbers contradict every unit, so that none is suggested, nor the one that the file states."""
    possible: tuple[str, ...] = ()
    """Units that the numbers do not suggest, and do not contradict if the file states them."""


def split(name: str) -> tuple[str, str | None]:
    """A column's name without its unit, and the unit in brackets if there is one: `Gyroscope X (deg/s)`."""
    match = BRACKETED.search(name)
    return (name[: match.start()].strip(), spelled(match[1].strip())) if match else (name.strip(), None)


def spelled(unit: str) -> str:
    """One spelling for each unit; an unknown unit stays as it is."""
    return SPELLINGS.get(unit.lower(), unit)


def guess(
    kind: str,
    values: Float[Array, "n c"],
    *,
    time: Float[Array, "n"],
    turning: Array | None = None,
    turning_name: Literal["the field", "gravity"] = "the field",
) -> Guess:
    """The unit that the numbers suggest. For the gyro, `turning` is a vector fixed in inertia, in body axes.

    `turning_name` says what it is; "gravity" is the accelerometer's reading, which is fixed only without motion.
    """
    sizes = np.linalg.norm(values, axis=-1)
    sizes = sizes[np.isfinite(sizes)]
    size = float(np.median(sizes)) if len(sizes) else 0.0
    match kind:
        case "gyro":
            return _gyro(values, time, turning, turning_name)
        case "accel":
            return _accel(size, steadiest(values))
        case "mag":
            return _mag(size)
        case "time":
            return _time(time)
        case _:
            return Guess(unit=None, evidence=f"their median is {size:.3g}")


def steadiest(values: Float[Array, "n 3"]) -> float:
    """The length of the mean reading over the stretch of samples that varies least: at rest, gravity."""
    count = min(STEADY, len(values))
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(np.nan_to_num(values), axis=0)])
    squares = np.concatenate([[0.0], np.cumsum(np.sum(np.nan_to_num(values) ** 2, axis=-1))])
    mean = (total[count:] - total[:-count]) / count
    spread = (squares[count:] - squares[:-count]) / count - np.sum(mean**2, axis=-1)
    return float(np.linalg.norm(mean[int(np.argmin(spread))]))


def _accel(size: float, steady: float) -> Guess:
    if steady < REMOVED * size:
        evidence = f"its median length is {size:.3g}, and {steady:.3g} where it varies least: gravity was removed"
        return Guess(unit=None, evidence=evidence, denied=True)
    for unit, factor in UNITS["accel"].items():
        if abs(size * factor / 9.81 - 1) < NEAR:
            return Guess(unit=unit, evidence=f"its median length is {size:.3g}, which is gravity in {unit}")
    return Guess(unit=None, evidence=f"its median length is {size:.3g}, which is gravity in no unit known", denied=True)


def _mag(size: float) -> Guess:
    if abs(size - 1) < 0.1:
        return Guess(unit="1", evidence=f"its median length is {size:.3g}")
    for unit, (low, high) in FIELD_STRENGTH.items():
        if low <= size <= high:
            return Guess(unit=unit, evidence=f"its median length is {size:.3g}, the earth's field in {unit}")
    unknown = "the earth's field in no unit known, unless iron on the body adds to it"
    return Guess(unit=None, evidence=f"its median length is {size:.3g}, {unknown}", denied=True)


def _time(time: Array) -> Guess:
    step = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    for unit, (low, high) in USUAL_STEPS.items():
        if low <= step < high:
            rate = 1 / (step * UNITS["time"][unit])
            slow = ("s",) if unit == "ms" and step <= SLOWEST else ()
            evidence = f"their usual step is {step:.3g}, in {unit} a rate of {rate:.3g} Hz"
            return Guess(unit=unit, evidence=evidence, possible=slow)
    return Guess(unit=None, evidence=f"their usual step is {step:.3g}")


def _gyro(gyro: Array, time: Array, turning: Array | None, turning_name: Literal["the field", "gravity"]) -> Guess:
    """Regress the change of a vector fixed in inertia on −ω × it: the slope is the unit."""
    if turning is None or len(time) < 3:
        return Guess(unit=None, evidence="nothing tells it")
    lag = max(1, round(LAG / max(float(np.median(np.diff(time))), 1e-6)))
    if len(time) <= lag:
        return Guess(unit=None, evidence="the record is too short to tell it")
    k = np.unique(np.linspace(0, len(time) - lag - 1, min(PAIRS, len(time) - lag)).astype(int))
    running = np.concatenate([np.zeros((1, 3)), np.cumsum(np.nan_to_num(gyro), axis=0)])
    mean = (running[k + lag] - running[k]) / lag
    middle = (turning[k] + turning[k + lag]) / 2
    predicted = -np.cross(mean, middle) * (time[k + lag] - time[k])[:, None]
    turned = turning[k + lag] - turning[k]
    known = np.isfinite(predicted).all(axis=-1) & np.isfinite(turned).all(axis=-1)
    predicted, turned = predicted[known], turned[known]
    power = float(np.sum(predicted**2))
    if power == 0 or not math.isfinite(power):
        return Guess(unit=None, evidence="nothing turns in this record")
    slope = float(np.sum(predicted * turned)) / power
    named = {unit: abs(slope / factor - 1) for unit, factor in UNITS["gyro"].items()}
    unit = min(named, key=lambda one: named[one])
    ratio_text = f"{turning_name} turns {slope:.3g} times as fast as the gyro says"
    if named[unit] > 2 * NEAR and turning_name == "gravity":
        return Guess(unit=None, evidence="there is no magnetometer, whose field would tell")
    if named[unit] > 2 * NEAR:
        return Guess(unit=None, evidence=f"{ratio_text}: in no unit known, are all axes the same body's?", denied=True)
    return Guess(unit=unit, evidence=f"{ratio_text}, which is {unit}")
