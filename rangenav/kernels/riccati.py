"""One step of the Riccati observer in turned axes: the gyro-integrated frame, in which 𝒜 is nilpotent and ω is gone.

P is a flat array of 169, row by row, symmetric to the last bit: one triangle is computed and mirrored (left
unsymmetrised it goes indefinite within 10⁴ steps). Flat with constant offsets, because only then does the compiler see
that rows do not overlap and work on four columns at once: 50 ns for Φ P, against 80 ns with two indices.
"""

import numpy as np

from rangenav.kernels.jit import inlined, kernel
from rangenav.kernels.layout import CONSISTENCY_TIME, ROUNDING
from rangenav.kernels.vectors import shared

N = 13
ROW1, ROW2, ROW3 = 1 * N, 2 * N, 3 * N
PX, PY, PZ = 4 * N, 5 * N, 6 * N
VX, VY, VZ = 7 * N, 8 * N, 9 * N
GX, GY, GZ = 10 * N, 11 * N, 12 * N


@kernel
def predict_state(x, ax, ay, az, h, b4):
    """x ← Φ(h) x + ∫Φ b for a constant apparent acceleration a (turned axes), b4 the constant input into ξ4."""
    ap = ax * x[4] + ay * x[5] + az * x[6]
    av = ax * x[7] + ay * x[8] + az * x[9]
    ag = ax * x[10] + ay * x[11] + az * x[12]
    aa = ax * ax + ay * ay + az * az
    h2, h3, h4 = h * h, h * h * h, h * h * h * h
    x[0] += h * x[1] + h2 / 2 * (x[2] + ap) + h3 / 6 * x[3] + h3 / 2 * av + h4 / 4 * ag + h4 / 24 * b4 + h4 / 8 * aa
    x[1] += h * (x[2] + ap) + h2 / 2 * (x[3] + 3 * av) + h3 * ag + h3 / 6 * b4 + h3 / 2 * aa
    x[2] += h * (x[3] + 2 * av) + h2 * (2.5 * ag + b4 / 2 + aa)
    x[3] += h * (3 * ag + b4)
    x[4] += h * x[7] + h2 / 2 * (x[10] + ax)
    x[5] += h * x[8] + h2 / 2 * (x[11] + ay)
    x[6] += h * x[9] + h2 / 2 * (x[12] + az)
    x[7] += h * (x[10] + ax)
    x[8] += h * (x[11] + ay)
    x[9] += h * (x[12] + az)


@kernel
def predict_covariance(P, ax, ay, az, h):
    """P ← Φ P Φᵀ: Φ P on whole rows, then (Φ P) Φᵀ on the upper triangle, then its mirror."""
    transition_rows(P, ax, ay, az, h)
    _transition_columns(P, ax, ay, az, h)
    mirror(P)
    for i in range(N):
        P[(N + 1) * i] *= 1 + ROUNDING


@kernel
def transition_rows(P, ax, ay, az, h):
    """P ← Φ P, from the top row down, so that every row still finds the old ones below it."""
    h2 = h * h
    for j in range(N):
        ap = ax * P[PX + j] + ay * P[PY + j] + az * P[PZ + j]
        av = ax * P[VX + j] + ay * P[VY + j] + az * P[VZ + j]
        ag = ax * P[GX + j] + ay * P[GY + j] + az * P[GZ + j]
        old = P[j], P[ROW1 + j], P[ROW2 + j], P[ROW3 + j]
        P[j], P[ROW1 + j], P[ROW2 + j], P[ROW3 + j] = xi(old, ap, av, ag, h)
        P[PX + j] += h * P[VX + j] + h2 / 2 * P[GX + j]
        P[PY + j] += h * P[VY + j] + h2 / 2 * P[GY + j]
        P[PZ + j] += h * P[VZ + j] + h2 / 2 * P[GZ + j]
        P[VX + j] += h * P[GX + j]
        P[VY + j] += h * P[GY + j]
        P[VZ + j] += h * P[GZ + j]


@inlined
def xi(p, ap, av, ag, h):
    """ξ of a column of P, h seconds later; ap, av and ag are the products of a with the three vectors below it."""
    h2, h3, h4 = h * h, h * h * h, h * h * h * h
    return (
        p[0] + (h * p[1] + h2 / 2 * (p[2] + ap) + h3 / 6 * p[3] + h3 / 2 * av + h4 / 4 * ag),
        p[1] + h * (p[2] + ap) + h2 / 2 * p[3] + 1.5 * h2 * av + h3 * ag,
        p[2] + h * (p[3] + 2 * av) + 2.5 * h2 * ag,
        p[3] + 3 * h * ag,
    )


@kernel
def _transition_columns(P, ax, ay, az, h):
    """The upper triangle of P Φᵀ; Φ is upper triangular, so no entry below the diagonal is asked for."""
    h2 = h * h
    for i in range(4):
        o = N * i
        ap = ax * P[o + 4] + ay * P[o + 5] + az * P[o + 6]
        av = ax * P[o + 7] + ay * P[o + 8] + az * P[o + 9]
        ag = ax * P[o + 10] + ay * P[o + 11] + az * P[o + 12]
        P[o], P[o + 1], P[o + 2], P[o + 3] = xi((P[o], P[o + 1], P[o + 2], P[o + 3]), ap, av, ag, h)
    for i in range(7):
        o = N * i
        P[o + 4] += h * P[o + 7] + h2 / 2 * P[o + 10]
        P[o + 5] += h * P[o + 8] + h2 / 2 * P[o + 11]
        P[o + 6] += h * P[o + 9] + h2 / 2 * P[o + 12]
    for i in range(10):
        o = N * i
        P[o + 7] += h * P[o + 10]
        P[o + 8] += h * P[o + 11]
        P[o + 9] += h * P[o + 12]


