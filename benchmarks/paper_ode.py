"""The paper's equations, integrated by scipy's DOP853 (paper, eq. 1, 7, 8, 9).

    ẋ̂ = 𝒜x̂ + b + P𝒞ᵀQ(y − 𝒞x̂)     Ṗ = 𝒜P + P𝒜ᵀ − P𝒞ᵀQ𝒞P + V     Ṙ̂ = R̂[ω + k1 σ]x     Ṙ = R[ω]x
The code is transcribed from the formulas, is not optimised, and shares nothing with the observers. Its signals are
continuous and free of noise. V is isotropic in each vector block, and so is the same matrix in body axes. 𝒜 is the
derived form: the last input is 3|g|². An optimised form (no np.cross, P𝒜ᵀ as the transpose of 𝒜P, outer products) was
tried and takes 0.6 times as long.
"""

import numpy as np
from scipy.integrate import solve_ivp

from rangenav.preset import Preset
from rangenav.signals import Flown

RTOL, ATOL = 1e-8, 1e-10
STATES, SPLITS = 13, (13, 182, 191)
"""The flat vector holds x̂ (13), P (169), R̂ (9) and R (9)."""
C = np.eye(1, STATES)


def solve(
    preset: Preset, state: np.ndarray, estimate: np.ndarray, rotation: np.ndarray, time: np.ndarray
) -> np.ndarray:
    """(n, 200): the solution at the given times, from x̂(0), R̂(0) and R(0), with the preset's constant gains."""
    gains = preset.gains
    covariance = np.diag(gains.riccati.p0.diagonal())
    start = np.concatenate([state, covariance.ravel(), estimate.ravel(), rotation.ravel()])
    V = np.diag(gains.riccati.v.diagonal())
    solution = solve_ivp(
        _rate, (time[0], time[-1]), start, "DOP853", time, rtol=RTOL, atol=ATOL,
        args=(preset, np.asarray(preset.world.gravity), np.asarray(preset.world.magnetic), V),
    )  # fmt: skip
    if not solution.success:
        raise ValueError(f"the paper's equations could not be integrated: {solution.message}")
    return solution.y.T


def _rate(time: float, flat: np.ndarray, preset: Preset, g: np.ndarray, m: np.ndarray, V: np.ndarray) -> np.ndarray:
    x, P, estimate, R = np.split(flat, SPLITS)
    P, estimate, R = P.reshape(STATES, STATES), estimate.reshape(3, 3), R.reshape(3, 3)
    assert not isinstance(preset.angular_velocity, Flown), "the equations are compared on a signal of its own"
    now = np.array(time)
    omega, p = preset.angular_velocity(now), preset.path(now) - np.asarray(preset.world.anchor)
    a, mag = R.T @ (preset.path(now, 2) - g), R.T @ m
    A, b = _matrices(omega, a, float(g @ g))
    q, k = preset.gains.riccati.q, preset.gains.attitude
    K = P @ C.T * q
    x_rate = A @ x + b + K @ (p @ p / 2 - C @ x)
    P_rate = A @ P + P @ A.T - K @ C @ P + V
    sigma = k.rho1 * np.cross(mag, estimate.T @ m) + k.rho2 * np.cross(x[10:], estimate.T @ g)
    estimate_rate, rotation_rate = estimate @ _hat(omega + k.k1 * sigma), R @ _hat(omega)
    return np.concatenate([x_rate, P_rate.ravel(), estimate_rate.ravel(), rotation_rate.ravel()])


def _matrices(omega: np.ndarray, a: np.ndarray, gravity_square: float) -> tuple[np.ndarray, np.ndarray]:
    """𝒜(ω, a) and the input b, body axes."""
    A, b = np.zeros((STATES, STATES)), np.zeros(STATES)
    A[[0, 1, 2], [1, 2, 3]] = 1.0
    A[1, 4:7], A[2, 7:10], A[3, 10:13] = a, 2 * a, 3 * a
    A[[4, 5, 6, 7, 8, 9], [7, 8, 9, 10, 11, 12]] = 1.0
    turn = -_hat(omega)
    A[4:7, 4:7] = A[7:10, 7:10] = A[10:13, 10:13] = turn
    b[3], b[7:10] = 3 * gravity_square, a
    return A, b


def _hat(w: np.ndarray) -> np.ndarray:
    x, y, z = w
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
