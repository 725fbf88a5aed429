"""One step of the Riccati observer in turned axes: the gyro-integrated frame, in which 𝒜 is nilpotent and ω is gone.

P is 13 × 13 and symmetric to the last bit: predictions compute one triangle's values and mirror them, corrections
subtract a product u uᵀ. Left unsymmetrised it goes indefinite within 10⁴ steps.
"""

import numpy as np

from rangenav.kernels.compiled import kernel

N = 13


@kernel
def predict_state(x, a, h, b4):
    """x ← Φ(h) x + ∫Φ b for a constant apparent acceleration a (turned axes), b4 the constant input into ξ4."""
    ap = a[0] * x[4] + a[1] * x[5] + a[2] * x[6]
    av = a[0] * x[7] + a[1] * x[8] + a[2] * x[9]
    ag = a[0] * x[10] + a[1] * x[11] + a[2] * x[12]
    aa = a[0] * a[0] + a[1] * a[1] + a[2] * a[2]
    h2, h3, h4 = h * h, h * h * h, h * h * h * h
    x[0] += h * x[1] + h2 / 2 * (x[2] + ap) + h3 / 6 * x[3] + h3 / 2 * av + h4 / 4 * ag + h4 / 24 * b4 + h4 / 8 * aa
    x[1] += h * (x[2] + ap) + h2 / 2 * (x[3] + 3 * av) + h3 * ag + h3 / 6 * b4 + h3 / 2 * aa
    x[2] += h * (x[3] + 2 * av) + h2 * (2.5 * ag + b4 / 2 + aa)
    x[3] += h * (3 * ag + b4)
    for i in range(3):
        x[4 + i] += h * x[7 + i] + h2 / 2 * (x[10 + i] + a[i])
        x[7 + i] += h * (x[10 + i] + a[i])


@kernel
def transition_rows(P, a, h):
    """P ← Φ(h) P, row by row from the top, so that every row still finds the old ones below it."""
    h2, h3, h4 = h * h, h * h * h, h * h * h * h
    for j in range(N):
        ap = a[0] * P[4, j] + a[1] * P[5, j] + a[2] * P[6, j]
        av = a[0] * P[7, j] + a[1] * P[8, j] + a[2] * P[9, j]
        ag = a[0] * P[10, j] + a[1] * P[11, j] + a[2] * P[12, j]
        p1, p2, p3 = P[1, j], P[2, j], P[3, j]
        P[0, j] += h * p1 + h2 / 2 * (p2 + ap) + h3 / 6 * p3 + h3 / 2 * av + h4 / 4 * ag
        P[1, j] = p1 + h * (p2 + ap) + h2 / 2 * p3 + 1.5 * h2 * av + h3 * ag
        P[2, j] = p2 + h * (p3 + 2 * av) + 2.5 * h2 * ag
        P[3, j] = p3 + 3 * h * ag
        for i in range(3):
            v, g = P[7 + i, j], P[10 + i, j]
            P[4 + i, j] += h * v + h2 / 2 * g
            P[7 + i, j] = v + h * g


@kernel
def predict_covariance(P, a, h):
    """P ← Φ P Φᵀ = Φ (Φ P)ᵀ: the same row operations twice with a transposition between, then mirrored."""
    transition_rows(P, a, h)
    for i in range(N):
        for j in range(i):
            P[i, j], P[j, i] = P[j, i], P[i, j]
    transition_rows(P, a, h)
    for i in range(N):
        for j in range(i):
            P[i, j] = P[j, i]


@kernel
def add_block_noise(P, v, h):
    """P ← P + V h with V = diag(v_ξ, v_p, v_v, v_g), isotropic in each block and so the same in any axes."""
    for i in range(N):
        block = 0 if i < 4 else (i - 1) // 3
        P[i, i] += v[block] * h


@kernel
def add_imu_noise(P, x, accel_density, gyro_density, h):
    """P ← P + (G_a G_aᵀ q_a + G_ω G_ωᵀ q_ω) h, the IMU's noise through the input matrix at x̂ (noise-matched gains).

    Accel noise enters ξ2, ξ3, ξ4 along p̂, 2v̂, 3ĝ and v directly; gyro noise enters each vector block as x̂ × η.
    """
    column = np.zeros(N)
    for axis in range(3):
        column[:] = 0.0
        column[1], column[2], column[3] = x[4 + axis], 2 * x[7 + axis], 3 * x[10 + axis]
        column[7 + axis] = 1.0
        _add_outer(P, column, accel_density * h)
        column[:] = 0.0
        after, last = (axis + 1) % 3, (axis + 2) % 3
        for block in range(4, N, 3):  # (x × e_axis): component `after` is x_last, component `last` is −x_after
            column[block + after] = x[block + last]
            column[block + last] = -x[block + after]
        _add_outer(P, column, gyro_density * h)


@kernel
def _add_outer(P, column, weight):
    for i in range(1, N):
        for j in range(1, N):
            P[i, j] += weight * (column[i] * column[j])


@kernel
def correct(x, P, y, variance):
    """One rank-one update with y = ½d² of the given variance (m⁴); returns the innovation and its variance."""
    innovation, total = y - x[0], P[0, 0] + variance
    scale, kept = 1 / np.sqrt(total), variance / total
    u = np.empty(N)
    for i in range(N):
        u[i] = P[0, i] * scale
        x[i] += P[0, i] / total * innovation
    for i in range(1, N):
        for j in range(1, N):
            P[i, j] -= u[i] * u[j]
    for i in range(N):  # ξ1's own row without the difference of two large numbers
        P[0, i] *= kept
        P[i, 0] = P[0, i]
    return innovation, total
