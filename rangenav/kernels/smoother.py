"""One Gauss–Newton pass of the whole-record smoother: a Kalman filter forward on the errors, an adjoint backward.

Linearised about a nominal trajectory x̄, the errors obey δ⁺ = Φ δ + d + noise, d = f(x̄) ⊖ x̄⁺ the nominal one's defect.
The backward half is the modified Bryson–Frazier recursion: it inverts nothing, so the noise may be singular, as here.
"""

import numpy as np

from rangenav.kernels import rotation as rot
from rangenav.kernels import strapdown
from rangenav.kernels.jit import kernel

N = strapdown.N
ROW, GAIN, INNOVATION, TOTAL, KEPT = 0, N, 2 * N, 2 * N + 1, 2 * N + 2
"""What is kept of each scalar correction: its row, gain, innovation and the innovation's variance."""


@kernel
def log(r):
    """The rotation vector of r, for angles well below π."""
    x, y, z = (r[7] - r[5]) / 2, (r[2] - r[6]) / 2, (r[3] - r[1]) / 2
    sine = np.sqrt(x * x + y * y + z * z)
    if sine < 1e-5:
        return x, y, z  # the next term is θ³/6 < 2e-16
    factor = np.arctan2(sine, (r[0] + r[4] + r[8] - 1) / 2) / sine
    return factor * x, factor * y, factor * z


@kernel
def difference(position, velocity, r, positions, velocities, rotations, k, out):
    """out ← (position, velocity, r) ⊖ the nominal state at k; the attitude's part is log(r r̄ᵀ)."""
    for i in range(3):
        out[i] = position[i] - positions[k, i]
        out[3 + i] = velocity[i] - velocities[k, i]
    b = rot.load(rotations[k])
    transposed = (b[0], b[3], b[6], b[1], b[4], b[7], b[2], b[5], b[8])
    out[6], out[7], out[8] = log(rot.multiply(r, transposed))


@kernel
def forward(
    time, gyro, accel, mag, distance, attached, back, positions, velocities, rotations, first, P,
    errors, covariances, accelerations, kept, corrected, p,
):  # fmt: skip
    """Filter the errors about the nominal trajectory, keeping all that `backward` needs; returns twice the cost there.

    errors[k] and covariances[k] are after sample k's corrections, corrected[k] counts the corrections up to then. The
    cost has the terms of ranges, magnetometer and process noise.
    """
    x, defect, row = np.empty(N), np.empty(N), np.zeros(N)
    x[:] = first
    a, j, count, m, cost = (0.0, 0.0, 0.0), 0, len(distance), 0, 0.0
    for k in range(len(time)):
        position = (positions[k, 0], positions[k, 1], positions[k, 2])
        velocity = (velocities[k, 0], velocities[k, 1], velocities[k, 2])
        r = rot.load(rotations[k])
        if k > 0:
            h = time[k] - time[k - 1]
            moved, faster, turned, a = strapdown.move(
                positions[k - 1], velocities[k - 1], rot.load(rotations[k - 1]),
                gyro[k - 1], gyro[k], accel[k - 1], accel[k], h, p,
            )  # fmt: skip
            strapdown.predict_error(x, a, h)
            strapdown.predict_covariance(P, a, h, p)
            difference(moved, faster, turned, positions, velocities, rotations, k, defect)
            for i in range(N):
                x[i] += defect[i]
            for i in range(3):
                cost += defect[3 + i] ** 2 / (p.accel_density * h) + defect[6 + i] ** 2 / (p.gyro_density * h)
                accelerations[k, i] = a[i]
        while j < count and attached[j] == k:
            residual = distance[j] - strapdown.range_row(position, velocity, a, back[j], p, row)
            keep(x, P, row, residual, p.range_variance, kept[m])
            cost += residual**2 / p.range_variance
            j, m = j + 1, m + 1
        if not np.isnan(mag[k, 0] + mag[k, 1] + mag[k, 2]):
            first, second = strapdown.mag_residuals(r, mag[k], p)
            strapdown.mag_row(p.across2, -1.0, row)
            keep(x, P, row, first, p.mag_variance, kept[m])
            strapdown.mag_row(p.across1, 1.0, row)
            keep(x, P, row, second, p.mag_variance, kept[m + 1])
            cost += (first**2 + second**2) / p.mag_variance
            m += 2
        errors[k] = x
        covariances[k] = P
        corrected[k] = m
    return cost


@kernel
def keep(x, P, row, residual, variance, kept):
    """One correction, noted for the way back."""
    innovation, total = strapdown.correct(x, P, row, residual, variance, kept[GAIN:INNOVATION])
    kept[ROW:GAIN] = row
    kept[INNOVATION], kept[TOTAL] = innovation, total


@kernel
def backward(time, errors, covariances, accelerations, kept, corrected):
    """errors[k] ← the smoothed error, x − P λ with λ from the end: λ ← λ − row (ν/S + Kᵀλ), then λ ← Φᵀλ."""
    adjoint = np.zeros(N)
    for k in range(len(time) - 1, -1, -1):
        P = covariances[k]
        for i in range(N):
            for j in range(N):
                errors[k, i] -= P[N * i + j] * adjoint[j]
        for m in range(corrected[k] - 1, (corrected[k - 1] if k > 0 else 0) - 1, -1):
            change = kept[m, INNOVATION] / kept[m, TOTAL]
            for i in range(N):
                change += kept[m, GAIN + i] * adjoint[i]
            for i in range(N):
                adjoint[i] -= kept[m, ROW + i] * change
        if k > 0:
            transpose_transition(adjoint, accelerations[k], time[k] - time[k - 1])


