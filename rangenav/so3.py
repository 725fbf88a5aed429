"""Rotations: hat, vee, exp and log between R³ and SO(3), for stacks of any shape.

exp(w) = I + sin θ/θ [w]x + (1 − cos θ)/θ² [w]x²,  θ = |w|   (Rodrigues).
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

SMALL_ANGLE = 1e-2
"""Below this angle (rad) a series of order 6 replaces the quotients: its first dropped term is under 1e-19."""


def hat(w: Float[Array, "*n 3"]) -> Float[Array, "*n 3 3"]:
    """The skew matrix [w]x with [w]x u = w × u."""
    matrix = np.zeros((*w.shape, 3))
    matrix[..., 2, 1], matrix[..., 0, 2], matrix[..., 1, 0] = w[..., 0], w[..., 1], w[..., 2]
    return matrix - np.swapaxes(matrix, -1, -2)


def vee(matrix: Float[Array, "*n 3 3"]) -> Float[Array, "*n 3"]:
    """The vector of the skew part of a matrix: vee(hat(w)) = w, and vee(M) = ψ_a(M) of the paper."""
    skew = (matrix - np.swapaxes(matrix, -1, -2)) / 2
    return np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=-1)


def exp(w: Float[Array, "*n 3"]) -> Float[Array, "*n 3 3"]:
    """The rotation by |w| radians about w."""
    angle = np.linalg.norm(w, axis=-1)[..., None, None]
    square = angle**2
    small = angle < SMALL_ANGLE
    safe = np.where(small, 1.0, angle)
    a = np.where(small, 1 - square / 6 * (1 - square / 20 * (1 - square / 42)), np.sin(safe) / safe)
    half = np.sin(safe / 2) / safe  # (1 − cos θ)/θ² = 2 sin²(θ/2)/θ² does not cancel
    b = np.where(small, 0.5 - square / 24 * (1 - square / 30 * (1 - square / 56)), 2 * half**2)
    W = hat(w)
    return np.eye(3) + a * W + b * (W @ W)


def log(rotation: Float[Array, "*n 3 3"]) -> Float[Array, "*n 3"]:
    """The rotation vector of least length, |w| ≤ π. At π the sign of the axis is a choice; both are right."""
    theta = angle(rotation)[..., None]
    sine_axis = vee(rotation)
    near_pi = theta > np.pi - 0.1
    safe = np.where((theta < SMALL_ANGLE) | near_pi, 1.0, theta)
    square = theta**2
    series = 1 + square / 6 * (1 + 7 * square / 60 * (1 + 31 * square / 294))
    factor = np.where(theta < SMALL_ANGLE, series, safe / np.sin(safe))
    return np.where(near_pi, theta * _axis_near_pi(rotation, sine_axis), factor * sine_axis)


def angle(rotation: Float[Array, "*n 3 3"]) -> Float[Array, "*n"]:
    """The rotation angle in [0, π], accurate at both ends: atan2(|vee R|, (tr R − 1)/2)."""
    sine = np.linalg.norm(vee(rotation), axis=-1)
    return np.asarray(np.arctan2(sine, (np.trace(rotation, axis1=-2, axis2=-1) - 1) / 2))


def _axis_near_pi(rotation: Array, sine_axis: Array) -> Array:
    """Near π, vee(R) fades; the symmetric part (R + Rᵀ)/2 = cos θ I + (1 − cos θ) uuᵀ determines u up to its sign."""
    symmetric = (rotation + np.swapaxes(rotation, -1, -2)) / 2
    cosine = (np.trace(rotation, axis1=-2, axis2=-1) - 1)[..., None, None] / 2
    outer = symmetric - cosine * np.eye(3)
    largest = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    column = np.take_along_axis(outer, largest[..., None, None], axis=-1)[..., 0]
    length = np.linalg.norm(column, axis=-1, keepdims=True)
    unit = column / np.where(length > 0, length, 1.0)
    sign = np.where(np.sum(unit * sine_axis, axis=-1, keepdims=True) < 0, -1.0, 1.0)
    return sign * unit
