"""The pseudoinverse of a window's weighted rows H, and what the window does not see: H⁺ = (I − NNᵀ) M⁻¹ R⁺.

M and R are those of `gramian_rank`; N is an orthonormal basis of the changes of the state that change no range. Small
singular values of H are reciprocals of those of H⁺: H itself holds them to an absolute 1e-16 of the largest alone.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability.coordinates import STATES
from rangenav.observability.cubic_fit import CUBIC
from rangenav.observability.gramian_rank import Remainders

UNSEEN = 1e-13
"""The least share of position, velocity and gravity in a unit vector of a null space, above its rounding."""


def unseen(of: Remainders, units: Float[Array, "13"]) -> Float[Array, "w 13 13"]:
    """In the last 13 − rank columns an orthonormal basis of the changes of the state that change no range of a window.

    units: of the 13 coordinates, in units of 1 m and δ.
    """
    basis = np.zeros_like(of.triangle)
    for rank in np.unique(of.rank[of.rank < STATES]).tolist():
        which = np.flatnonzero(of.rank == rank)
        R, right = of.triangle[which], of.decomposition[2][which, rank - CUBIC :]
        inner = right.swapaxes(1, 2) / of.floor[which, :, None]
        outer = -np.linalg.solve(R[:, :CUBIC, :CUBIC], R[:, :CUBIC, CUBIC:] @ inner)
        states = of.states[which] @ np.concatenate([outer, inner], axis=1)
        basis[which, :, rank:] = np.linalg.qr(states / units[:, None])[0]
    return basis


def unseen_unknowns(unseen: Float[Array, "*w 13 k"]) -> Float[Array, "*w 9 k"]:
    """An orthonormal basis of what a null space holds of position, velocity and gravity; other columns are zero.

    A change of these is unseen together with one of the four polynomials' coordinates, which is 441 km² for 1 m on 300
    s: in a basis of all 13 it hides the change. No change of the polynomials alone is unseen.
    """
    left, size, _ = np.linalg.svd(unseen[..., CUBIC:, :], full_matrices=False)
    kept = np.zeros((*left.shape[:-1], unseen.shape[-1]))
    kept[..., : left.shape[-1]] = left * (size > UNSEEN)[..., None, :]
    return kept


def of_remainders(of: Remainders) -> Float[Array, "w 9 9"]:
    """The inverse of the remainders' triangle, where remainders that do not count are zero."""
    inverses, counts = of.regular
    if counts.all():
        return inverses
    inverses = inverses.copy()
    inverses[~counts] = _decomposed(of.some(~counts))
    return inverses


def _decomposed(of: Remainders) -> Float[Array, "w 9 9"]:
    left, size, right = of.decomposition
    counts = size > 1.0
    reciprocal = np.where(counts, 1 / np.where(counts, size, 1.0), 0.0)
    return right.swapaxes(1, 2) @ (reciprocal[..., None] * left.swapaxes(1, 2)) / of.floor[..., None]


def of_rows(of: Remainders) -> Float[Array, "w 13 13"]:
    """M⁻¹R⁺, where remainders that do not count are zero."""
    return with_remainders(of, of_remainders(of))


def with_remainders(of: Remainders, inner: Float[Array, "w 9 9"]) -> Float[Array, "w 13 13"]:
    """M⁻¹R⁺ where the inverse of the remainders' triangle is known."""
    result = np.zeros_like(of.triangle)
    outer = np.linalg.inv(of.triangle[:, :CUBIC, :CUBIC])
    result[:, :CUBIC, :CUBIC], result[:, CUBIC:, CUBIC:] = outer, inner
    result[:, :CUBIC, CUBIC:] = -outer @ of.triangle[:, :CUBIC, CUBIC:] @ inner
    return of.states @ result


def singular_values(inverse: Float[Array, "w 13 13"], unseen: Float[Array, "w 13 13"]) -> Float[Array, "w 13"]:
    """Singular values of H⁺ = (I − NNᵀ) M⁻¹R⁺, ascending: the reciprocals of those of H, zeros first."""
    seen = inverse - unseen @ (unseen.swapaxes(1, 2) @ inverse) if unseen.any() else inverse
    return np.linalg.svd(seen, compute_uv=False)[:, ::-1]