@kernel
def mirror(P):
    """Copy the upper triangle onto the lower."""
    for i in range(1, N):
        for j in range(i):
            P[N * i + j] = P[N * j + i]


@kernel
def add_block_noise(P, v, h):
    """P ← P + V h with V = diag(v_ξ, v_p, v_v, v_g), isotropic in each block and so the same in any axes."""
    xi, position, velocity, gravity = v[0] * h, v[1] * h, v[2] * h, v[3] * h
    for i in range(4):
        P[(N + 1) * i] += xi
    for i in range(3):
        P[(N + 1) * (4 + i)] += position
        P[(N + 1) * (7 + i)] += velocity
        P[(N + 1) * (10 + i)] += gravity


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
            P[N * i + j] += weight * (column[i] * column[j])


@kernel
def correct(x, P, y, variance):
    """One rank-one update with y = ½d² of the given variance (m⁴); returns the innovation and its variance."""
    innovation, total = y - x[0], P[0] + variance
    inverse = 1 / total
    scale, kept, step = np.sqrt(inverse), variance * inverse, innovation * inverse
    for i in range(N):
        x[i] += P[i] * step
    for i in range(1, N):
        u = P[i] * scale
        for j in range(1, N):  # u uᵀ as one product of equal factors: symmetric to the last bit
            P[N * i + j] -= u * (P[j] * scale)
    for i in range(N):  # ξ1's own row without the difference of two large numbers
        P[i] *= kept
        P[N * i] = P[i]
    return innovation, total


@kernel
def shown(x, P, y, variance):
    """What a correction that is shown, and not made, adds: P₁ᵢ times the first number to x̂ᵢ; products of two P₁ᵢ times
    the second number are taken from P, and P₁₁ is multiplied by the third."""
    if shared(variance) == 0.0:
        return 0.0, 0.0, 1.0
    inverse = 1 / (P[0] + variance)
    return (y - x[0]) * inverse, np.sqrt(inverse), variance * inverse


@kernel
def remind(x, P, h):
    """One correction with 0 = ξ1 − ½|p|², linearised at x̂: the residual is ½|p̂|² − ξ̂1 + ½ tr P_pp, row (1, −p̂).

    Its error is that of ½|e|², of mean ½t and variance below ½t², t = tr P_pp; see CONSISTENCY_TIME. While the position
    is not known that variance drowns the correction, so that starts from anywhere converge as without it.
    """
    px, py, pz = x[4], x[5], x[6]
    spread = P[(N + 1) * 4] + P[(N + 1) * 5] + P[(N + 1) * 6]
    residual = (px * px + py * py + pz * pz + spread) / 2 - x[0]
    gain = np.empty(N)
    for i in range(N):
        gain[i] = P[i] - (px * P[PX + i] + py * P[PY + i] + pz * P[PZ + i])
    total = gain[0] - (px * gain[4] + py * gain[5] + pz * gain[6]) + spread * spread * (CONSISTENCY_TIME / (2 * h))
    step, scale = residual / total, 1 / np.sqrt(total)
    for i in range(N):
        x[i] += gain[i] * step
        gain[i] *= scale
    for i in range(N):
        for j in range(N):  # one product of equal factors: symmetric to the last bit
            P[N * i + j] -= gain[i] * gain[j]


@inlined
def turned_block(t, P, o, u):
    """The lower triangle, row by row, of Tᵀ(B − uuᵀ)T, where B is the 3 × 3 block on P's diagonal in row o."""
    d = (N + 1) * o
    xx, xy, xz = P[d] - u[0] * u[0], P[d + 1] - u[0] * u[1], P[d + 2] - u[0] * u[2]
    yy, yz, zz = P[d + 14] - u[1] * u[1], P[d + 15] - u[1] * u[2], P[d + 28] - u[2] * u[2]
    ax, ay, az = xx * t[0] + xy * t[3] + xz * t[6], xy * t[0] + yy * t[3] + yz * t[6], xz * t[0] + yz * t[3] + zz * t[6]
    bx, by, bz = xx * t[1] + xy * t[4] + xz * t[7], xy * t[1] + yy * t[4] + yz * t[7], xz * t[1] + yz * t[4] + zz * t[7]
    cx, cy, cz = xx * t[2] + xy * t[5] + xz * t[8], xy * t[2] + yy * t[5] + yz * t[8], xz * t[2] + yz * t[5] + zz * t[8]
    return (
        t[0] * ax + t[3] * ay + t[6] * az,
        t[0] * bx + t[3] * by + t[6] * bz,
        t[1] * bx + t[4] * by + t[7] * bz,
        t[0] * cx + t[3] * cy + t[6] * cz,
        t[1] * cx + t[4] * cy + t[7] * cz,
        t[2] * cx + t[5] * cy + t[8] * cz,
    )
