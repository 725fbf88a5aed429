"""Changes of frame, each its own inverse: z-down ↔ z-up (x, −y, −z), NED ↔ ENU (y, x, −z), FRD ↔ FLU diag(1, −1, −1).

Each is a half turn, F = Fᵀ = F⁻¹, det F = 1. An inertial change acts on p, v, a and from the left on R, a body change
on what the body feels and from the right: R' = F R and R' = R F. Quaternions are wxyz, body to inertial, with w ≥ 0.
"""

import numpy as np
import scipy
from jaxtyping import Float
from numpy import ndarray as Array

Z_UP_Z_DOWN = np.diag([1.0, -1.0, -1.0])
"""A change of the inertial frame: x stays, y and z are reversed."""
FRD_FLU = np.diag([1.0, -1.0, -1.0])
"""A change of body axes: forward-right-down to forward-left-up and back."""
NED_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""A change of the inertial frame: north-east-down to east-north-up and back."""


def vector(change: Float[Array, "3 3"], value: Float[Array, "*n 3"]) -> Float[Array, "*n 3"]:
    """The vector in the other frame."""
    return value @ change.T


def inertial(change: Float[Array, "3 3"], quaternion: Float[Array, "*n 4"]) -> Float[Array, "*n 4"]:
    """The attitude seen from another inertial frame: F R."""
    return from_rotation(change @ to_rotation(quaternion))


def body(change: Float[Array, "3 3"], quaternion: Float[Array, "*n 4"]) -> Float[Array, "*n 4"]:
    """The attitude of other body axes: R F."""
    return from_rotation(to_rotation(quaternion) @ change)


def to_rotation(quaternion: Float[Array, "*n 4"]) -> Float[Array, "*n 3 3"]:
    """Rotation matrices of quaternions (wxyz) of any length but zero; NaN stays NaN."""
    flat = np.roll(quaternion.reshape(-1, 4), -1, axis=-1)
    matrices = np.full((len(flat), 3, 3), np.nan)
    known = np.isfinite(flat).all(axis=-1)
    if known.any():
        matrices[known] = scipy.spatial.transform.Rotation.from_quat(flat[known]).as_matrix()
    return matrices.reshape(*quaternion.shape[:-1], 3, 3)


def from_rotation(rotation: Float[Array, "*n 3 3"]) -> Float[Array, "*n 4"]:
    """Unit quaternions (wxyz) of rotation matrices, w ≥ 0."""
    matrices = np.array(rotation.reshape(-1, 3, 3))  # scipy before 1.16 refuses what is read-only, as every result is
    flat = scipy.spatial.transform.Rotation.from_matrix(matrices).as_quat(canonical=True)
    return np.roll(flat, 1, axis=-1).reshape(*rotation.shape[:-2], 4)


def continuous(quaternion: Float[Array, "n 4"]) -> Float[Array, "n 4"]:
    """The same attitudes with signs that do not jump from one sample to the next, for readers that interpolate."""
    along = np.sum(quaternion[1:] * quaternion[:-1], axis=-1)
    sign = np.cumprod(np.concatenate([[1.0], np.where(along < 0, -1.0, 1.0)]))
    return quaternion * sign[:, None]
