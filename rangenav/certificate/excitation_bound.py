"""What μ is at every t, proven: λ_min of W(t) = ∫_t^{t+δ} q qᵀ ds, q = p⁗, on a grid of starts and between its points.

Between grid points λ_min falls below both ends by no more than `between` says, if no end of the window crosses a knot.
Snap that jumps (a minimum-snap curve at its ends, pieces from a file anywhere) makes W′ jump exactly when one does, so
those starts, every knot and every knot less δ, are points of the grid, and each cell is smooth. Where even jerk or a
lower derivative jumps, snap has an impulse j/ε over some ε → 0; for every ε the integral of (n·q)² is at least its part
outside the impulses, so the part between the knots, which is what is integrated, stays a lower bound.

W itself is summed over small cells by Gauss's rule of m nodes; on a cell of length h it errs, for every unit n, by
    h^{2m+1} (m!)⁴ / ((2m+1) ((2m)!)³) · max|(nᵀqqᵀn)^{(2m)}|,   the last ≤ Σ C(2m, k) |q⁽ᵏ⁾| |q⁽²ᵐ⁻ᵏ⁾|,
which the same enclosures bound. It is taken off, as is an allowance for rounding.
From above: λ_min(W(t)) ≤ nᵀW(t)n for any n.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.certificate.derivative_bounds import UnboundedDerivativeError
from rangenav.certificate.eigenvalue_drop import Enclosure, Narrow, along, enclosed, fall, rise
from rangenav.certificate.sums import GAUSS, NEAR, TURN, additions, cells, first_starts, most_nodes, sums
from rangenav.observability.excitation import lowest_between
from rangenav.results import result
from rangenav.signals import Signal, knots

ROUNDS = 8
"""How often the grid is refined where its bound is too weak; twice is usual."""
MAX_NARROW = 6
"""Lines and planes kept at hand: those of the cells whose bound was weakest in the last rounds."""
MAX_STARTS = 40_000
SHARE = 0.01
"""The grid is refined until what lies between its points costs this share of the least μ."""
EPSILON = float(np.finfo(float).eps)
ARITHMETIC = 512.0
"""Units of rounding allowed to one evaluation of the snap, of its largest value; polynomials cancel a hundredfold."""
TIE = 1e-6
"""Windows whose μ differs by less than this share count as equally bad, and the first one is named."""
BELIEVED = 10.0
"""A μ below this many times its floor is not refined: no grid would change that nothing is seen."""
QUADRATURE_SHARE = 1e-4
"""Cells are made smaller until the quadrature's bound costs less than this share of the least μ,"""
MOST_FINER = 1 / 8
"""and at most so much smaller in one round."""


@result
class Bounds:
    """What is proven of λ_min over all starts t in [0, end], and the window where it is least. All in m²/s⁷ and s."""

    lower: float
    """λ_min(W(t)) is at least this for every t in [0, end]; never below 0."""
    upper: float
    """On the worst window of the grid λ_min is at most this."""
    upper_everywhere: float
    """λ_min(W(t)) is at most this for every t in [0, end]."""
    found: float
    """λ_min on the worst window of the grid."""
    at: float
    """s, where that window starts; the first of equally bad ones."""
    direction: Float[Array, "3"]
    """Unit vector, its largest component positive: along it that window is excited least."""
    floor: float
    """Rounding and quadrature in any of these numbers."""
    starts: int
    """Points of the grid."""


@dataclass(frozen=True, eq=False)
class _Grid:
    """Windows on a grid of starts."""

    turn: float
    """rad of the fastest tone in one cell."""
    start: Float[Array, "w"]
    value: Float[Array, "w"]
    """λ_min of each."""
    matrix: Float[Array, "w 3 3"]
    quadrature: float
    rounding: float
    """What either may be off by, for every unit n and every window."""

    @property
    def floor(self) -> float:
        return self.quadrature + self.rounding


def bounds(path: Signal, window: float, end: float) -> Bounds:
    """Bounds of μ over windows that start in [0, end] (s).

    Raises UnboundedError, saying why, if nothing bounds the snap's derivatives or if it would be too much work.
    """
    known = enclosed(path, end + window, 2 * GAUSS)
    if not np.isfinite(known.sizes).all():
        raise UnboundedDerivativeError("nothing is known to bound the path's snap and its derivatives")
    grid = _windows(path, window, first_starts(window, end, known.edge), known, TURN)
    narrow = _narrow(path, grid.matrix[int(np.argmin(grid.value))], known)
    gap = fall(grid.start, grid.matrix, window, known, narrow)
    for _ in range(ROUNDS):
        finer = _finer(path, window, grid, gap, known)
        if finer is None:
            break
        worst = int(np.argmin(np.minimum(grid.value[1:], grid.value[:-1]) - gap))
        narrow = (*narrow, *_narrow(path, grid.matrix[worst], known))[-MAX_NARROW:]
        grid, gap = finer, fall(finer.start, finer.matrix, window, known, narrow)
    return _summary(path, window, grid, gap, known)


def _narrow(path: Signal, matrix: Float[Array, "3 3"], known: Enclosure) -> tuple[Narrow, ...]:
    """The line and the plane in which one window is excited least."""
    vectors = np.linalg.eigh(matrix)[1]
    return along(path, vectors[:, :1], known), along(path, vectors[:, :2], known)


