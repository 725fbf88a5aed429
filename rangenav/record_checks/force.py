"""The accelerometer against gravity: the mean specific force in axes turned by the gyro is −g, whatever the motion.

    |(1/δ) ∫ R' a| = |g − Δv/δ|
A turning body's median reading is no gravity (a barrel roll reads 11 m/s²), its mean in turned axes is.
"""

import math

import numpy as np

from rangenav import motion
from rangenav.formats.recorded_flight import Flight
from rangenav.number_format import significant
from rangenav.record_checks.blocks import WINDOW, blocks, means
from rangenav.record_checks.check import Evidence, unit_for
from rangenav.record_checks.field import DEGREE

GRAVITY = 9.81
"""m/s², where a file states no gravity."""
LEAST = 2.0
"""s: in a shorter record the change of velocity hides gravity."""
ALLOWED, GAINED = 1.0, 10.0
"""m/s² by which the mean may differ from gravity, and m/s that a body may gain or lose within a window."""
NOTHING = 0.35
"""Of gravity: a smaller mean is no gravity at all."""
NEARER = 0.3
"""Largest share of the mean's difference from gravity that another unit of the gyro leaves."""
SCALES = (0.25, 0.5, 2.0, 4.0, 8.0)
"""Ratios of the full scales between which an accelerometer is switched."""


def mean_force(flight: Flight, scale: float = 1.0) -> tuple[float, float]:
    """The median over windows of the mean specific force (m/s²) in axes turned by the gyro, and its tolerance."""
    b = blocks(flight)
    span = float(b.time[-1] - b.time[0])
    if span < LEAST:
        return math.nan, math.inf
    window, count = b.windows()
    force = means(motion.to_inertial(b.turned(scale), b.accel), window, count)
    tolerance = ALLOWED + GAINED / (min(WINDOW, span) * math.sqrt(count))
    return float(np.median(np.linalg.norm(force, axis=-1))), tolerance


def expected(flight: Flight) -> float:
    """The size of gravity (m/s²): that of the file, or the earth's."""
    return GRAVITY if flight.gravity is None else float(np.linalg.norm(flight.gravity))


def gyro_unit_by_gravity(flight: Flight) -> Evidence | None:
    """A unit of the gyro in whose axes gravity appears, where it does not in the unit that was taken."""
    mean, tolerance = mean_force(flight)
    wanted = expected(flight)
    if not abs(mean - wanted) > tolerance:
        return None
    for factor in (DEGREE, 1 / DEGREE):
        unit, other = unit_for(flight, "gyro", factor), mean_force(flight, factor)[0]
        nearer = abs(other - wanted) < min(tolerance, NEARER * abs(mean - wanted))
        if unit is not None and nearer:
            text = (
                f"in axes turned by the gyro the mean specific force is {significant(mean)} m/s², and "
                f"{significant(other)} m/s² if the gyro is in {unit}"
            )
            return Evidence(text=text, suggestion=unit)
    return None


def accel_unit(flight: Flight) -> Evidence | None:
    """A mean specific force that is gravity in another unit."""
    mean, tolerance = mean_force(flight)
    wanted = expected(flight)
    unit = unit_for(flight, "accel", wanted / mean) if mean > 0 and abs(mean - wanted) > tolerance else None
    if unit is None:
        return None
    text = f"the mean specific force is {significant(mean)} m/s² in axes turned by the gyro, which is gravity in {unit}"
    return Evidence(text=text, suggestion=unit)


def accel_scale(flight: Flight) -> Evidence | None:
    """A mean specific force that is not gravity: it was removed, or the scale is wrong."""
    mean, tolerance = mean_force(flight)
    wanted = expected(flight)
    if not abs(mean - wanted) > tolerance or accel_unit(flight) is not None:
        return None
    text = (
        f"the mean specific force is {significant(mean)} m/s² in axes turned by the gyro, and gravity is {wanted:.4g}"
    )
    if mean < NOTHING * wanted:
        removed = (
            f"{text}: gravity was removed (“linear acceleration”), without it this is no accelerometer, and no factor "
            "is an answer; record the accelerometer itself"
        )
        return Evidence(text=removed, suggestion=None)
    factor = wanted / mean
    nice = min(SCALES, key=lambda one: abs(math.log(one / factor)))
    return Evidence(text=text, suggestion=f"{nice:g}" if abs(nice / factor - 1) < 0.1 else f"{factor:.3g}")