@kernel
def transpose_transition(u, a, h):
    """u ← Φᵀu."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        uj, uk = h * (h / 2 * u[j] + u[3 + j]), h * (h / 2 * u[k] + u[3 + k])
        u[6 + i] += a[j] * uk - a[k] * uj  # ([a]x)u = a × u
    for i in range(3):
        u[3 + i] += h * u[i]


@kernel
def smooth_covariance(time, covariances, accelerations, p):
    """covariances[k], filtered, becomes smoothed: P ← (I − CΦ) P (I − CΦ)ᵀ + C (Q + P⁺) Cᵀ, C = P Φᵀ (Φ P Φᵀ + Q)⁻¹.

    A sum of positive terms. P − PΛP with the adjoint's Λ takes half the time, but loses its sign where a record tells
    10⁵ times more than was known before; so does P + C (P⁺ − P⁻) Cᵀ.
    """
    ahead, known, c, d = np.empty(N * N), np.empty(N * N), np.empty((N, N)), np.empty((N, N))
    for k in range(len(time) - 2, -1, -1):
        P, a, h = covariances[k], accelerations[k + 1], time[k + 1] - time[k]
        ahead[:] = P
        strapdown.predict_covariance(ahead, a, h, p)
        known[:] = covariances[k + 1]
        strapdown.add_noise(known, h, p)
        for i in range(N):  # row i of c: Φ times row i of P, which is row i of PΦᵀ
            for j in range(N):
                c[i, j] = P[N * i + j]
            strapdown.predict_error(c[i], a, h)
        factorise(ahead.reshape(N, N))
        for i in range(N):
            solve(ahead.reshape(N, N), c[i])
            for j in range(N):
                d[i, j] = -c[i, j]
            transpose_transition(d[i], a, h)
            d[i, i] += 1.0
        congruence(d, P.reshape(N, N), c, known.reshape(N, N))


@kernel
def factorise(M):
    """The lower triangle of M ← L with M = L Lᵀ."""
    for j in range(N):
        for i in range(j, N):
            total = M[i, j]
            for n in range(j):
                total -= M[i, n] * M[j, n]
            M[i, j] = np.sqrt(total) if i == j else total / M[j, j]


@kernel
def solve(L, u):
    """u ← (L Lᵀ)⁻¹ u."""
    for i in range(N):
        for n in range(i):
            u[i] -= L[i, n] * u[n]
        u[i] /= L[i, i]
    for i in range(N - 1, -1, -1):
        for n in range(i + 1, N):
            u[i] -= L[n, i] * u[n]
        u[i] /= L[i, i]


@kernel
def congruence(A, P, C, M):
    """P ← A P Aᵀ + C M Cᵀ, symmetric."""
    old, row = P.copy(), np.empty(N)
    for i in range(N):
        for j in range(i, N):
            P[i, j] = 0.0
    for F, S in ((A, old), (C, M)):
        for i in range(N):
            for j in range(N):
                row[j] = 0.0
                for n in range(N):
                    row[j] += F[i, n] * S[n, j]
            for j in range(i, N):
                for n in range(N):
                    P[i, j] += row[n] * F[j, n]
    for i in range(N):
        for j in range(i):
            P[i, j] = P[j, i]


@kernel
def apply(errors, positions, velocities, rotations):
    """Move the smoothed errors into the nominal trajectory; returns the longest step in position and in attitude."""
    farthest, widest, total = 0.0, 0.0, 0.0
    for k in range(len(errors)):
        for i in range(3):
            positions[k, i] += errors[k, i]
            velocities[k, i] += errors[k, 3 + i]
        x, y, z = errors[k, 6], errors[k, 7], errors[k, 8]
        rot.store(rot.orthonormal(rot.multiply(rot.exp(x, y, z), rot.load(rotations[k]))), rotations[k])
        square = errors[k, 0] ** 2 + errors[k, 1] ** 2 + errors[k, 2] ** 2
        farthest, widest = max(farthest, square), max(widest, x * x + y * y + z * z)
        total += square + x + y + z  # max() lets a NaN pass unseen, a sum does not
    if not np.isfinite(total):
        return np.nan, np.nan
    return np.sqrt(farthest), np.sqrt(widest)


@kernel
def residuals(
    time, gyro, accel, distance, attached, back, positions, velocities, rotations, covariances, out, p
):  # fmt: skip
    """out[j] ← (range less the one expected, its variance R − row P rowᵀ) along the smoothed trajectory."""
    row, a = np.zeros(N), (0.0, 0.0, 0.0)
    for j in range(len(distance)):
        k = attached[j]
        if k > 0:
            _, _, _, a = strapdown.move(
                positions[k - 1], velocities[k - 1], rot.load(rotations[k - 1]),
                gyro[k - 1], gyro[k], accel[k - 1], accel[k], time[k] - time[k - 1], p,
            )  # fmt: skip
        out[j, 0] = distance[j] - strapdown.range_row(positions[k], velocities[k], a, back[j], p, row)
        out[j, 1] = p.range_variance
        for i in range(N):
            for n in range(N):
                out[j, 1] -= row[i] * covariances[k, N * i + n] * row[n]
