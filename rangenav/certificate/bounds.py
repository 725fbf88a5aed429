"""What μ is at every t, proven: λ_min of W(t) = ∫_t^{t+δ} q qᵀ ds, q = p⁗, between the points of a grid as well.

Between neighbouring starts s₀ < s₁, Δ apart, with no knot in (s₀, s₁) nor in (s₀ + δ, s₁ + δ), q is smooth at both ends
of the window while it slides, so W″(t) = A(t + δ) − A(t), A = q q̇ᵀ + q̇ qᵀ. The eigenvalues of A are q·q̇ ± |q||q̇|, so
    |nᵀW″n| ≤ c = 2 (|q||q̇|)(window's end) + 2 (|q||q̇|)(window's start)        for every unit n,
and W differs from the straight line L between W(s₀) and W(s₁) by at most cΔ²/8. λ_min is concave, hence
    λ_min(W(t)) ≥ λ_min(L(t)) − cΔ²/8 ≥ min(λ_min(W(s₀)), λ_min(W(s₁))) − cΔ²/8,
    λ_min(W(t)) ≤ max(nᵀW(s₀)n, nᵀW(s₁)n) + cΔ²/8                                  for any unit n.
Snap that jumps (a minimum-snap curve at its ends, pieces from a file anywhere) makes W′ jump exactly when an end of the
window crosses a knot. Those starts, every knot and every knot less δ, are put on the grid, so each cell is smooth and
the above holds with the largest values on the stretches beside the knots. Where even jerk or a lower derivative jumps,
snap has an impulse j/ε over some ε → 0; for every ε the integral of (n·q)² is at least its part outside the impulses,
so the part between the knots, which is what is integrated here, stays a lower bound.

W itself is summed over small cells by Gauss's rule of m nodes; on a cell of length h it errs, for every unit n, by
    h^{2m+1} (m!)⁴ / ((2m+1) ((2m)!)³) · max|(nᵀqqᵀn)^{(2m)}|,   the last ≤ Σ C(2m, k) |q⁽ᵏ⁾| |q⁽²ᵐ⁻ᵏ⁾|,
which the same enclosures bound. It is taken off, as is an allowance for rounding.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.certificate import envelope
from rangenav.certificate.envelope import UnboundedError
from rangenav.signals import Signal, mapped, operations

GAUSS = 4
"""Nodes of a cell."""
TURN = 0.4
"""rad of the fastest tone in one cell: Gauss's rule then errs by less than 1e-11 of what is integrated."""
FIRST_STARTS, FIRST_CELLS = 129, 64
ROUNDS = 4
"""How often the grid is refined where its bound is too weak; twice is usual."""
MAX_STARTS, MAX_NODES = 40_000, 400_000
"""Starts of windows, and evaluations of the snap: a second on a small machine."""
SHARE = 0.01
"""The grid is refined until what lies between its points costs this share of the least μ."""
CHEAP_OPERATIONS = 20
"""A formula of so many operations costs as much as a few tones; longer ones are evaluated less often."""
NEAR = 1e-12
"""Edges nearer than this share of the whole time are one: rounding of knot less δ plus δ."""
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


@dataclass(frozen=True, eq=False, kw_only=True)
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
class _Stretches:
    """The snap's enclosures: |q⁽ᵏ⁾| ≤ sizes[k] on each stretch between neighbouring edges."""

    edge: Float[Array, "k"]
    sizes: Float[Array, "o m"]

    def at(self, time: Float[Array, "n"]) -> Int[Array, "n"]:
        """The stretch that each time lies in."""
        return np.clip(np.searchsorted(self.edge, time, side="right") - 1, 0, len(self.edge) - 2)


@dataclass(frozen=True, eq=False)
class _Grid:
    """Windows on a grid of starts."""

    turn: float
    """rad of the fastest tone in one cell."""
    start: Float[Array, "w"]
    value: Float[Array, "w"]
    """λ_min of each."""
    vector: Float[Array, "w 3"]
    """Its eigenvector."""
    matrix: Float[Array, "w 3 3"]
    quadrature: float
    rounding: float
    """What either may be off by, for every unit n and every window."""
    gap: Float[Array, "c"]
    """cΔ²/8 of the cell between neighbouring starts."""

    @property
    def floor(self) -> float:
        return self.quadrature + self.rounding


