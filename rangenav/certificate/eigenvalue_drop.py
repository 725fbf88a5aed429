"""How far λ_min of W(t) can fall between two neighbouring starts s₀ and s₁, Δ apart.

With no knot in (s₀, s₁) nor in (s₀ + δ, s₁ + δ), q = p⁗ is smooth at both ends of the window while it slides, and
W″(t) = A(t + δ) − A(t), A = q q̇ᵀ + q̇ qᵀ. For every unit u
    |uᵀW″u| ≤ c(u) = Σ 2 |u·q| |u·q̇|, summed over the window's two ends,
so with κ = Δ²/8 and L(t) the straight line between W(s₀) and W(s₁),   uᵀW(t)u ≥ uᵀL(t)u − κ c(u).
Whatever u is, c(u) ≤ c = Σ 2 |q||q̇|; and λ_min is concave:
    λ_min(W(t)) ≥ min(λ_min(W(s₀)), λ_min(W(s₁))) − κc.                                                        (1)
That is all there is to say if nothing else is known. But a path that moves little along one direction, or within one
plane, has small eigenvalues there, and |q||q̇| is that of what is across. Let P project onto that line or plane, let
u = αn + βv with n in it and v across, and let a_k bound |P q⁽ᵏ⁾|, M_k |q⁽ᵏ⁾|:
    c(u) ≤ α² c₁₁ + 2|αβ| c₁₂ + β² c₂₂,   c₁₁ = Σ 2a₀a₁,  c₁₂ = Σ (a₀M₁ + a₁M₀),  c₂₂ = Σ 2M₀M₁,
and 2|αβ| c₁₂ ≤ α² s + β² c₁₂²/s for any s > 0. So W(t) is at least the matrix L(t) − κD, D = (c₁₁ + s) P +
(c₂₂ + c₁₂²/s)(I − P), and again by concavity
    λ_min(W(t)) ≥ min(λ_min(W(s₀) − κD), λ_min(W(s₁) − κD)).                                                    (2)
s is chosen so that κc₁₂²/s is a small share of the least eigenvalue across, which is then hardly felt. All of these
hold; the best one is taken.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.certificate import derivative_bounds
from rangenav.observability.excitation import drop_between
from rangenav.signals import Signal

ACROSS_SHARE = 0.05
"""Of the least eigenvalue across, that the cross term may cost there."""


@dataclass(frozen=True, eq=False)
class Enclosure:
    """|q⁽ᵏ⁾| ≤ sizes[k] on each stretch between neighbouring edges."""

    edge: Float[Array, "k"]
    sizes: Float[Array, "o m"]

    def at(self, time: Float[Array, "n"]) -> Int[Array, "n"]:
        """The stretch that each time lies in."""
        return np.clip(np.searchsorted(self.edge, time, side="right") - 1, 0, len(self.edge) - 2)

    def at_ends(self, start: Float[Array, "w"], window: float) -> tuple[Int[Array, "c"], Int[Array, "c"]]:
        """For each cell between neighbouring starts the stretches that the window's two ends move in."""
        middle = (start[1:] + start[:-1]) / 2
        return self.at(middle), self.at(middle + window)


@dataclass(frozen=True, eq=False)
class Narrow:
    """A projection onto a line or a plane, and |P q⁽ᵏ⁾| ≤ sizes[k], k = 0, 1, on the same stretches."""

    projector: Float[Array, "3 3"]
    rank: int
    sizes: Float[Array, "2 m"]


def enclosed(path: Signal, until: float, highest: int) -> Enclosure:
    """The snap and its derivatives up to the highest on stretches of [0, until]; infinite where nothing is known."""
    edge = derivative_bounds.stretches(path, until)
    return Enclosure(edge, path.derivative_bounds(edge, range(4, 5 + highest)))


def along(path: Signal, basis: Float[Array, "3 r"], known: Enclosure) -> Narrow:
    """The snap along the orthonormal columns, and its rate; a plane has next to none along its normal."""
    projector = basis @ basis.T
    projected = path.mapped(np.vstack([basis.T, np.zeros((3 - basis.shape[1], 3))]), np.zeros(3))
    return Narrow(projector, basis.shape[1], projected.derivative_bounds(known.edge, range(4, 6)))


def fall(
    start: Float[Array, "w"],
    matrix: Float[Array, "w 3 3"],
    window: float,
    known: Enclosure,
    narrow: tuple[Narrow, ...],
) -> Float[Array, "c"]:
    """How far λ_min may lie below the lower one of both ends, between neighbouring starts: the best of (1) and (2)."""
    every = np.linalg.eigvalsh(matrix)
    lowest = np.minimum(every[1:], every[:-1])
    gaps = [_isotropic(start, window, known)]
    for one in narrow:
        kappa = np.diff(start) ** 2 / 8
        c11, c12, c22 = _curvatures(start, window, known, one)
        allowed = ACROSS_SHARE * np.maximum(lowest[:, one.rank], 0.0)
        usable = allowed > 0
        cross = np.divide((kappa * c12) ** 2, allowed, out=np.zeros_like(allowed), where=usable)
        within, across = kappa * c11 + cross, kappa * c22 + allowed
        taken = within[:, None, None] * one.projector + across[:, None, None] * (np.eye(3) - one.projector)
        left = np.minimum(*(np.linalg.eigvalsh(ends - taken)[:, 0] for ends in (matrix[:-1], matrix[1:])))
        gaps.append(np.where(usable, np.maximum(lowest[:, 0] - left, 0.0), np.inf))
    return np.minimum.reduce(gaps)


def rise(start: Float[Array, "w"], window: float, known: Enclosure, narrow: Narrow) -> Float[Array, "c"]:
    """How far nᵀWn may rise above the higher one of both ends: κc₁₁."""
    return np.diff(start) ** 2 / 8 * _curvatures(start, window, known, narrow)[0]


def _isotropic(start: Array, window: float, known: Enclosure) -> Float[Array, "c"]:
    """κc of each cell, whatever the direction."""
    snap, rate = known.sizes[:2]
    return drop_between(start, *((snap[end], rate[end]) for end in known.at_ends(start, window)))


def _curvatures(start: Array, window: float, known: Enclosure, narrow: Narrow) -> tuple[Array, Array, Array]:
    a, M = narrow.sizes, known.sizes
    each = (2 * a[0] * a[1], a[0] * M[1] + a[1] * M[0], 2 * M[0] * M[1])
    one, other = known.at_ends(start, window)
    c11, c12, c22 = (curvature[one] + curvature[other] for curvature in each)
    return c11, c12, c22
