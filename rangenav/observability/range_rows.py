"""Rows of ranges around one time, which triangles of many windows share, and the errors that a triangle leaves.

A row 𝒞Φ = [1, τ, τ²/2, τ³/6, Dᵀ, τDᵀ, ½τ²Dᵀ] begins with the cubics, so R of its QR decomposition is
    R = [R₁₁ R₁₂; 0 R₂₂],   cov(p, v, g) = R₂₂⁻¹ R₂₂⁻ᵀ,   rank = 4 + rank R₂₂.
Any cubic may be added to the last nine, the path may be replaced with what a cubic fit c₀ + c₁u + c₂u² + c₃u³ leaves of
it, q, and u⁴, u⁵ with the monic Legendre polynomials ℓ₄, ℓ₅. With u = τ/T the nine columns are
    qᵢ,   u qᵢ + c₃ᵢ ℓ₄,   ½u² qᵢ + ½(c₂ − ½gT²)ᵢ ℓ₄ + ½c₃ᵢ ℓ₅          for (p, Tv, T²g) at u = 0.
`gramian_rank` does the same for windows of their own, and says why.
"""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.observability import joined_triangles
from rangenav.observability.coordinates import UNKNOWNS
from rangenav.observability.cubic_fit import CUBIC
from rangenav.observability.gramian_rank import ROUNDING

CLEAR = 1e-9
"""Below this the norm of the inverse in units of the floors, which is no less than the rounding, stands for it."""


def columns(
    u: Float[Array, "w k"], curved: Float[Array, "w 3 k"], gravity: Vec3, unit: float
) -> tuple[Float[Array, "w k 13"], Float[Array, "w 9"]]:
    """Four cubics and the nine columns at times u · unit (s), and what is subtracted in each of the nine (m).

    curved: positions (m) at these times, without the path's straight part, which is a cubic too.
    """
    cubics = np.stack([np.ones_like(u), u, (3 * u**2 - 1) / 2, (5 * u**2 - 3) * u / 2], axis=-1)
    squares = cubics.swapaxes(1, 2) @ cubics
    fit = np.linalg.solve(squares, cubics.swapaxes(1, 2) @ curved.swapaxes(1, 2)).swapaxes(1, 2)  # (w, 3, 4)
    q = curved - fit @ cubics.swapaxes(1, 2)
    second, third = 1.5 * fit[..., 2] - np.asarray(gravity) * unit**2 / 2, 2.5 * fit[..., 3]
    fourth, fifth = u**4 - 6 / 7 * u**2 + 3 / 35, (u**4 - 10 / 9 * u**2 + 5 / 21) * u
    s, fourth, fifth = u[:, None], fourth[:, None], fifth[:, None]
    rows = np.empty((len(curved), CUBIC + UNKNOWNS, u.shape[1]))
    rows[:, :CUBIC] = cubics.swapaxes(1, 2)
    rows[:, 4:7] = q
    rows[:, 7:10] = s * q + third[..., None] * fourth
    rows[:, 10:13] = (s**2 * q + second[..., None] * fourth + third[..., None] * fifth) / 2
    large = np.concatenate([np.zeros((len(curved), 6)), np.abs(second) * np.abs(fourth).max(axis=2)], axis=1)
    return rows.swapaxes(1, 2), large


def errors(
    triangle: Float[Array, "w 13 13"],
    size: Float[Array, "w 9"],
    margin: float,
    *,
    clear: float = CLEAR,
    compiled: bool = False,
) -> tuple[Float[Array, "w 9 9"], Float[Array, "w"], Bool[Array, "w"]]:
    """R₂₂⁻¹ of each window, whose rows are the errors (m) of p, Tv and T²g; its relative rounding; and whether it is.

    size: of what is subtracted in each column (m). A column's floor is its rounding, ROUNDING · size by the weights of
    the rows, times a margin for what the decomposition adds. Where a singular value of R₂₂ in units of these floors
    does not exceed 1, the window does not determine the nine, and its rows are NaN.
    """
    left = triangle[:, CUBIC:, CUBIC:]
    columns = np.sqrt(np.einsum("wij,wij->wj", triangle[..., CUBIC:], triangle[..., CUBIC:]))
    floor = margin * ROUNDING * np.maximum(np.abs(triangle[:, 0, :1]) * size, columns)
    inverse, some = joined_triangles.inverses(left, compiled=compiled), floor.min(axis=1) > 0
    with np.errstate(invalid="ignore", over="ignore"):
        loss = np.sqrt(np.einsum("wij,wij,wi->w", inverse, inverse, floor**2))
    determined = some & (loss < clear)
    unclear = np.flatnonzero(some & ~determined)
    least = np.linalg.svd(left[unclear] / floor[unclear, None], compute_uv=False)[:, -1]
    loss[unclear], determined[unclear] = 1 / np.maximum(least, 1), least > 1
    inverse[~determined], loss[~determined] = np.nan, 1.0
    return inverse, loss, determined