def bounds(path: Signal, window: float, end: float) -> Bounds:
    """Bounds of μ over windows that start in [0, end] (s).

    Raises UnboundedError, saying why, if nothing bounds the snap's derivatives or if it would be too much work.
    """
    until = end + window
    edge = envelope.stretches(path, until)
    known = _Stretches(edge, envelope.envelope(path, edge, range(4, 5 + 2 * GAUSS)))
    if not np.isfinite(known.sizes).all():
        raise UnboundedError("nothing is known to bound the path's snap and its derivatives")
    start = np.concatenate([np.linspace(0, end, FIRST_STARTS), edge, edge - window])
    start = _apart(np.clip(start, 0, end), until)
    grid = _windows(path, window, start, known, TURN)
    for _ in range(ROUNDS):
        finer = _finer(path, window, grid, known)
        if finer is None:
            break
        grid = finer
    return _summary(path, window, grid, known)


def _finer(path: Signal, window: float, grid: _Grid, known: _Stretches) -> _Grid | None:
    """More starts and smaller cells where they help; None where they do not, or would be too much work."""
    least = float(grid.value.min())
    if least <= BELIEVED * grid.rounding:
        return None
    turn, share = grid.turn, grid.quadrature / (QUADRATURE_SHARE * least)
    if share > 1:
        turn *= max(MOST_FINER, share ** (-0.5 / GAUSS))
    cells = _most_nodes(path) / GAUSS - _cells(path, float(grid.start[-1]) + window, turn)
    start = _refined(grid, most=min(MAX_STARTS, int(cells / 2) - 2 * len(known.edge)))
    if len(start) == len(grid.start) and share <= 1:
        return None
    try:
        return _windows(path, window, start, known, turn)
    except UnboundedError:
        return None


def _windows(path: Signal, window: float, start: Array, known: _Stretches, turn: float) -> _Grid:
    """W on every window, as the difference of two sums over cells."""
    until = float(start[-1]) + window
    count = _cells(path, until, turn)
    nodes = GAUSS * (count + 2 * len(start) + len(known.edge))
    if nodes > _most_nodes(path):
        raise UnboundedError(f"a grid over {until:.4g} s of this path would be too much work ({nodes} evaluations)")
    cell = _apart(np.concatenate([start, start + window, known.edge, np.linspace(0, until, count + 1)]), until)
    length = np.diff(cell)
    node, weight = np.polynomial.legendre.leggauss(GAUSS)
    snap = (
        path(cell[:-1, None] + length[:, None] * (node + 1) / 2, 4) * np.sqrt(length[:, None] * weight / 2)[..., None]
    )
    total = np.concatenate([np.zeros((1, 3, 3)), np.cumsum(snap.transpose(0, 2, 1) @ snap, axis=0)])
    first, last = _nearest(cell, start), _nearest(cell, start + window)
    value, vector = np.linalg.eigh(total[last] - total[first])
    error = np.concatenate(
        [[0.0], np.cumsum(_quadrature(known)[known.at(cell[:-1] + length / 2)] * length ** (2 * GAUSS + 1))]
    )
    evaluated = EPSILON * (ARITHMETIC + envelope.turning(path, until) * until)
    return _Grid(
        turn=turn,
        start=start,
        value=value[:, 0],
        vector=vector[:, :, 0],
        matrix=total[last] - total[first],
        quadrature=float(np.max(error[last] - error[first])),
        rounding=2 * (evaluated * window + NEAR * until) * float(known.sizes[0].max()) ** 2
        + len(cell) * EPSILON * float(np.trace(total[-1])),
        gap=_gap(start, window, known),
    )


def _cells(path: Signal, until: float, turn: float) -> int:
    """Cells that the fastest tone asks for, besides those that starts and knots make, and in any case some."""
    return math.ceil(max(FIRST_CELLS * TURN, envelope.turning(path, until) * until) / turn)


def _most_nodes(path: Signal) -> float:
    return MAX_NODES / (1 + operations(path) / CHEAP_OPERATIONS)


