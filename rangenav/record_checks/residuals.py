"""What the true positions leave of the ranges: a constant offset, and a disagreement that nothing explains.

    e(t) = d(t) − |p(t) − anchor|
Unit and clock are tried first, then a constant offset, then another anchor. A record whose ranges disagree with its
truth after all of these is not judged.
"""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.formats.recorded_flight import Flight
from rangenav.number_format import significant
from rangenav.record_checks import anchors, distances
from rangenav.record_checks.check import Evidence

LEAST_OFFSET, OFFSET_SIGMAS = 0.2, 3.0
"""m, and rms of what is left, beyond which a constant offset is asked about; antennas have some centimetres."""
AS_GOOD = 1.2
"""An offset explains the ranges if it leaves at most this many times as much as the anchor that fits best."""
LEAST_MISFIT = 0.3
"""m, and the noise of single ranges if that is larger: what is left beyond the noise is doubted above it."""
NEAR = 5.0
"""Usual steps of the true positions within which a range has one."""


def residuals(flight: Flight) -> tuple[Bool[Array, "m"], Float[Array, "k"]] | None:
    """Which ranges have a true position, and e (m) of those; None without anchor or true positions."""
    known = distances.known_positions(flight)
    if known is None or flight.anchor is None:
        return None
    there, position = positions_at(flight, *known)
    if there.sum() < distances.LEAST:
        return None
    return there, flight.range[there] - np.linalg.norm(position - np.asarray(flight.anchor), axis=-1)


def positions_at(flight: Flight, time: Array, position: Array) -> tuple[Bool[Array, "m"], Float[Array, "k 3"]]:
    """Which ranges are close enough to known positions, and the positions (m) at their stamps."""
    after = np.clip(np.searchsorted(time, flight.range_time), 1, len(time) - 1)
    usual = float(np.median(np.diff(time)))
    inside = (flight.range_time >= time[0]) & (flight.range_time <= time[-1])
    there = np.asarray(inside & (time[after] - time[after - 1] <= NEAR * usual))
    stamps = flight.range_time[there]
    return there, np.stack([np.interp(stamps, time, axis) for axis in position.T], axis=-1)


def rms(values: Array) -> float:
    """The root mean square of numbers."""
    return float(np.sqrt(np.mean(values**2)))


def offset(flight: Flight) -> Evidence | None:
    """A constant by which all ranges are too long or too short, if it explains them as well as another anchor."""
    left = residuals(flight)
    if left is None:
        return None
    constant = float(np.median(left[1]))
    before, after = rms(left[1]), rms(left[1] - constant)
    if abs(constant) < max(LEAST_OFFSET, OFFSET_SIGMAS * after):
        return None
    best = anchors.best_anchor(flight)
    if best is None or after > AS_GOOD * best.left:
        return None
    text = (
        f"the ranges are {significant(abs(constant))} m {'longer' if constant > 0 else 'shorter'} than the distances "
        f"from the true positions to the anchor: they fit within {significant(after)} m without this constant, and "
        f"within {significant(before)} m as they are"
    )
    return Evidence(text=text, suggestion=f"{constant:.3f}")


def disagreement(flight: Flight) -> Evidence | None:
    """Ranges that fit the true positions nowhere."""
    known = distances.known_positions(flight)
    if known is None or len(flight.range) < distances.LEAST:
        return None
    at_anchor = residuals(flight)
    if at_anchor is not None:
        left, where = at_anchor[1], "at the anchor, or at any other"
    else:
        fit = anchors.best_anchor(flight)
        if fit is None:
            return None
        there, position = positions_at(flight, *known)
        left, where = flight.range[there] - np.linalg.norm(position - fit.place, axis=-1), "for any anchor"
    size, noise = rms(left), _noise(left)
    if size**2 - noise**2 <= max(LEAST_MISFIT, noise) ** 2:
        return None
    text = (
        f"the ranges disagree with the true positions by {significant(size)} m rms {where}, in every unit and with "
        "every delay and offset that was tried"
    )
    return Evidence(text=text, suggestion=None)


def _noise(left: Float[Array, "k"]) -> float:
    """m, the noise of single ranges: how far each is from the mean of its neighbours."""
    between = left[1:-1] - (left[2:] + left[:-2]) / 2
    return float(1.4826 * np.median(np.abs(between)) / np.sqrt(1.5))
