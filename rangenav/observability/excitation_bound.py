"""Proven bounds of μ over all t: λ_min of W(t) = ∫_t^{t+δ} q qᵀ ds, q = p⁗, on a grid of starts and between its points.

Between two grid points λ_min falls below its lower value there by at most the drop of `eigenvalue_drop`, if no end of
the window crosses a knot. Where the snap jumps at a knot, W′ jumps when an end of the window reaches it. So every knot
and every knot less δ is a point of the grid, and W is smooth on each cell. Where the jerk or a lower derivative jumps,
the snap has an impulse j/ε of duration ε → 0. For every ε the integral of (n·q)² is at least its part outside the
impulses, and only that part is integrated, so the result remains a lower bound.

W itself is summed over small cells by Gauss's rule of m nodes. On a cell of length h its error, for every unit n, is at
most
    h^{2m+1} (m!)⁴ / ((2m+1) ((2m)!)³) · max|(nᵀqqᵀn)^{(2m)}|,   the last ≤ Σ C(2m, k) |q⁽ᵏ⁾| |q⁽²ᵐ⁻ᵏ⁾|,
which follows from the same bounds of the derivatives. It is subtracted, as is an allowance for rounding.
The upper bound is λ_min(W(t)) ≤ nᵀW(t)n, which holds for any unit n.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.observability.eigenvalue_drop import (
    ProjectedSnapBounds,
    SnapBounds,
    fall,
    projected_snap_bounds,
    rise,
    snap_bounds,
)
from rangenav.observability.excitation import lowest_between
from rangenav.observability.sums import GAUSS, NEAR, TURN, additions, cells, first_starts, most_nodes, sums
from rangenav.progress import stop_if_unwanted
from rangenav.results import result
from rangenav.signals import Signal, knots

ROUNDS = 8
"""Most refinements of the grid; two are usual."""
MAX_PROJECTIONS = 6
"""Lines and planes that are used at once: those of the cells whose bound was weakest in the last rounds."""
MAX_STARTS = 40_000
SHARE = 0.01
"""The grid is refined until the drop between its points is at most this share of the least μ."""
EPSILON = float(np.finfo(float).eps)
ARITHMETIC = 512.0
"""Rounding allowed to one evaluation of the snap, in units of EPSILON times its largest value; polynomials lose two
digits by cancellation."""
TIE = 1e-6
"""Windows whose μ differs by less than this share count as equally bad, and the first one is named."""
BELIEVED = 10.0
"""A μ below this many times its rounding is not refined: on no grid would it rise above the rounding."""
QUADRATURE_SHARE = 1e-4
"""Cells are made smaller until the bound of the quadrature's error is at most this share of the least μ."""
MOST_FINER = 1 / 8
"""The smallest factor by which cells are made smaller in one round."""


@result
class ExcitationBounds:
    """Bounds of λ_min over all starts t in [0, end], and the window of the grid where it is least; m²/s⁷ and s."""

    lower: float
    """λ_min(W(t)) is at least this for every t in [0, end]; never below 0."""
    upper: float
    """On the worst window of the grid λ_min is at most this."""
    upper_everywhere: float
    """λ_min(W(t)) is at most this for every t in [0, end]."""
    least: float
    """λ_min on the worst window of the grid."""
    at: float
    """s, where that window starts; the first of equally bad ones."""
    direction: Float[Array, "3"]
    """Unit vector along which that window is excited least; its largest component is positive."""
    floor: float
    """Error of each of these numbers by rounding and quadrature."""
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
    """Bounds of either error of nᵀWn, for every unit n and every window."""

    @property
    def floor(self) -> float:
        return self.quadrature + self.rounding


def excitation_bounds(path: Signal, window: float, end: float) -> ExcitationBounds:
    """Bounds of μ over windows that start in [0, end] (s).

    Raises UnboundedDerivativeError, with the reason, if derivatives of the snap have no known bound, or for too much
    work.
    """
    bounds = snap_bounds(path, end + window, 2 * GAUSS)
    if not np.isfinite(bounds.sizes).all():
        raise UnboundedDerivativeError("nothing is known to bound the path's snap and its derivatives")
    grid = _windows(path, window, first_starts(window, end, bounds.edge), bounds, TURN)
    projections = _projections(path, grid.matrix[int(np.argmin(grid.value))], bounds)
    gap = fall(grid.start, grid.matrix, window, bounds, projections)
    for _ in range(ROUNDS):
        stop_if_unwanted()
        finer = _finer(path, window, grid, gap, bounds)
        if finer is None:
            break
        worst = int(np.argmin(np.minimum(grid.value[1:], grid.value[:-1]) - gap))
        projections = (*projections, *_projections(path, grid.matrix[worst], bounds))[-MAX_PROJECTIONS:]
        grid, gap = finer, fall(finer.start, finer.matrix, window, bounds, projections)
    return _summary(path, window, grid, gap, bounds)


def _projections(path: Signal, matrix: Float[Array, "3 3"], bounds: SnapBounds) -> tuple[ProjectedSnapBounds, ...]:
    """Bounds of the snap in the line and in the plane in which one window is excited least."""
    vectors = np.linalg.eigh(matrix)[1]
    return projected_snap_bounds(path, vectors[:, :1], bounds), projected_snap_bounds(path, vectors[:, :2], bounds)