def _quadrature(known: _Stretches) -> Float[Array, "m"]:
    """What Gauss's rule errs by on a cell, over h^{2m+1}, on each stretch."""
    m = GAUSS
    factor = math.factorial(m) ** 4 / ((2 * m + 1) * math.factorial(2 * m) ** 3)
    binomial = np.array([math.comb(2 * m, k) for k in range(2 * m + 1)])
    return factor * np.einsum("k,km,km->m", binomial, known.sizes, known.sizes[::-1])


def _gap(start: Array, window: float, known: _Stretches) -> Float[Array, "c"]:
    middle, step = (start[1:] + start[:-1]) / 2, np.diff(start)
    rate = known.sizes[0] * known.sizes[1]
    return (rate[known.at(middle)] + rate[known.at(middle + window)]) * step**2 / 4


def _refined(grid: _Grid, *, most: int) -> Float[Array, "w"]:
    """More starts where the bound lies further below the least value than the share allows; at most so many."""
    if most <= len(grid.start):
        return grid.start
    least, share = float(grid.value.min()), SHARE
    above = np.minimum(grid.value[1:], grid.value[:-1]) - least
    while True:
        needed = np.ceil(np.sqrt(grid.gap / (above / 2 + share * least)))
        parts = np.where(grid.gap > above + share * least, needed, 1.0)
        if parts.sum() < most:
            break
        share *= 4
    parts = parts.astype(int)
    cell = np.repeat(np.arange(len(parts)), parts)
    inside = np.arange(len(cell)) - np.repeat(np.cumsum(parts) - parts, parts)
    start = grid.start[cell] + inside / parts[cell] * np.diff(grid.start)[cell]
    return np.append(start, grid.start[-1])


def _summary(path: Signal, window: float, grid: _Grid, known: _Stretches) -> Bounds:
    least = float(grid.value.min())
    k = int(np.argmax(grid.value <= least + TIE * abs(least) + grid.floor))
    direction = _least_direction(grid.matrix[k], grid.floor)
    lower = float(np.min(np.minimum(grid.value[1:], grid.value[:-1]) - grid.gap)) - grid.floor
    fixed = [_along(path, window, n, known) for n in (direction, *np.eye(3))]
    return Bounds(
        lower=max(0.0, lower),
        upper=max(0.0, float(grid.value[k])) + grid.floor,
        upper_everywhere=min(_along_worst(grid), *fixed),
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


def _along_worst(grid: _Grid) -> float:
    """The largest over all cells of max(nᵀW(s₀)n, nᵀW(s₁)n) + cΔ²/8, with n the better one of both ends' directions."""
    both = []
    for n in (grid.vector[:-1], grid.vector[1:]):
        ends = [np.einsum("wi,wij,wj->w", n, matrix, n) for matrix in (grid.matrix[:-1], grid.matrix[1:])]
        both.append(np.maximum(*ends))
    return max(0.0, float(np.max(np.minimum(*both) + grid.gap))) + grid.floor


def _along(path: Signal, window: float, n: Float[Array, "3"], known: _Stretches) -> float:
    """λ_min ≤ nᵀWn ≤ δ max (n·p⁗)² for one direction and all time: a plane has next to none along its normal."""
    projected = mapped(path, np.outer([1.0, 0.0, 0.0], n), np.zeros(3))
    return window * float(envelope.envelope(projected, known.edge, range(4, 5)).max()) ** 2


def oriented(vector: Float[Array, "3"]) -> Float[Array, "3"]:
    """One of ± vector: the one whose largest component is positive; of nearly equal ones the first decides."""
    size = np.abs(vector)
    k = int(np.argmax(size >= (1 - TIE) * size.max()))
    return vector + 0.0 if vector[k] > 0 else -vector + 0.0


def _apart(time: Array, until: float) -> Float[Array, "n"]:
    """Sorted, without those that rounding has made two of one."""
    time = np.sort(time)
    return time[np.diff(time, prepend=-np.inf) > NEAR * until]


def _nearest(edge: Array, time: Array) -> Int[Array, "n"]:
    after = np.clip(np.searchsorted(edge, time), 1, len(edge) - 1)
    return after - (time - edge[after - 1] < edge[after] - time)
