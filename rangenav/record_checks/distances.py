"""The ranges against the motion: their clock, and the anchor.

    with true positions   d²(t) = |p(t − delay) − anchor|²
    with the IMU alone    ½d²(t) = ½|D|² + [1, τ, τ²/2, τ³/6, τ⁴/24, Dᵀ, τDᵀ, ½τ²Dᵀ] z      at t − delay
Both are linear but for the delay, which is found on a grid. What is left is the noise of the ranges, if unit, clock and
anchor are right.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats.recorded_flight import Flight
from rangenav.imu_motion import displacement, twice_integrated
from rangenav.number_format import significant
from rangenav.record_checks.blocks import KEPT
from rangenav.record_checks.check import Evidence
from rangenav.results import result

DELAYS: Float[Array, "k"] = np.linspace(-1.0, 1.0, 41)
"""s"""
WINDOW = 8.0
"""s: over so long the IMU determines the motion up to the unknowns above; its bias adds centimetres."""
MOST_WINDOWS, MOST_RANGES = 25, 300
"""At most so many windows are examined, and so many ranges in each."""
LEAST = 20
"""Ranges."""
CLEARLY, LIKELIER = 1.2, 40.0
"""A delay is reported if without it the residual is so many times larger, and its chi-square by so much; an anchor by
the latter alone."""
LEAST_DELAY = 0.05
"""s. A shorter delay is usual and harmless."""


@result
class Delay:
    """The residual of the ranges for each delay of their clock (m rms), and the number of ranges."""

    left: Float[Array, "k"]
    count: int
    by: str

    @property
    def now(self) -> float:
        """m, without a delay."""
        return float(self.left[len(self.left) // 2])

    @property
    def best(self) -> tuple[float, float]:
        """The delay (s) of least residual, between those of the grid by a parabola, and that residual (m)."""
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


def inside_of(flight: Flight, time: Array) -> tuple[Array, Array]:
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


def to_anchor(position: Array, distance: Array) -> tuple[Float[Array, "3"], float]:
    """The anchor (m) that fits best, and its residual (m rms). In a planar motion it lies in the plane."""
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
    """The residual for each delay, with the anchor that fits best; None without true positions."""
    known = known_positions(flight)
    if known is None or len(flight.range) < LEAST:
        return None
    time, position = known
    stamps, distance = inside_of(flight, time)
    if len(stamps) < LEAST:
        return None
    left = [
        to_anchor(np.stack([np.interp(stamps - delay, time, axis) for axis in position.T], axis=-1), distance)[1]
        for delay in DELAYS
    ]
    return Delay(left=np.array(left), count=len(stamps), by="the true positions")


@lru_cache(maxsize=KEPT)
def delay_by_imu(flight: Flight) -> Delay | None:
    """The residual for each delay, with the best of the motions that the IMU allows; None with too few ranges."""
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
