"""How far λ_min of W(t) can fall between two neighbouring starts s₀ and s₁, Δ apart.

With no knot in (s₀, s₁) nor in (s₀ + δ, s₁ + δ), q = p⁗ is smooth at both ends of the window while it slides, and
W″(t) = A(t + δ) − A(t), A = q q̇ᵀ + q̇ qᵀ. For every unit u
    |uᵀW″u| ≤ c(u) = Σ 2 |u·q| |u·q̇|, summed over the window's two ends,
so with κ = Δ²/8 and L(t) the straight line between W(s₀) and W(s₁),   uᵀW(t)u ≥ uᵀL(t)u − κ c(u).
Whatever u is, c(u) ≤ c = Σ 2 |q||q̇|; and λ_min is concave:
    λ_min(W(t)) ≥ min(λ_min(W(s₀)), λ_min(W(s₁))) − κc.                                                        (1)
This is the best bound if only |q| and |q̇| are known. But a path that moves little along one direction, or within one
plane, has small eigenvalues there, while |q||q̇| is large because of the motion across. Let P project onto that line or
plane, let u = αn + βv with n in it and v orthogonal to it, |P q⁽ᵏ⁾| ≤ a_k and |q⁽ᵏ⁾| ≤ M_k:
    c(u) ≤ α² c₁₁ + 2|αβ| c₁₂ + β² c₂₂,   c₁₁ = Σ 2a₀a₁,  c₁₂ = Σ (a₀M₁ + a₁M₀),  c₂₂ = Σ 2M₀M₁,
and 2|αβ| c₁₂ ≤ α² s + β² c₁₂²/s for any s > 0. So W(t) is at least the matrix L(t) − κD, D = (c₁₁ + s) P +
(c₂₂ + c₁₂²/s)(I − P), and again by concavity
    λ_min(W(t)) ≥ min(λ_min(W(s₀) − κD), λ_min(W(s₁) − κD)).                                                    (2)
s is chosen so that κc₁₂²/s is a small share of the least eigenvalue across. Every one of these bounds holds, and the
best is used.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.observability import derivative_bounds
from rangenav.observability.excitation import drop_between
from rangenav.signals import Signal

ACROSS_SHARE = 0.05
"""Share of the least eigenvalue across by which the cross term may lower it."""


@dataclass(frozen=True, eq=False)
class SnapBounds:
    """Bounds of the snap and its derivatives: |q⁽ᵏ⁾| ≤ sizes[k] on each interval between neighbouring edges (s)."""

    edge: Float[Array, "k"]
    sizes: Float[Array, "o m"]

    def at(self, time: Float[Array, "n"]) -> Int[Array, "n"]:
        """The interval that each time lies in."""
        return np.clip(np.searchsorted(self.edge, time, side="right") - 1, 0, len(self.edge) - 2)

    def at_ends(self, start: Float[Array, "w"], window: float) -> tuple[Int[Array, "c"], Int[Array, "c"]]:
        """For each cell between neighbouring starts, the intervals in which the window's start and end move."""
        middle = (start[1:] + start[:-1]) / 2
        return self.at(middle), self.at(middle + window)


@dataclass(frozen=True, eq=False)
class ProjectedSnapBounds:
    """A projection P onto a line or a plane, and |P q⁽ᵏ⁾| ≤ sizes[k], k = 0, 1, on the same intervals."""

    projector: Float[Array, "3 3"]
    rank: int
    sizes: Float[Array, "2 m"]


def snap_bounds(path: Signal, until: float, highest: int) -> SnapBounds:
    """Bounds of q⁽⁰⁾ to q⁽ʰ⁾, h = highest, on intervals of [0, until] (s); infinite where none is known."""
    edge = derivative_bounds.stretches(path, until)
    return SnapBounds(edge, path.derivative_bounds(edge, range(4, 5 + highest)))


def projected_snap_bounds(path: Signal, basis: Float[Array, "3 r"], bounds: SnapBounds) -> ProjectedSnapBounds:
    """Bounds of the snap and its rate, projected onto the span of the orthonormal columns: a line or a plane."""
    projector = basis @ basis.T
    projected = path.mapped(np.vstack([basis.T, np.zeros((3 - basis.shape[1], 3))]), np.zeros(3))
    return ProjectedSnapBounds(projector, basis.shape[1], projected.derivative_bounds(bounds.edge, range(4, 6)))


def fall(
    start: Float[Array, "w"],
    matrix: Float[Array, "w 3 3"],
    window: float,
    bounds: SnapBounds,
    projections: tuple[ProjectedSnapBounds, ...],
) -> Float[Array, "c"]:
    """How far λ_min may fall between two neighbouring starts below its lower value there: the best of (1) and (2).

    (2) is left out where (1) keeps λ_min above the least value of all: such a cell decides nothing.
    """
    eigenvalues = np.linalg.eigvalsh(matrix)
    lowest = np.minimum(eigenvalues[1:], eigenvalues[:-1])
    gap, kappa = _isotropic(start, window, bounds), np.diff(start) ** 2 / 8
    for one in projections:
        open_ = np.flatnonzero(lowest[:, 0] - gap < eigenvalues[:, 0].min())
        c11, c12, c22 = (kappa * curvature for curvature in _curvatures(start, window, bounds, one))
        allowed = ACROSS_SHARE * np.maximum(lowest[:, one.rank], 0.0)
        open_ = open_[allowed[open_] > 0]
        within, across = c11[open_] + c12[open_] ** 2 / allowed[open_], c22[open_] + allowed[open_]
        subtracted = within[:, None, None] * one.projector + across[:, None, None] * (np.eye(3) - one.projector)
        ends = (np.linalg.eigvalsh(matrix[open_ + k] - subtracted)[:, 0] for k in (0, 1))
        gap[open_] = np.minimum(gap[open_], np.maximum(lowest[open_, 0] - np.minimum(*ends), 0.0))
    return gap


def rise(
    start: Float[Array, "w"], window: float, bounds: SnapBounds, projection: ProjectedSnapBounds
) -> Float[Array, "c"]:
    """How far nᵀWn may rise between two neighbouring starts above its higher value there: κc₁₁."""
    return np.diff(start) ** 2 / 8 * _curvatures(start, window, bounds, projection)[0]


def _isotropic(start: Array, window: float, bounds: SnapBounds) -> Float[Array, "c"]:
    """κc of each cell: the bound (1), which holds for every direction."""
    snap, rate = bounds.sizes[:2]
    return drop_between(start, *((snap[end], rate[end]) for end in bounds.at_ends(start, window)))


def _curvatures(
    start: Array, window: float, bounds: SnapBounds, projection: ProjectedSnapBounds
) -> tuple[Array, Array, Array]:
    a, M = projection.sizes, bounds.sizes
    each = (2 * a[0] * a[1], a[0] * M[1] + a[1] * M[0], 2 * M[0] * M[1])
    one, other = bounds.at_ends(start, window)
    c11, c12, c22 = (curvature[one] + curvature[other] for curvature in each)
    return c11, c12, c22
