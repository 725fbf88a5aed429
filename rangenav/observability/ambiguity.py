"""The ambiguities of a motion: straight-line differences Δp + Δv s that change the range least.

Two motions with the same IMU record and the same attitude have the same p̈, so their difference is Δp + Δv s. Their
ranges differ by

    e(s) = |q(s) + Δp + Δv s| − |q(s)|,   q = p − p_anchor,

whose derivative at 0 is q̂ᵀ[Δp + Δv s]: the nonlinear rows (rows.nonlinear) without gravity, which is known here.
Differences are measured by their RMS over the flight, in the orthonormal basis {1, √3 (2s/T − 1)} on each axis.
"""

import itertools
import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.arguments import finite_array, increasing_array, number
from rangenav.inputs import require
from rangenav.observability import symmetry
from rangenav.results import result

COARSE, FINE, KEPT = 12, 30, 6
"""Damped Gauss–Newton steps of all starts, then of the KEPT best; the result is within 3% of the best of 400 random
starts."""
FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-2, 1e-12, 1e6
"""Damping is added to the squared singular values of the range's rows, which are at most 1."""
EASIER, HARDER = 0.2, 8.0
"""Factors of the damping after a step that lowers the cost, and after one that does not."""
NEAREST = 1e-9
"""m; at the anchor a range has no direction: its row is zero, and this distance replaces the zero it is divided by."""
BLIND = 1e-7
"""Metres of range per metre of difference; below this the range does not change to first order."""
UNKNOWNS = 6
DIRECTIONS = np.array([one for one in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(one)])
"""The 26 directions from a cube's centre to its corners, edges and faces."""


@result
class Ambiguities:
    """The differences that the search converged to, the one that changes the range least first."""

    shift: Float[Array, "n 3"]
    """Δp (m) at the flight's start."""
    drift: Float[Array, "n 3"]
    """Δv (m/s)."""
    mismatch: Float[Array, "n"]
    """m: the RMS of e over the samples."""


@result
class Sensitivity:
    """How the range changes with straight-line differences, to first order."""

    singular: Float[Array, "6"]
    """RMS metres of range for each metre (RMS) of difference, descending."""
    shift: Float[Array, "3"]
    """Δp (m) at the flight's start of the difference of 1 m RMS that changes the range least."""
    drift: Float[Array, "3"]
    """Δv (m/s) of that difference."""


def sensitivity(position: Float[Array, "k 3"], time: Float[Array, "k"], duration: float) -> Sensitivity:
    """The linearised range over a flight; position (m, inertial axes) is relative to the anchor, time in s.

    Raises ValueError for arrays of other shapes, stamps that do not increase, or numbers that are not finite.
    """
    time, position, duration = _flight(time, position, duration)
    singular, right = _linearised(position, _basis(time, duration))
    least = right[singular <= max(float(singular[-1]), BLIND)]
    steadiest = np.linalg.svd(least[:, :3])[0][:, 0] @ least  # of several null vectors, the one of least drift
    shift, drift = _straight(steadiest[None], duration)
    return Sensitivity(singular=singular, shift=shift[0], drift=drift[0])


def search(
    position: Float[Array, "k 3"],
    acceleration: Float[Array, "k 3"],
    time: Float[Array, "k"],
    duration: float,
    *,
    apart: float,
) -> Ambiguities:
    """Differences of at least `apart` (m, RMS) that change the range least.

    position (m, relative to the anchor) and acceleration (m/s²) are in inertial axes, time is in s. The search starts
    at the mirror images and turns by 180° about the principal axes of position and acceleration, at the singular
    vectors of the linearised range, with both signs, and at shifts of `apart` in 26 directions.
    Raises ValueError for arrays of other shapes, stamps that do not increase, or numbers that are not finite.
    """
    time, position, duration = _flight(time, position, duration)
    acceleration = finite_array("acceleration", acceleration, position.shape)
    apart = number("apart", apart)
    require(apart > 0, f"apart must be positive, got {apart:g} m")
    basis = _basis(time, duration)
    axes = np.concatenate([np.linalg.svd(v, full_matrices=False)[2] for v in (acceleration, position)])
    mirrors = np.array([symmetry.mirror(axis) for axis in axes])
    guesses = position @ np.concatenate([mirrors, -mirrors, -np.eye(3)[None]]) - position
    _, right = _linearised(position, basis)
    fitted = np.einsum("kj,gki->gji", basis, guesses).reshape(len(guesses), UNKNOWNS) / len(time)
    steps = np.concatenate([DIRECTIONS, np.zeros_like(DIRECTIONS)], axis=1)
    start = _at_least(np.concatenate([fitted, apart * right, -apart * right, apart * steps]), apart)
    differences, cost = _descend(start, position, basis, apart, COARSE)
    differences, cost = _descend(differences[np.argsort(cost)[:KEPT]], position, basis, apart, FINE)
    order = np.argsort(cost)
    shift, drift = _straight(differences[order], duration)
    return Ambiguities(shift=shift, drift=drift, mismatch=np.sqrt(cost[order]))


