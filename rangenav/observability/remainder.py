"""The nine functions Dᵢ, τDᵢ, ½τ²Dᵢ less their cubic parts: what a window tells of position, velocity and gravity.

A row 𝒞Φ = [1, τ, τ²/2, τ³/6, Dᵀ, τDᵀ, ½τ²Dᵀ] begins with the cubics, so R of its QR decomposition is
    R = [R₁₁ R₁₂; 0 R₂₂],   cov(p, v, g) = R₂₂⁻¹ R₂₂⁻ᵀ,   rank = 4 + rank R₂₂.
Every cubic may be added to any of the nine. With u = τ/T, q the path less its cubic fit c₀ + c₁u + c₂u² + c₃u³, and the
monic Legendre polynomials ℓ₄, ℓ₅ in place of u⁴, u⁵, the nine are
    qᵢ,   u qᵢ + c₃ᵢ ℓ₄,   ½u² qᵢ + ½(c₂ − ½gT²)ᵢ ℓ₄ + ½c₃ᵢ ℓ₅          for (p, Tv, T²g) at u = 0.
A direct D has −½gτ², which is hundreds of metres in a window of 20 s and hides what a slow path of one metre tells.
"""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3

CUBICS = 4
"""The columns before the nine."""
ROUNDING = 16 * np.finfo(float).eps
"""Relative rounding of a column by its evaluation and by the decomposition."""


def columns(
    u: Float[Array, "v k"], curved: Float[Array, "w 3 k"], gravity: Vec3, unit: float
) -> tuple[Float[Array, "w k 13"], Float[Array, "w"]]:
    """Four cubics and the nine functions at times u · unit (s), and the amplitude (m) that the cubic fit is taken from.

    curved: positions (m) at these times, without the path's straight part; any straight part is a cubic.
    """
    cubics = np.stack([np.ones_like(u), u, (3 * u**2 - 1) / 2, (5 * u**2 - 3) * u / 2], axis=-1)
    fit = curved @ np.linalg.pinv(cubics).swapaxes(1, 2)  # (w, 3, 4)
    q = curved - fit @ cubics.swapaxes(1, 2)
    second, third = 1.5 * fit[..., 2] - np.asarray(gravity) * unit**2 / 2, 2.5 * fit[..., 3]
    fourth, fifth = u**4 - 6 / 7 * u**2 + 3 / 35, (u**4 - 10 / 9 * u**2 + 5 / 21) * u
    s, fourth, fifth = u[:, None], fourth[:, None], fifth[:, None]
    rows = np.empty((len(curved), CUBICS + 9, u.shape[1]))
    rows[:, :CUBICS] = cubics.swapaxes(1, 2)
    rows[:, 4:7] = q
    rows[:, 7:10] = s * q + third[..., None] * fourth
    rows[:, 10:13] = (s**2 * q + second[..., None] * fourth + third[..., None] * fifth) / 2
    return rows.swapaxes(1, 2), np.abs(curved).max(axis=(1, 2))


def errors(
    triangle: Float[Array, "w 13 13"], amplitude: Float[Array, "w"]
) -> tuple[Float[Array, "w 9 9"], Bool[Array, "w"]]:
    """R₂₂⁻¹ of each window, whose rows are the errors (m) of p, Tv and T²g, and whether the window determines them.

    A column of which the cubics leave less than its rounding is zero. The others are scaled to one length, and their
    least singular value must exceed the rounding of the worst column, relative to what is left of it. The rows are NaN
    where this does not hold.
    """
    equal, length, floor = _equal(triangle, amplitude)
    determined = np.linalg.svd(equal, compute_uv=False)[:, -1] > floor
    inverse = np.full(equal.shape, np.nan)
    inverse[determined] = np.linalg.inv(equal[determined]) / length[determined][..., None]
    return inverse, determined


def determined_errors(
    triangle: Float[Array, "13 13"], amplitude: float
) -> tuple[Float[Array, "9 9"], Float[Array, "9 _"]]:
    """For one window that may be blind: the errors of what it determines, and what it does not see (unit columns)."""
    equal, length, floor = (one[0] for one in _equal(triangle[None], np.array([amplitude])))
    _, singular, right = np.linalg.svd(equal)
    seen = singular > floor
    scaled = right.T / length[:, None]
    unseen = scaled[:, ~seen] / np.linalg.norm(scaled[:, ~seen], axis=0)
    return np.where(seen, scaled / np.where(seen, singular, 1.0), 0.0), unseen


def _equal(triangle: Array, amplitude: Array) -> tuple[Array, Array, Array]:
    """R₂₂ with columns of length 1 (or 0), these lengths (1 for 0), and the rounding of its singular values."""
    left = triangle[:, CUBICS:, CUBICS:]
    before = np.linalg.norm(triangle[:, :, CUBICS:], axis=1) + np.abs(triangle[:, 0, :1]) * amplitude[:, None]
    size = np.linalg.norm(left, axis=1)
    zero = size <= ROUNDING * before
    length = np.where(zero, 1.0, size)
    floor = ROUNDING * np.where(zero, 1.0, before / length).max(axis=1)
    return np.where(zero[:, None], 0.0, left / length[:, None]), length, floor
