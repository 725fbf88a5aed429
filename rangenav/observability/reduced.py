"""The reduced pair of Proposition 1: (Ā, r_4 R̄ᵀ) on (p, v, g), r_4 = [φᵀ, 4(ȧ + ω×a)ᵀ, 6aᵀ].

In inertial axes its rows are [p⁗ᵀ, 4p⃛ᵀ, 6a_Iᵀ]: the fourth derivative of the lifted output. The printed paper has
4ȧᵀ − 3aᵀ[ω]x for the second block (4ȧᵀ − 4aᵀ[ω]x is right), its own φ, and forgets R̄ (body axes).
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.motion import Motion, to_inertial
from rangenav.observability import excitation, quadrature, rows, windows
from rangenav.observability.spectrum import RANK_TOLERANCE
from rangenav.signals import Signal


def least_eigenvalue(path: Signal, gravity: Vec3, start: float, window: float) -> tuple[float, float]:
    """The least eigenvalue of the reduced pair's Gramian (1/δ)∫ over one window, SI, and the floor of rounding.

    Raises ValueError for what `windows.checked` refuses, and for a window with too many nodes.
    """
    starts, window = windows.checked_one(path, start, window)
    tau, weight = quadrature.nodes(path, starts, window)
    matrix = rows.reduced(path, gravity, starts, tau)[0] * np.sqrt(weight[0])[:, None]
    singular = np.linalg.svd(matrix, compute_uv=False)
    return float(singular[-1] ** 2), float((RANK_TOLERANCE * singular[0]) ** 2)


def sampled_least_eigenvalue(
    motion: Motion, start: float, window: float, *, printed_formula: bool, printed_row: bool, body_axes: bool
) -> float:
    """The same from a sampled motion, with any of the three misprints."""
    time = motion.time
    h = time[1] - time[0]
    first = round(start / h)
    inside = slice(first, first + round(window / h) + 1)
    tau = time[inside] - time[first]
    snap, jerk, accel = _r4(motion, printed_formula, printed_row, body_axes)
    matrix = rows.carry(snap[None, inside], jerk[None, inside], accel[None, inside], tau)[0]
    weight = np.full(len(tau), h / window)
    weight[[0, -1]] /= 2
    return float(np.linalg.svd(matrix * np.sqrt(weight)[:, None], compute_uv=False)[-1] ** 2)


def _r4(
    motion: Motion, printed_formula: bool, printed_row: bool, body_axes: bool
) -> tuple[Float[Array, "n 3"], Float[Array, "n 3"], Float[Array, "n 3"]]:
    a, w = motion.apparent_acceleration, motion.angular_velocity
    rate, _ = excitation.apparent_derivatives(motion)
    factor = 3.0 if printed_row else 4.0  # −aᵀ[ω]x = (ω×a)ᵀ
    snap = excitation.phi_printed(motion) if printed_formula else excitation.phi(motion)
    jerk, accel = 4 * rate + factor * np.cross(w, a), 6 * a
    if body_axes:
        return snap, jerk, accel
    return to_inertial(motion.rotation, snap), to_inertial(motion.rotation, jerk), to_inertial(motion.rotation, accel)