def rms(shift: Float[Array, "3"], drift: Float[Array, "3"], duration: float) -> float:
    """m: the RMS of |Δp + Δv s| over the flight."""
    middle, change = shift + drift * (duration / 2), drift * duration
    return math.sqrt(float(middle @ middle + change @ change / 12))


def _flight(time: Array, position: Array, duration: float) -> tuple[Array, Array, float]:
    time, duration = increasing_array("time", time, ("k",)), number("duration", duration)
    require(len(time) > 0 and duration > 0, f"a flight must have samples and last longer than 0 s, got {duration:g} s")
    return time, finite_array("position", position, (len(time), 3)), duration


def _basis(time: Array, duration: float) -> Float[Array, "k 2"]:
    return np.stack([np.ones_like(time), np.sqrt(3) * (2 * time / duration - 1)], axis=-1)


def _straight(z: Array, duration: float) -> tuple[Array, Array]:
    """Δp and Δv of coordinates in the basis."""
    mean, slope = z[:, :3], np.sqrt(3) * z[:, 3:]
    return mean - slope, 2 * slope / duration


def _linearised(position: Array, basis: Array) -> tuple[Array, Array]:
    rows = _rows(position[None], basis)[0] / np.sqrt(len(basis))
    _, singular, right = np.linalg.svd(rows, full_matrices=False)
    return singular, right


def _rows(moved: Array, basis: Array) -> Float[Array, "n k 6"]:
    """∂|u|/∂z = ûᵀ ⊗ basis."""
    unit = moved / np.maximum(_length(moved), NEAREST)[..., None]
    return (basis[:, :, None] * unit[:, :, None, :]).reshape(*unit.shape[:2], UNKNOWNS)


def _change(z: Array, position: Array, basis: Array) -> tuple[Array, Array]:
    """e for each of many differences, and the moved positions."""
    moved = position + basis @ z.reshape(-1, 2, 3)
    return _length(moved) - _length(position), moved


def _length(vectors: Array) -> Array:
    """|v|: a third of the time that np.linalg.norm takes along a last axis of three."""
    return np.sqrt(np.einsum("...i,...i->...", vectors, vectors))


def _at_least(z: Array, apart: float) -> Array:
    """Differences shorter than `apart` are lengthened to it; a zero difference has no direction and is left out."""
    norm = np.linalg.norm(z, axis=-1, keepdims=True)
    z, norm = z[norm[:, 0] > 0], norm[norm[:, 0] > 0]
    return z * np.maximum(1.0, apart / norm)


def _descend(z: Array, position: Array, basis: Array, apart: float, steps: int) -> tuple[Array, Array]:
    """Levenberg–Marquardt for all starts at once, on the sphere |z| = `apart` where a step would end inside it."""
    damping = np.full(len(z), FIRST_DAMPING)
    error, moved = _change(z, position, basis)
    cost = np.mean(error**2, axis=-1)
    for _ in range(steps):
        new = _stepped(z, error, _rows(moved, basis), damping, apart)
        new_error, new_moved = _change(new, position, basis)
        new_cost = np.mean(new_error**2, axis=-1)
        better = new_cost < cost
        z, cost = np.where(better[:, None], new, z), np.where(better, new_cost, cost)
        error, moved = np.where(better[:, None], new_error, error), np.where(better[:, None, None], new_moved, moved)
        damping = np.clip(damping * np.where(better, EASIER, HARDER), LEAST_DAMPING, MOST_DAMPING)
    return z, cost


def _stepped(z: Array, error: Array, rows: Array, damping: Array, apart: float) -> Array:
    transposed = np.swapaxes(rows, 1, 2)
    gradient, normal = (transposed @ error[..., None])[..., 0] / error.shape[1], transposed @ rows / error.shape[1]
    new = z + _damped(normal, gradient, damping)
    near = np.linalg.norm(new, axis=-1) < apart
    radial = z[near] / np.linalg.norm(z[near], axis=-1, keepdims=True)
    tangential = np.eye(UNKNOWNS) - radial[:, :, None] * radial[:, None, :]
    tangential_gradient = (tangential @ gradient[near, :, None])[..., 0]
    # without the sphere's part in the curvature the last tenth of the descent takes five times as many steps
    pull = np.einsum("nj,nj->n", gradient[near], z[near]) / np.einsum("nj,nj->n", z[near], z[near])
    curved = tangential @ (normal[near] - np.maximum(pull, 0.0)[:, None, None] * np.eye(UNKNOWNS)) @ tangential
    tangent_step = _damped(curved, tangential_gradient, damping[near])
    new[near] = _at_least(z[near] + (tangential @ tangent_step[..., None])[..., 0], apart)
    return new


def _damped(normal: Array, gradient: Array, damping: Array) -> Array:
    matrix = normal + damping[:, None, None] * np.eye(UNKNOWNS)
    return -np.linalg.solve(matrix, gradient[..., None])[..., 0]