def _finer(path: Signal, window: float, grid: _Grid, gap: Float[Array, "c"], known: Enclosure) -> _Grid | None:
    """More starts and smaller cells where they help; None where they do not, or would be too much work."""
    least = float(grid.value.min())
    if least <= BELIEVED * grid.rounding:
        return None
    turn, share = grid.turn, grid.quadrature / (QUADRATURE_SHARE * least)
    if share > 1:
        turn *= max(MOST_FINER, share ** (-0.5 / GAUSS))
    spare = most_nodes(path) / GAUSS - cells(path, float(grid.start[-1]) + window, turn)
    start = _refined(grid, gap, most=min(MAX_STARTS, int(spare / 2) - 2 * len(known.edge)))
    if len(start) == len(grid.start) and share <= 1:
        return None
    try:
        return _windows(path, window, start, known, turn)
    except UnboundedDerivativeError:
        return None


def _windows(path: Signal, window: float, start: Array, known: Enclosure, turn: float) -> _Grid:
    """W on every window, and what it may be off by."""
    found = sums(path, window, start, known.edge, turn)
    until, length = float(start[-1]) + window, np.diff(found.edge)
    there = known.at(found.edge[:-1] + length / 2)
    error = np.concatenate([[0.0], np.cumsum(_quadrature(known)[there] * length ** (2 * GAUSS + 1))])
    shifted = NEAR * until + (knots.SAME if knots.has_pieces(path) else 0.0)  # s, that edges were put together
    evaluated = EPSILON * (ARITHMETIC + knots.smooth_bandwidth(path, until) * until)
    return _Grid(
        turn=turn,
        start=start,
        value=np.linalg.eigvalsh(found.matrix)[:, 0],
        matrix=found.matrix,
        quadrature=float(np.max(error[found.last] - error[found.first])),
        rounding=2 * (evaluated * window + shifted) * float(known.sizes[0].max()) ** 2
        + additions(len(found.edge)) * EPSILON * found.trace,
    )


def _quadrature(known: Enclosure) -> Float[Array, "m"]:
    """What Gauss's rule errs by on a cell, over h^{2m+1}, on each stretch."""
    m = GAUSS
    factor = math.factorial(m) ** 4 / ((2 * m + 1) * math.factorial(2 * m) ** 3)
    binomial = np.array([math.comb(2 * m, k) for k in range(2 * m + 1)])
    return factor * np.einsum("k,km,km->m", binomial, known.sizes, known.sizes[::-1])


def _refined(grid: _Grid, gap: Float[Array, "c"], *, most: int) -> Float[Array, "w"]:
    """More starts where the bound lies further below the least value than the share allows; at most so many."""
    if most <= len(grid.start):
        return grid.start
    least, share = float(grid.value.min()), SHARE
    above = np.minimum(grid.value[1:], grid.value[:-1]) - least
    while True:
        needed = np.ceil(np.sqrt(gap / (above / 2 + share * least)))
        parts = np.where(gap > above + share * least, needed, 1.0)
        if parts.sum() < most:
            break
        share *= 4
    parts = parts.astype(int)
    cell = np.repeat(np.arange(len(parts)), parts)
    inside = np.arange(len(cell)) - np.repeat(np.cumsum(parts) - parts, parts)
    start = grid.start[cell] + inside / parts[cell] * np.diff(grid.start)[cell]
    return np.append(start, grid.start[-1])


def _summary(path: Signal, window: float, grid: _Grid, gap: Float[Array, "c"], known: Enclosure) -> Bounds:
    least = float(grid.value.min())
    k = int(np.argmax(grid.value <= least + TIE * abs(least) + grid.floor))
    direction = _least_direction(grid.matrix[k], grid.floor)
    return Bounds(
        lower=max(0.0, lowest_between(grid.value, gap, grid.floor)),
        upper=max(0.0, float(grid.value[k])) + grid.floor,
        upper_everywhere=min(_most_along(path, window, n, grid, known) for n in (direction, *np.eye(3))),
        found=max(0.0, float(grid.value[k])),
        at=float(grid.start[k]),
        direction=direction,
        floor=grid.floor,
        starts=len(grid.start),
    )


def _least_direction(matrix: Float[Array, "3 3"], floor: float) -> Float[Array, "3"]:
    """The eigenvector of λ_min; where others are as bad, the first axis that reaches into their span, as seen in it."""
    value, vector = np.linalg.eigh(matrix)
    span = vector[:, value <= value[0] + TIE * value[-1] + floor]
    if span.shape[1] == 1:
        return oriented(span[:, 0])
    seen = span @ span.T  # columns: each axis as seen in the span
    size = np.linalg.norm(seen, axis=0)
    k = int(np.argmax(size >= 0.5))
    return oriented(seen[:, k] / size[k])


def _most_along(path: Signal, window: float, n: Float[Array, "3"], grid: _Grid, known: Enclosure) -> float:
    """λ_min ≤ nᵀWn for every window: at most what two neighbours have and it may rise between them, or δ max (n·q)²."""
    narrow = along(path, n[:, None], known)
    there = np.einsum("i,wij,j->w", n, grid.matrix, n)
    most = np.max(np.maximum(there[1:], there[:-1]) + rise(grid.start, window, known, narrow))
    return min(max(0.0, float(most)) + grid.floor, window * float(narrow.sizes[0].max()) ** 2)


def oriented(vector: Float[Array, "3"]) -> Float[Array, "3"]:
    """One of ± vector: the one whose largest component is positive; of nearly equal ones the first decides."""
    size = np.abs(vector)
    k = int(np.argmax(size >= (1 - TIE) * size.max()))
    return vector + 0.0 if vector[k] > 0 else -vector + 0.0
