"""The magnetometer against the gyro: in axes turned by the gyro the field is constant.

    R' (m − b) is constant      R' = R' [ω]×, b: iron that turns with the body
A field and its reverse are both constant, so the axes of a magnetometer are told up to all three signs.
"""

import math
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import motion
from rangenav.formats.recorded_flight import Flight
from rangenav.number_format import significant, vector
from rangenav.record_checks import axes
from rangenav.record_checks.blocks import KEPT, blocks, centred, rms
from rangenav.record_checks.check import Evidence, unit_for
from rangenav.results import result

LEAST = 20
"""Samples."""
SPREAD = 0.15
"""Of the field: how much the turned readings must spread beyond another explanation of them."""
SHARE = 0.6
"""Largest spread of an explanation, as a share of that of the readings as they are."""
ALONE = 1.2
"""Axes that spread at most this many times as much explain it as well."""
IRON, IRON_SIGMA = 0.25, 0.2
"""Least iron that is asked about, as a share of the field, and its largest uncertainty as a share of itself."""
NO_FIELD = 0.02
"""Of the iron: a smaller field is none."""
DEGREE = math.pi / 180


@result
class FieldSpread:
    """How the magnetometer's readings spread in axes turned by the gyro, as a share of their length."""

    own: float
    by_mag_axes: Float[Array, "24"]
    """For each rotation of the magnetometer's axes; a field and its reverse cannot be told apart."""
    by_gyro_axes: Float[Array, "24"]
    """For each reflection of the gyro's axes; a rotation of them is one of the magnetometer's."""
    by_unit: tuple[float, float]
    """If the gyro were in deg/s, and if a gyro in deg/s were in rad/s."""
    iron: Float[Array, "3"]
    """The constant in body axes that explains most, in multiples of the readings' length."""
    iron_sigma: float
    without_iron: float
    """The spread that is left without it."""
    field: float
    """The length of what is left."""


@lru_cache(maxsize=KEPT)
def field_spread(flight: Flight) -> FieldSpread | None:
    """The spread of the field in turned axes, and of what might explain it; None without a magnetometer."""
    b = blocks(flight)
    if b.mag is None:
        return None
    known = np.asarray(np.isfinite(b.mag).all(axis=-1))
    window, count = b.windows()
    if known.sum() < LEAST + 3 * count:
        return None
    mag, window = b.mag[known], window[known]
    size = float(np.median(np.linalg.norm(mag, axis=-1)))

    if size == 0:
        return None

    def spread(rotation: Array, readings: Array) -> float:
        return rms(centred(motion.to_inertial(rotation, readings), window, count)) / size

    forwards, backwards = b.turned()[known], b.turned(-1.0)[known]
    by_mag = np.array([spread(forwards, mag @ axes.MATRICES[k].T) for k in axes.ROTATIONS])
    by_gyro = np.array([spread(backwards, mag @ axes.MATRICES[k]) for k in axes.REFLECTIONS])  # [Aω]× = −A[ω]×Aᵀ
    moved, readings = centred(forwards, window, count), centred(motion.to_inertial(forwards, mag), window, count)
    design, wanted = moved.reshape(-1, 3), readings.reshape(-1)
    iron, *_ = np.linalg.lstsq(design, wanted, rcond=1e-6)
    left = wanted - design @ iron
    variance = float(np.mean(left**2))
    inverse = np.linalg.pinv(design.T @ design)
    return FieldSpread(
        own=float(by_mag[0]),
        by_mag_axes=by_mag,
        by_gyro_axes=by_gyro,
        by_unit=(spread(b.turned(DEGREE)[known], mag), spread(b.turned(1 / DEGREE)[known], mag)),
        iron=iron,
        iron_sigma=float(np.sqrt(variance * np.trace(inverse) * count)),
        without_iron=float(np.sqrt(3 * variance)) / size,
        field=float(np.median(np.linalg.norm(mag - iron, axis=-1))) / size,
    )


def _explains(spreads: FieldSpread, spread: float) -> bool:
    others = min(spreads.by_mag_axes.min(), spreads.by_gyro_axes.min(), *spreads.by_unit, spreads.without_iron)
    clear = spread < SHARE * spreads.own and spreads.own**2 - spread**2 > SPREAD**2
    return clear and spread <= others


def gyro_unit_by_field(flight: Flight) -> Evidence | None:
    """A unit of the gyro in which the magnetic field is constant, where it is not in the unit that was taken."""
    spreads = field_spread(flight)
    if spreads is None:
        return None
    for factor, spread in zip((DEGREE, 1 / DEGREE), spreads.by_unit, strict=True):
        unit = unit_for(flight, "gyro", factor)
        if unit is not None and _explains(spreads, spread):
            text = (
                f"in axes turned by the gyro the magnetic field spreads by {spreads.own:.0%} of its length, and by "
                f"{spread:.0%} if the gyro is in {unit}"
            )
            return Evidence(text=text, suggestion=unit)
    return None


def mag_axes(flight: Flight) -> Evidence | None:
    """Axes of the magnetometer in which the field is constant, where it is not in its own."""
    spreads = field_spread(flight)
    return None if spreads is None else _axes(spreads, spreads.by_mag_axes, axes.ROTATIONS, "magnetometer")


def gyro_axes_by_field(flight: Flight) -> Evidence | None:
    """Axes of the gyro, of the other handedness, in which the field is constant, where it is not in its own."""
    spreads = field_spread(flight)
    return None if spreads is None else _axes(spreads, spreads.by_gyro_axes, axes.REFLECTIONS, "gyro")


def _axes(spreads: FieldSpread, by_axes: Array, places: tuple[int, ...], sensor: str) -> Evidence | None:
    least = float(by_axes.min())
    if not _explains(spreads, least):
        return None
    chosen = axes.simplest(places[k] for k in np.flatnonzero(by_axes <= ALONE * least))
    text = (
        f"in axes turned by the gyro the magnetic field spreads by {spreads.own:.0%} of its length, and by {least:.0%} "
        f"if the {sensor}'s axes are {chosen}{axes.handedness(chosen)}"
    )
    return Evidence(text=text, suggestion=chosen)


def hard_iron(flight: Flight) -> Evidence | None:
    """A part of the magnetometer's readings that turns with the body."""
    spreads = field_spread(flight)
    if spreads is None:
        return None
    size = float(np.linalg.norm(spreads.iron))
    large = size > IRON * spreads.field and spreads.iron_sigma < IRON_SIGMA * size
    if not large or not _explains(spreads, spreads.without_iron):
        return None
    if spreads.field < NO_FIELD * size:
        text = "the magnetometer reads the same in body axes however the body turns: it reads no field"
        return Evidence(text=text, suggestion=None)
    offset = flight.field_length * spreads.iron
    text = (
        f"the magnetometer reads a constant of {vector(offset)} in body axes, in the unit of the file, on a field of "
        f"{significant(flight.field_length * spreads.field)}: iron on the body"
    )
    return Evidence(text=text, suggestion=" ".join(f"{value:.4g}" for value in offset))