def _finer(path: Signal, window: float, grid: _Grid, gap: Float[Array, "c"], bounds: SnapBounds) -> _Grid | None:
    """A grid with more starts and smaller cells; None if these do not help or would be too much work."""
    least = float(grid.value.min())
    if least <= BELIEVED * grid.rounding:
        return None
    turn, share = grid.turn, grid.quadrature / (QUADRATURE_SHARE * least)
    if share > 1:
        turn *= max(MOST_FINER, share ** (-0.5 / GAUSS))
    spare = most_nodes(path) / GAUSS - cells(path, float(grid.start[-1]) + window, turn)
    start = _refined(grid, gap, most=min(MAX_STARTS, int(spare / 2) - 2 * len(bounds.edge)))
    if len(start) == len(grid.start) and share <= 1:
        return None
    try:
        return _windows(path, window, start, bounds, turn)
    except UnboundedDerivativeError:
        return None


def _windows(path: Signal, window: float, start: Array, bounds: SnapBounds, turn: float) -> _Grid:
    """W on every window, and bounds of its errors."""
    window_sums = sums(path, window, start, bounds.edge, turn)
    until, length = float(start[-1]) + window, np.diff(window_sums.edge)
    interval = bounds.at(window_sums.edge[:-1] + length / 2)
    error = np.concatenate([[0.0], np.cumsum(_quadrature(bounds)[interval] * length ** (2 * GAUSS + 1))])
    shifted = NEAR * until + (knots.SAME if knots.has_pieces(path) else 0.0)  # s: edges nearer than this are one edge
    evaluated = EPSILON * (ARITHMETIC + knots.smooth_bandwidth(path, until) * until)
    return _Grid(
        turn=turn,
        start=start,
        value=np.linalg.eigvalsh(window_sums.matrix)[:, 0],
        matrix=window_sums.matrix,
        quadrature=float(np.max(error[window_sums.last] - error[window_sums.first])),
        rounding=2 * (evaluated * window + shifted) * float(bounds.sizes[0].max()) ** 2
        + additions(len(window_sums.edge)) * EPSILON * window_sums.trace,
    )


def _quadrature(bounds: SnapBounds) -> Float[Array, "m"]:
    """The error bound of Gauss's rule on a cell, divided by h^{2m+1}, on each interval."""
    m = GAUSS
    factor = math.factorial(m) ** 4 / ((2 * m + 1) * math.factorial(2 * m) ** 3)
    binomial = np.array([math.comb(2 * m, k) for k in range(2 * m + 1)])
    return factor * np.einsum("k,km,km->m", binomial, bounds.sizes, bounds.sizes[::-1])


def _refined(grid: _Grid, gap: Float[Array, "c"], *, most: int) -> Float[Array, "w"]:
    """More starts, at most `most`, where the bound lies further below the least value than the share allows."""
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


def _summary(path: Signal, window: float, grid: _Grid, gap: Float[Array, "c"], bounds: SnapBounds) -> ExcitationBounds:
    least = float(grid.value.min())
    k = int(np.argmax(grid.value <= least + TIE * abs(least) + grid.floor))
    direction = _least_direction(grid.matrix[k], grid.floor)
    return ExcitationBounds(
        lower=max(0.0, lowest_between(grid.value, gap, grid.floor)),
        upper=max(0.0, float(grid.value[k])) + grid.floor,
        upper_everywhere=min(_most_along(path, window, n, grid, bounds) for n in (direction, *np.eye(3))),
        least=max(0.0, float(grid.value[k])),
        at=float(grid.start[k]),
        direction=direction,
        floor=grid.floor,
        starts=len(grid.start),
    )


def _least_direction(matrix: Float[Array, "3 3"], floor: float) -> Float[Array, "3"]:
    """The eigenvector of λ_min; if other eigenvalues are as small, a coordinate axis projected onto the eigenspace."""
    value, vector = np.linalg.eigh(matrix)
    span = vector[:, value <= value[0] + TIE * value[-1] + floor]
    if span.shape[1] == 1:
        return oriented(span[:, 0])
    projected = span @ span.T  # columns: each axis projected onto the span
    size = np.linalg.norm(projected, axis=0)
    k = int(np.argmax(size >= 0.5))
    return oriented(projected[:, k] / size[k])


def _most_along(path: Signal, window: float, n: Float[Array, "3"], grid: _Grid, bounds: SnapBounds) -> float:
    """A bound of λ_min ≤ nᵀWn for all windows: the values at the starts plus the rise between them, or δ max (n·q)²."""
    projection = projected_snap_bounds(path, n[:, None], bounds)
    along_n = np.einsum("i,wij,j->w", n, grid.matrix, n)
    most = np.max(np.maximum(along_n[1:], along_n[:-1]) + rise(grid.start, window, bounds, projection))
    return min(max(0.0, float(most)) + grid.floor, window * float(projection.sizes[0].max()) ** 2)


def oriented(vector: Float[Array, "3"]) -> Float[Array, "3"]:
    """± the vector, with the sign that makes its largest component positive; of nearly equal ones the first counts."""
    size = np.abs(vector)
    k = int(np.argmax(size >= (1 - TIE) * size.max()))
    return vector + 0.0 if vector[k] > 0 else -vector + 0.0
