"""One interval and one set of corrections of the nine-state problem: position, velocity, attitude error, inertial axes.

The error is R = exp([φ]x) R̂, so a turn measured by the gyro leaves it alone, and the process noise is the same
isotropic one at every step. P is a flat array of 81, row by row; P, rows and gains are in the order p, v, φ.
"""

import numpy as np

from rangenav.kernels import rotation as rot
from rangenav.kernels.jit import kernel

N = 9
NO_GRADIENT = 1e-6
"""m; nearer to the anchor than this |p| has no useful gradient, and a range corrects nothing."""


@kernel
def move(position, velocity, r, gyro0, gyro1, accel0, accel1, h, p):
    """(position, velocity, rotation, mean of R a) h seconds later, from the samples at both ends.

    The rate is the mean of both ends, and the acceleration too, each end in its own axes: order 2.
    """
    half = h / 2
    increment = rot.exp(half * (gyro0[0] + gyro1[0]), half * (gyro0[1] + gyro1[1]), half * (gyro0[2] + gyro1[2]))
    turned = rot.orthonormal(rot.multiply(r, increment))
    x0, y0, z0 = rot.apply(r, accel0[0], accel0[1], accel0[2])
    x1, y1, z1 = rot.apply(turned, accel1[0], accel1[1], accel1[2])
    ax, ay, az = (x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2
    gx, gy, gz = p.gravity[0] + ax, p.gravity[1] + ay, p.gravity[2] + az
    square = h * half
    moved = (
        position[0] + h * velocity[0] + square * gx,
        position[1] + h * velocity[1] + square * gy,
        position[2] + h * velocity[2] + square * gz,
    )
    return moved, (velocity[0] + h * gx, velocity[1] + h * gy, velocity[2] + h * gz), turned, (ax, ay, az)


@kernel
def predict_error(x, a, h):
    """x ← Φ x, with Φ = [I, hI, −h²/2 [a]x; 0, I, −h [a]x; 0, 0, I]."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        c = h * (x[6 + j] * a[k] - x[6 + k] * a[j])  # −[a]x φ = φ × a
        x[i] += h * x[3 + i] + h / 2 * c
        x[3 + i] += c


@kernel
def predict_covariance(P, a, h, p):
    """P ← Φ P Φᵀ + Q."""
    ax, ay, az = h * a[0], h * a[1], h * a[2]
    half = h / 2
    for j in range(N):
        fx, fy, fz = P[54 + j], P[63 + j], P[72 + j]
        cx, cy, cz = fy * az - fz * ay, fz * ax - fx * az, fx * ay - fy * ax
        P[j] += h * P[27 + j] + half * cx
        P[9 + j] += h * P[36 + j] + half * cy
        P[18 + j] += h * P[45 + j] + half * cz
        P[27 + j] += cx
        P[36 + j] += cy
        P[45 + j] += cz
    for o in range(0, 81, N):
        fx, fy, fz = P[o + 6], P[o + 7], P[o + 8]
        cx, cy, cz = fy * az - fz * ay, fz * ax - fx * az, fx * ay - fy * ax
        P[o] += h * P[o + 3] + half * cx
        P[o + 1] += h * P[o + 4] + half * cy
        P[o + 2] += h * P[o + 5] + half * cz
        P[o + 3] += cx
        P[o + 4] += cy
        P[o + 5] += cz
    add_noise(P, h, p)
    for i in range(1, N):
        for j in range(i):
            P[N * i + j] = P[N * j + i]


@kernel
def add_noise(P, h, p):
    """P ← P + Q: accelerometer noise held over the interval (so h/2 of it reaches p), gyro noise into φ."""
    half, accel, gyro = h / 2, p.accel_density * h, p.gyro_density * h
    for i in range(3):
        P[10 * i] += half * half * accel
        P[10 * i + 3] += half * accel
        P[10 * i + 27] += half * accel
        P[10 * (3 + i)] += accel
        P[10 * (6 + i)] += gyro


@kernel
def range_row(position, velocity, a, back, p, row):
    """The distance `back` seconds before the sample at hand, p(t − τ) = p − τ v + ½τ² (g + a), and its row.

    a is the mean of R a over the interval that ends here. Noise within that part of an interval is left out.
    """
    square = back * back / 2
    px = position[0] - back * velocity[0] + square * (p.gravity[0] + a[0])
    py = position[1] - back * velocity[1] + square * (p.gravity[1] + a[1])
    pz = position[2] - back * velocity[2] + square * (p.gravity[2] + a[2])
    distance = np.sqrt(px * px + py * py + pz * pz)
    row[:] = 0.0
    if distance > NO_GRADIENT:
        ux, uy, uz = px / distance, py / distance, pz / distance
        row[0], row[1], row[2] = ux, uy, uz
        row[3], row[4], row[5] = -back * ux, -back * uy, -back * uz
        row[6] = square * (a[1] * uz - a[2] * uy)  # uᵀ(φ × a) = φᵀ(a × u)
        row[7] = square * (a[2] * ux - a[0] * uz)
        row[8] = square * (a[0] * uy - a[1] * ux)
    return distance


@kernel
def correct(x, P, row, residual, variance, gain):
    """Correct the error x and P by one residual = row·error + noise; returns the innovation and its variance."""
    total, innovation = variance, residual
    for i in range(N):
        weighted = 0.0
        for j in range(N):
            weighted += P[N * i + j] * row[j]
        gain[i] = weighted
    for i in range(N):
        total += row[i] * gain[i]
        innovation -= row[i] * x[i]
    scale = 1 / np.sqrt(total)
    for i in range(N):
        gain[i] *= scale
    for i in range(N):
        for j in range(N):  # one product of equal factors: symmetric to the last bit
            P[N * i + j] -= gain[i] * gain[j]
    for i in range(N):
        gain[i] *= scale
        x[i] += gain[i] * innovation
    return innovation, total


@kernel
def mag_residuals(r, mag, p):
    """R̂ m_y along the two axes e1, e2 across m, which to first order are −e2·φ and e1·φ; along m it tells nothing."""
    mx, my, mz = rot.apply(r, mag[0], mag[1], mag[2])
    e, f = p.across1, p.across2
    return e[0] * mx + e[1] * my + e[2] * mz, f[0] * mx + f[1] * my + f[2] * mz


@kernel
def mag_row(axis, sign, row):
    """The row ±axis on the attitude error."""
    row[:6] = 0.0
    row[6], row[7], row[8] = sign * axis[0], sign * axis[1], sign * axis[2]
