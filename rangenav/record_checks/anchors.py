"""The anchor that fits the ranges to the true positions best, with its covariance.

    minimise Σ (d − |p − anchor|)²       by steps of Gauss and Newton; (JᵀJ)⁻¹σ² is the covariance
Directions in which the positions do not determine the anchor do not count.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats.recorded_flight import Flight
from rangenav.number_format import significant, vector
from rangenav.record_checks.blocks import KEPT
from rangenav.record_checks.check import Evidence
from rangenav.record_checks.distances import LEAST, LIKELIER, inside_of, known_positions, to_anchor
from rangenav.results import result

FARTHEST = 1e5
"""m: no anchor is farther from the origin."""
SURE, ANCHOR_SIGMAS, LEVER = 5.0, 3.0, 0.1
"""Standard deviations of the anchor that fits best, standard deviations of a range, and m between the sensors of a
body, by which an anchor must be off before it is asked about."""
STEPS = 10
"""Of Gauss and Newton, from the anchor in question to the one that fits best near it."""


def anchor(flight: Flight) -> Evidence | None:
    """An anchor that is not where the ranges to the true positions put it, by the covariance of the best fit.

    Directions in which the positions do not determine the anchor do not count.
    """
    fit = best_anchor(flight)
    if fit is None or flight.anchor is None:
        return None
    asked, off = np.asarray(flight.anchor, dtype=float), fit.asked
    gain = fit.count * ((off / max(fit.left, np.finfo(float).tiny)) ** 2 - 1)
    if gain < LIKELIER or not np.all(np.abs(fit.place) < FARTHEST):
        return None
    along = fit.directions.T @ (asked - fit.place)
    moved = float(np.linalg.norm(along[np.abs(along) > SURE * fit.sigma]))
    if moved < max(ANCHOR_SIGMAS * fit.left, LEVER):
        return None
    text = (
        f"the ranges fit the true positions within {significant(off)} m for the anchor at {vector(flight.anchor)}, and "
        f"within {significant(fit.left)} m for one at {vector(fit.place)}"
    )
    return Evidence(text=text, suggestion=" ".join(f"{round(value, 3) + 0.0:.3f}" for value in fit.place))


@lru_cache(maxsize=KEPT)
def best_anchor(flight: Flight) -> "AnchorFit | None":
    """The anchor that fits the ranges to the true positions best; None without them."""
    known = known_positions(flight)
    if known is None or len(flight.range) < LEAST:
        return None
    stamps, distance = inside_of(flight, known[0])
    if len(stamps) < LEAST:
        return None
    position = np.stack([np.interp(stamps, known[0], axis) for axis in known[1].T], axis=-1)
    starts = [to_anchor(position, distance)[0]]
    if flight.anchor is not None:
        starts.append(np.asarray(flight.anchor, dtype=float))
    fits = [
        fit for start in starts if np.all(np.abs(start) < FARTHEST) and (fit := _nearest(position, distance, start))
    ]
    if not fits:
        return None
    fit = min(fits, key=lambda one: one.left)
    if flight.anchor is None:
        return fit
    residual = distance - np.linalg.norm(position - np.asarray(flight.anchor, dtype=float), axis=-1)
    return replace(fit, asked=float(np.sqrt(np.mean(residual**2))))


@result
class AnchorFit:
    """The anchor that fits ranges to true positions best, and its covariance along its principal directions."""

    place: Float[Array, "3"]
    """m, inertial."""
    left: float
    """m rms of the ranges."""
    directions: Float[Array, "3 3"]
    """In columns."""
    sigma: Float[Array, "3"]
    """m, along each direction; residuals that resemble their neighbours count as fewer."""
    count: int
    """Of the ranges."""
    asked: float = math.nan
    """m rms of the ranges for the anchor in question; NaN if there is none."""


def _nearest(position: Float[Array, "m 3"], distance: Float[Array, "m"], start: Float[Array, "3"]) -> AnchorFit | None:
    """The anchor that fits best near `start`, by steps of Gauss and Newton; None if they diverge."""
    place, finest = start, np.finfo(float).tiny
    rows, residual = _to_place(position, distance, place)
    for _ in range(STEPS):
        step, *_ = np.linalg.lstsq(rows, residual, rcond=1e-6)
        place = place + step
        if not np.all(np.abs(place) < FARTHEST):
            return None
        rows, residual = _to_place(position, distance, place)
    information, directions = np.linalg.eigh(rows.T @ rows)
    variance = float(np.mean(residual**2))
    alike = max(0.0, float(np.mean(residual[1:] * residual[:-1])) / max(variance, finest))
    inflated = variance * (1 + alike) / max(1 - alike, 1 / len(residual))
    sigma = np.sqrt(inflated / np.maximum(information, 1e-12 * len(residual)))  # rows are of unit length
    return AnchorFit(
        place=place, left=float(np.sqrt(variance)), directions=directions, sigma=sigma, count=len(residual)
    )


def _to_place(
    position: Float[Array, "m 3"], distance: Float[Array, "m"], place: Float[Array, "3"]
) -> tuple[Float[Array, "m 3"], Float[Array, "m"]]:
    """The gradient of each distance to a place with respect to the place, and what is left of each range (m)."""
    away = place - position
    size = np.maximum(np.linalg.norm(away, axis=-1), np.finfo(float).tiny)
    return away / size[:, None], distance - size
