"""What the cores of stretches of starts prove of every window that starts in them.

All windows that start in [a, b] hold [b, a + δ]. In the coordinates of `gramian_rank`, u of a window is A u + B of such
a core of length m, with A = m/δ and |B| ≤ ε/δ, ε = b − a, so a function with coefficients z in the window has T z in
the core. In units of floors that no rounding in the flight exceeds, singular values of the remainders obey
    sₖ(window) ≥ √(m/δ) sₖ(core) / ‖T⁻¹‖,   T = [[1, B, B²], [0, A, 2AB], [0, 0, A²]]
The rank needs no quadrature: functions that are independent on the nodes of a core are so on every window around it.
The Gramian refers to b in the core and to t in the window: W(t) ≥ (m/δ) Φ(b, t)ᵀ W_core Φ(b, t), so
    s₁₃(window) ≥ √(m/δ) / ‖Φ(b, t)⁻¹ H⁺‖
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.observability import (
    derivative_bounds,
    gramian_rank,
    pseudoinverse,
    quadrature,
    quadrature_bound,
    rounding,
    rows,
    spectrum,
)
from rangenav.observability.coordinates import STATES, UNKNOWNS
from rangenav.observability.cubic_fit import CUBIC
from rangenav.observability.gramian_rank import ROUNDING, SMALLEST, Remainders
from rangenav.progress import stop_if_unwanted
from rangenav.signals import Signal

AT_ONCE = 200_000
"""Samples that are held at once (some 30 MB)."""
LARGER = 1.25
"""Where no bound of the rounding is known, the floors allow for so much more than that of the sampled windows."""
BLOCKS = (1, 2, 3, 4, 7, 10)
"""Where the states ξ₁ … ξ₄, p, v and g begin, after the first."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Flight:
    path: Signal
    gravity: Vec3
    window: float
    floor: Float[Array, "9"]
    """No rounding in a column is larger, if `floor_bounded`."""
    floor_bounded: bool
    """Whether the floors are bounds; else they are those of sampled windows, and no rank is proved."""
    size: float
    """m: the size of the path that the floors stand for."""
    acceleration: float
    """m/s²: a bound of the apparent one; infinite if none is known."""

    @property
    def bounded(self) -> bool:
        """Whether the least singular values of cores bound those of windows: the rank is without it."""
        return math.isfinite(self.acceleration)

    @property
    def bound(self) -> float:
        """The same, or 0 where no use will be made of it."""
        return self.acceleration if self.bounded else 0.0


@dataclass(frozen=True, eq=False)
class Stretches:
    """Stretches of starts [begin, end] (s), none longer than `width`, and what their cores [end, …] prove."""

    begin: Float[Array, "n"]
    end: Float[Array, "n"]
    width: Float[Array, "n"]
    margins: Float[Array, "n 9"]
    """Bounds of the singular values of the remainders, in units of the floors."""
    least: Float[Array, "n 2"]
    """Bounds of the least singular value in units of 1 m and δ, and in SI."""

    def some(self, chosen: Array) -> "Stretches":
        return Stretches(*(getattr(self, name)[chosen] for name in self.__dataclass_fields__))

    def joined(self, other: "Stretches") -> "Stretches":
        names = self.__dataclass_fields__
        return Stretches(*(np.concatenate([getattr(self, name), getattr(other, name)]) for name in names))


def of_flight(path: Signal, gravity: Vec3, last: float, window: float) -> Flight:
    """Floors that no window up to the last start (s) exceeds: |d₄| ≤ (12/35)(|C₂| + gδ²/12), |C₂| ≤ 5 mean|L₂| |p|."""
    size = rounding.bound(path, last + window)
    bounded = math.isfinite(size)
    size = size if bounded else _sampled_size(path, last, window)
    fall = float(np.linalg.norm(gravity))
    floor = np.full(UNKNOWNS, max(size, SMALLEST))
    floor[-1] += 12 / 35 * (5 * 0.39 * size + fall * window**2 / 12)
    return Flight(
        path=path,
        gravity=gravity,
        window=window,
        floor=ROUNDING * floor,
        floor_bounded=bounded,
        size=max(size, SMALLEST),
        acceleration=_acceleration(path, last + window) + fall,
    )


def _sampled_size(path: Signal, last: float, window: float) -> float:
    """The largest size of windows half a window apart, which leave out no time, and some more."""
    some = np.linspace(0.0, last, math.ceil(2 * last / window) + 1)
    return LARGER * max(float(rows.sample(path, part, window).size.max()) for part in parts(path, some, window))


