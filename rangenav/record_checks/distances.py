"""The ranges against the motion: their clock, and the anchor.

    with true positions   d²(t) = |p(t − delay) − anchor|²
    with the IMU alone    ½d²(t) = ½|D|² + [1, τ, τ²/2, τ³/6, τ⁴/24, Dᵀ, τDᵀ, ½τ²Dᵀ] z      at t − delay
Both are linear but for the delay, which is found on a grid. What is left is the noise of the ranges, if unit, clock and
anchor are right.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats.recorded_flight import Flight
from rangenav.imu_motion import displacement, twice_integrated
from rangenav.number_format import significant, vector
from rangenav.record_checks.blocks import KEPT
from rangenav.record_checks.check import Evidence
from rangenav.results import result

DELAYS: Float[Array, "k"] = np.linspace(-1.0, 1.0, 41)
"""s"""
WINDOW = 8.0
"""s, in which the IMU tells the motion up to the unknowns above; its bias adds centimetres."""
MOST_WINDOWS, MOST_RANGES = 25, 300
"""Windows, and ranges in each, that are looked at."""
LEAST = 20
"""Ranges."""
CLEARLY, LIKELIER = 1.2, 40.0
"""How many times larger what is left is without the delay; by how much its chi-square is, and that of an anchor."""
LEAST_DELAY = 0.05
"""s. A shorter delay is usual and harmless."""
FARTHEST = 1e5
"""m: no anchor is farther from the origin."""
SURE, ANCHOR_SIGMAS, LEVER = 5.0, 3.0, 0.1
"""Standard deviations of the anchor that fits best, standard deviations of a range, and m between the sensors of a
body, by which an anchor must be off before it is asked about."""
STEPS = 10
"""Of Gauss and Newton, from the anchor in question to the one that fits best near it."""


@result
class Delay:
    """What is left of the ranges for each delay of their clock (m rms), with the number of ranges."""

    left: Float[Array, "k"]
    count: int
    by: str

    @property
    def now(self) -> float:
        """m, without a delay."""
        return float(self.left[len(self.left) // 2])

    @property
    def best(self) -> tuple[float, float]:
        """The delay (s) that leaves least, between the grid's by a parabola, and what it leaves (m)."""
        k = int(np.argmin(self.left))
        if not 0 < k < len(self.left) - 1:
            return float(DELAYS[k]), float(self.left[k])
        below, here, above = (self.left[k - 1 : k + 2] ** 2).tolist()
        curved = below - 2 * here + above
        shift = 0.5 * (below - above) / curved if curved > 0 else 0.0
        return float(DELAYS[k] + shift * (DELAYS[1] - DELAYS[0])), float(self.left[k])


def known_positions(flight: Flight) -> tuple[Array, Array] | None:
    """Stamps and true positions where they are known."""
    if flight.position is None:
        return None
    known = np.isfinite(flight.position).all(axis=-1)
    return (flight.time[known], flight.position[known]) if known.sum() > LEAST else None


