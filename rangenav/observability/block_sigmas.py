"""1-σ of position, velocity and gravity from weighted rows H: the square root of the trace of each block of (HᵀH)⁻¹.

HᵀH is never formed: the trace of a block is the sum of the squared norms of its rows of H⁻¹.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability import pseudoinverse
from rangenav.observability.coordinates import STATES
from rangenav.observability.cubic_fit import CUBIC
from rangenav.observability.gramian_rank import Remainders
from rangenav.observability.spectrum import LIFTED_TIME_POWERS, RANK_TOLERANCE

NULL_SHARE = 1e-6
"""A block whose part of every null vector is shorter than this is determined, although the whole state is not."""
BLOCKS = (slice(0, 3), slice(3, 6), slice(6, 9))
"""Position, velocity and gravity among the unknowns of either problem."""


def of_remainders(of: Remainders) -> Float[Array, "w 3"]:
    """Norms of the rows of M⁻¹R⁻¹ in each block; NaN where the null space reaches into the block."""
    result = row_norms(of, pseudoinverse.of_remainders(of))
    blind = pseudoinverse.unseen(of, np.ones(STATES))
    low = np.flatnonzero(of.rank < STATES)
    unseen = pseudoinverse.unseen_unknowns(blind[low])
    reach = np.stack([np.linalg.norm(unseen[:, block], axis=1).max(axis=1) for block in BLOCKS], axis=1)
    result[low] = np.where(reach > NULL_SHARE, np.nan, result[low])
    return result


def row_norms(of: Remainders, inner: Float[Array, "w 9 9"]) -> Float[Array, "w 3"]:
    """Norms of the rows of M⁻¹R⁻¹ in each block, in SI units; `inner` is the inverse of the remainders' triangle."""
    units = of.window ** LIFTED_TIME_POWERS[CUBIC:].astype(float)
    variance = np.sum((of.unknown_states @ inner) ** 2, axis=2) / units**2
    return np.sqrt(np.stack([variance[:, block].sum(axis=1) for block in BLOCKS], axis=1))


def of_triangles(R: Float[Array, "w r 9"], scale: Float[Array, "9"]) -> Float[Array, "w 3"]:
    """Norms of the rows of S R⁻¹ in each block; for windows that may be blind, from singular vectors instead.

    Where 1/|R⁻¹| exceeds the tolerance times |R|, every singular value counts. The inverse of a triangle takes a tenth
    of the time of its singular value decomposition.
    """
    missing = R.shape[-1] - R.shape[-2]  # fewer ranges than unknowns: rows of zeros add no information
    R = (np.pad(R, ((0, 0), (0, missing), (0, 0))) if missing > 0 else R) * scale
    size = np.linalg.norm(R, axis=(1, 2))
    regular = np.abs(np.diagonal(R, axis1=1, axis2=2)).min(axis=1) > RANK_TOLERANCE * size
    result = np.empty((len(R), len(BLOCKS)))
    with np.errstate(over="ignore", invalid="ignore"):
        inverse = np.linalg.inv(R[regular])
        determined = np.linalg.norm(inverse, axis=(1, 2)) * RANK_TOLERANCE * size[regular] < 1
        variance = np.einsum("wij,wij->wi", inverse, inverse) * scale**2
    result[regular] = np.sqrt(np.stack([variance[:, block].sum(axis=1) for block in BLOCKS], axis=1))
    regular[regular] = determined
    if not regular.all():
        result[~regular] = _determined_sigmas(R[~regular], scale)
    return result


def _determined_sigmas(R: Float[Array, "w 9 9"], scale: Float[Array, "9"]) -> Float[Array, "w 3"]:
    """Row norms of S V Σ⁻¹ over each block; NaN where the null space reaches into the block."""
    _, singular, right = np.linalg.svd(R)
    determined = singular > RANK_TOLERANCE * singular[:, :1]
    inverse = np.where(determined, 1 / np.where(determined, singular, 1.0), 0.0)
    result = np.empty((len(R), len(BLOCKS)))
    for j, block in enumerate(BLOCKS):
        part = right[:, :, block]
        undetermined = np.max(np.linalg.norm(part, axis=-1) * ~determined, axis=-1) > NULL_SHARE
        trace = np.sum((part * scale[block] * inverse[:, :, None]) ** 2, axis=(1, 2))
        result[:, j] = np.where(undetermined, np.nan, np.sqrt(trace))
    return result