def _acceleration(path: Signal, until: float) -> float:
    """A bound of |p̈| from 0 until a time (s); infinite if none is known, or if position or velocity jump."""
    total = 0.0
    for part in path.parts():
        size = part.bound(2)
        if not math.isfinite(size) and part.piecewise() is None:
            edges = derivative_bounds.stretches(path, until)
            size = float(part.derivative_bounds(edges, range(2, 3)).max())
        total += size
    return total


def parts(path: Signal, starts: Array, length: float) -> list[Array]:
    """The starts of windows in groups whose samples fit the memory."""
    nodes = quadrature.count(path, length, float(starts.max()) + length, spare=quadrature_bound.SPARE)
    each = max(1, AT_ONCE // nodes)
    return [starts[k : k + each] for k in range(0, len(starts), each)]


def least_singular(of: Remainders, window: float, changes: list[Float[Array, "7 7"]]) -> Float[Array, "n 2"]:
    """A bound of 1/‖Φ⁻¹H⁺‖, the least singular value, in units of 1 m and the window's δ, and in SI; 0 below rank 13.

    ‖Φ⁻¹H⁺‖ ≤ ‖H⁺‖ + ‖E h‖, with E the norms of the blocks of Φ⁻¹ − 1 (by units) and h those of the rows of H⁺.
    """
    inverse, least = pseudoinverse.of_rows(of), []
    for unit, change in zip((window, 1.0), changes, strict=True):
        rescaled = (unit / of.window) ** spectrum.LIFTED_TIME_POWERS[:, None] * inverse
        blocks = np.split(rescaled, BLOCKS, axis=1)
        h = np.stack([np.linalg.norm(block, axis=(1, 2)) for block in blocks], axis=1)
        least.append(1 / (np.linalg.norm(rescaled, ord=2, axis=(1, 2)) + np.linalg.norm(h @ change.T, axis=1)))
    return np.where((of.rank == STATES)[:, None], np.stack(least, axis=1), 0.0)


def prove(flight: Flight, begin: Array, end: Array, width: float) -> Stretches:
    """What the cores [end, begin + δ], shortened to one length for all, prove of the windows in each stretch."""
    length = flight.window - width
    changes = [_transition_change(width / unit, flight.bound * unit**2) for unit in (flight.window, 1.0)]
    margins, least = [], []
    for part in parts(flight.path, end, length):
        stop_if_unwanted()
        tau, weight = quadrature.nodes(flight.path, part, length, spare=quadrature_bound.SPARE)
        samples = rows.sample_at(flight.path, part, length, tau=tau, weight=weight)
        of = gramian_rank.of(samples, flight.gravity, samples.weight, "start")
        margins.append(np.linalg.svd(of.triangle[:, CUBIC:, CUBIC:] / flight.floor, compute_uv=False))
        least.append(least_singular(of, flight.window, changes))
    share = math.sqrt(length / flight.window)
    return Stretches(
        begin,
        end,
        np.full(len(begin), width),
        np.concatenate(margins) * share / _of_unit_change(width / flight.window),
        np.concatenate(least) * share,
    )


def _of_unit_change(e: float) -> float:
    """A bound of ‖T⁻¹‖ for all |B| ≤ e: the norm of a matrix of positive numbers grows with each of them."""
    A = 1 - e
    return float(np.linalg.norm([[1, e / A, (e / A) ** 2], [0, 1 / A, 2 * e / A**2], [0, 0, 1 / A**2]], ord=2))


def _transition_change(e: float, a: float) -> Float[Array, "7 7"]:
    """Bounds of the norms of the blocks of Φ⁻¹ − 1 over a time e, in units of 1 m and δ: |D| ≤ ½ae², |Ḋ| ≤ ae."""
    D, rate = a * e**2 / 2, a * e
    return np.array(
        [
            [0, e, e**2 / 2, e**3 / 6, D, e * D, e**2 / 2 * D],
            [0, 0, e, e**2 / 2, rate, D + e * rate, e * D + e**2 / 2 * rate],
            [0, 0, 0, e, 0, 2 * rate, D + 2 * e * rate],
            [0, 0, 0, 0, 0, 0, 3 * rate],
            [0, 0, 0, 0, 0, e, e**2 / 2],
            [0, 0, 0, 0, 0, 0, e],
            [0, 0, 0, 0, 0, 0, 0],
        ]
    )


def margin(stretches: Stretches, rank: int) -> Float[Array, "n"]:
    return stretches.margins[:, rank - CUBIC - 1] if rank > CUBIC else np.full(len(stretches.begin), np.inf)