def _inside(flight: Flight, time: Array) -> tuple[Array, Array]:
    """Ranges at which every delay of the grid has a sample, thinned out."""
    margin = min(1.0, (time[-1] - time[0]) / 4)
    inside = (flight.range_time >= time[0] + margin) & (flight.range_time <= time[-1] - margin) & (flight.range > 0)
    steps = np.diff(time)
    gaps = time[1:][steps > 5 * float(np.median(steps))]
    if len(gaps):
        after = np.searchsorted(gaps, flight.range_time)
        near = np.minimum(
            np.abs(gaps[np.clip(after, 0, len(gaps) - 1)] - flight.range_time),
            np.abs(gaps[np.clip(after - 1, 0, len(gaps) - 1)] - flight.range_time),
        )
        inside &= near > margin
    k = np.flatnonzero(inside)
    k = k[:: max(1, len(k) // (MOST_WINDOWS * MOST_RANGES))]
    return flight.range_time[k], flight.range[k]


def _to_anchor(position: Array, distance: Array) -> tuple[Float[Array, "3"], float]:
    """The anchor (m) that fits best, and what it leaves (m rms). In a plane it is the nearest one that does."""
    middle = position.mean(axis=0)
    moved = position - middle
    weight = 1 / (2 * np.maximum(distance, 0.1 * float(np.median(distance))))
    design = np.column_stack([-2 * moved, np.ones(len(moved))]) * weight[:, None]
    wanted = (distance**2 - np.sum(moved**2, axis=-1)) * weight
    size = np.maximum(np.linalg.norm(design, axis=0), np.finfo(float).tiny)
    solution, *_ = np.linalg.lstsq(design / size, wanted, rcond=1e-6)
    left = wanted - design @ (solution / size)
    return (solution / size)[:3] + middle, float(np.sqrt(np.mean(left**2)))


@lru_cache(maxsize=KEPT)
def delay_by_truth(flight: Flight) -> Delay | None:
    """What is left for each delay, with the anchor that fits best; None without true positions."""
    known = known_positions(flight)
    if known is None or len(flight.range) < LEAST:
        return None
    time, position = known
    stamps, distance = _inside(flight, time)
    if len(stamps) < LEAST:
        return None
    left = [
        _to_anchor(np.stack([np.interp(stamps - delay, time, axis) for axis in position.T], axis=-1), distance)[1]
        for delay in DELAYS
    ]
    return Delay(left=np.array(left), count=len(stamps), by="the true positions")


@lru_cache(maxsize=KEPT)
def delay_by_imu(flight: Flight) -> Delay | None:
    """What is left for each delay about every motion that the IMU allows; None with too few ranges."""
    span = float(flight.time[-1] - flight.time[0])
    if len(flight.range) < LEAST or span < WINDOW / 2:
        return None
    begin, end = flight.time[0] + min(1.0, span / 8), flight.time[-1] - min(1.0, span / 8)
    count = max(1, min(int((end - begin) // WINDOW), len(flight.range) // LEAST))
    edges = np.linspace(begin, end, count + 1)
    curve = twice_integrated(flight)
    left, freedom = np.zeros(len(DELAYS)), 0
    for k in np.unique(np.linspace(0, count - 1, MOST_WINDOWS).astype(int)):
        inside = np.flatnonzero(
            (flight.range_time >= edges[k]) & (flight.range_time < edges[k + 1]) & (flight.range > 0)
        )
        inside = inside[:: max(1, len(inside) // MOST_RANGES)]
        if len(inside) < LEAST:
            continue
        middle, distance = (edges[k] + edges[k + 1]) / 2, flight.range[inside]
        taus = flight.range_time[inside] - DELAYS[:, None] - middle
        left += np.array([_left(displacement(curve, np.array([middle]), tau)[0], tau, distance) for tau in taus])
        freedom += len(inside) - 14
    return Delay(left=np.sqrt(left / freedom), count=freedom, by="the IMU") if freedom > 0 else None


def _left(D: Float[Array, "m 3"], tau: Float[Array, "m"], distance: Float[Array, "m"]) -> float:
    """The sum of squares (m²) that no motion with this displacement explains."""
    s = tau[:, None]
    rows = np.column_stack([tau[:, None] ** np.arange(5), D, s * D, s**2 * D])
    weight = 1 / np.maximum(distance, 0.1 * float(np.median(distance)))
    weighted = rows * weight[:, None]
    basis, _ = np.linalg.qr(weighted / np.maximum(np.linalg.norm(weighted, axis=0), np.finfo(float).tiny))
    wanted = (distance**2 - np.sum(D**2, axis=-1)) / 2 * weight
    return float(np.sum((wanted - basis @ (basis.T @ wanted)) ** 2))


def delay(flight: Flight) -> Evidence | None:
    """A clock of the ranges that is not the IMU's."""
    delayed = delay_by_truth(flight) or delay_by_imu(flight)
    if delayed is None:
        return None
    seconds, left = delayed.best
    gain = delayed.count * ((delayed.now / left) ** 2 - 1) if left > 0 else np.inf
    if abs(seconds) < LEAST_DELAY or delayed.now < CLEARLY * left or gain < LIKELIER or abs(seconds) >= DELAYS[-1]:
        return None
    late = "late" if seconds > 0 else "early"
    text = (
        f"the ranges fit {delayed.by} within {significant(left)} m if they are {abs(seconds):.2f} s {late}, and within "
        f"{significant(delayed.now)} m by their own stamps"
    )
    return Evidence(text=text, suggestion=f"{seconds:.2f}")


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
    stamps, distance = _inside(flight, known[0])
    if len(stamps) < LEAST:
        return None
    position = np.stack([np.interp(stamps, known[0], axis) for axis in known[1].T], axis=-1)
    starts = [_to_anchor(position, distance)[0]]
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
