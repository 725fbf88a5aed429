"""Several runs of the cascade side by side, with constant gains: each number is the vector of all runs' numbers.

    w[LANES · place + c]   the number of run c at a place of the packed state (`layout`), then at the places below

The runs share their stamps; records, starts and gains are their own. Each formula is that of one run in the same order,
so that each run has to the last bit what it has alone. Of P only the upper triangle is kept.
"""

import numpy as np

from rangenav.kernels import attitude, cascade, riccati
from rangenav.kernels import rotation as rot
from rangenav.kernels.jit import inlined, kernel
from rangenav.kernels.layout import (
    ACCEL_AT,
    ACQUISITION_AT,
    GYRO_AT,
    MAG_AT,
    MISALIGNED_AT,
    P_AT,
    PENDING_AT,
    ROTATION_AT,
    ROUNDING,
    TURNED_AT,
    X_AT,
)
from rangenav.kernels.riccati import N
from rangenav.kernels.vectors import at, shared, written_soon

LANES = 8
"""Runs side by side: P and all else of eight stay in the first cache."""
PARAMETERS_AT = ACQUISITION_AT
BLOCKS, K1 = N + 4, N + 4 + 18
"""Places in an estimate: after x̂ and ξ's variances come the lower triangles of P's blocks, and k1."""
U_AT, INNOVATION_AT, OUT_AT = PARAMETERS_AT + 28, PARAMETERS_AT + 28 + N, PARAMETERS_AT + 30 + N
"""Work space: the scaled row of a correction; an innovation and its variance; an estimate."""
AHEAD = 4
LENGTH = OUT_AT + K1 + 1


@kernel
def run(
    w, time, imu, range_time, distance, states, xi_variance, covariances, rotations, gains, mags, innovation, first
):  # fmt: skip
    """Run LANES records from their range number `first` on, writing the estimates at every IMU sample.

    w: the packed states before ACQUISITION_AT, then the parameters. imu: gyro, accel and mag of each sample; distance:
    the ranges; both flat, the runs innermost. What is written begins with the run, and may hold fewer than LANES.
    """
    s, ranges = at(w, 0, LANES), at(distance, 0, LANES)
    p = attitude.unpacked(at(w, LANES * PARAMETERS_AT, LANES))
    for k in range(len(time)):
        if k > 0:
            sample = at(imu, 9 * LANES * k, LANES)
            last = cascade.due(range_time, first, time[k])
            _advance(s, w, time[k - 1], time[k], sample, range_time, ranges, first, last, innovation, p)
            first = last
        _read(s, w, p)
        for c in range(len(states)):
            _write(w, c, k, states, xi_variance, covariances, rotations, gains, mags)


@kernel
def lay(table, place, runs):
    """Lay a table of each of LANES runs beside those of the others: table[row, place + column, run]."""
    rows, width = runs[0].shape
    for k in range(rows):
        for j in range(width):
            for c in range(LANES):
                table[k, place + j, c] = runs[c][k, j]


@kernel
def _advance(s, w, t0, t1, sample, range_time, ranges, first, last, innovation, p):
    """`cascade.advance` of every run."""
    x, P = at(w, LANES * X_AT, LANES), at(w, LANES * P_AT, LANES)
    interval, reached = t1 - t0, 0.0
    gyro0, accel0, old = cascade.three(s, GYRO_AT), cascade.three(s, ACCEL_AT), rot.load_at(s, TURNED_AT)
    gyro1, accel1, mag1 = cascade.three(sample, 0), cascade.three(sample, 3), cascade.three(sample, 6)
    if shared(s[PENDING_AT + 1]) > 0:
        _correct(x, P, s, s[PENDING_AT], s[PENDING_AT + 1])
    s[PENDING_AT + 1], s[PENDING_AT + 2] = 0.0, 0.0
    turned = old
    for j in range(first, last + 1):
        at_end = j == last or range_time[j] == t1
        fraction = 1.0 if at_end else (range_time[j] - t0) / interval
        if fraction > reached:
            turned = _propagate(x, P, turned, gyro0, gyro1, accel0, accel1, reached, fraction, interval, p)
            reached = fraction
        if j == last:
            break
        y, variance = cascade.measured_y(ranges[j], p), p.variance
        s[INNOVATION_AT], s[INNOVATION_AT + 1] = y - x[0], P[0] + variance
        for c in range(len(innovation)):
            innovation[c, j, 0], innovation[c, j, 1] = w[LANES * INNOVATION_AT + c], w[LANES * (INNOVATION_AT + 1) + c]
        if p.symmetric and at_end:
            s[PENDING_AT], s[PENDING_AT + 1], s[PENDING_AT + 2] = y, variance, 2 * variance
        else:
            _correct(x, P, s, y, variance)
    cascade.turn_attitude(s, x, P, old, rot.orthonormal(turned), gyro1, accel1, mag1, interval, p)


@kernel
def _propagate(x, P, turned, gyro0, gyro1, accel0, accel1, begin, end, interval, p):
    """`cascade.propagate` of every run."""
    h = (end - begin) * interval
    increment, ax, ay, az = cascade.moved(turned, gyro0, gyro1, accel0, accel1, begin, end, interval)
    riccati.add_block_noise(P, p.v, h / 2)
    riccati.predict_state(x, ax, ay, az, h, p.b4)
    _predict_covariance(P, ax, ay, az, h)
    riccati.add_block_noise(P, p.v, h / 2)
    return rot.multiply(turned, increment)


@kernel
def _predict_covariance(P, ax, ay, az, h):
    """`riccati.predict_covariance` on the upper triangle: Φ P column by column, then (Φ P) Φᵀ row by row.

    A column's entries below the diagonal are read from the row of the same number, which is still the old one.
    """
    half = h * h / 2
    for j in range(N):
        ap = ax * _entry(P, 4, j) + ay * _entry(P, 5, j) + az * _entry(P, 6, j)
        av = ax * _entry(P, 7, j) + ay * _entry(P, 8, j) + az * _entry(P, 9, j)
        ag = ax * _entry(P, 10, j) + ay * _entry(P, 11, j) + az * _entry(P, 12, j)
        column = riccati.xi((P[j], _entry(P, 1, j), _entry(P, 2, j), _entry(P, 3, j)), ap, av, ag, h)
        P[j] = column[0]
        if j >= 1:
            P[N + j] = column[1]
        if j >= 2:
            P[2 * N + j] = column[2]
        if j >= 3:
            P[3 * N + j] = column[3]
        for i in range(4, min(j + 1, 7)):
            P[N * i + j] += h * _entry(P, i + 3, j) + half * _entry(P, i + 6, j)
        for i in range(7, min(j + 1, 10)):
            P[N * i + j] += h * _entry(P, i + 3, j)
    for i in range(4):
        o = N * i
        ap = ax * P[o + 4] + ay * P[o + 5] + az * P[o + 6]
        av = ax * P[o + 7] + ay * P[o + 8] + az * P[o + 9]
        ag = ax * P[o + 10] + ay * P[o + 11] + az * P[o + 12]
        row = riccati.xi((P[o], P[o + 1], P[o + 2], P[o + 3]), ap, av, ag, h)
        P[o + 3] = row[3]
        if i <= 2:
            P[o + 2] = row[2]
        if i <= 1:
            P[o + 1] = row[1]
        if i == 0:
            P[o] = row[0]
    for i in range(7):
        for j in range(max(i, 4), 7):
            P[N * i + j] += h * P[N * i + j + 3] + half * P[N * i + j + 6]
    for i in range(10):
        for j in range(max(i, 7), 10):
            P[N * i + j] += h * P[N * i + j + 3]
    for i in range(N):
        P[(N + 1) * i] *= 1 + ROUNDING


@inlined
def _entry(P, i, j):
    return P[N * min(i, j) + max(i, j)]


@kernel
def _correct(x, P, s, y, variance):
    """`riccati.correct` on the upper triangle."""
    inverse = 1 / (P[0] + variance)
    scale, kept, step = np.sqrt(inverse), variance * inverse, (y - x[0]) * inverse
    for i in range(N):
        p = P[i]
        x[i] += p * step
        s[U_AT + i], P[i] = p * scale, p * kept
    for i in range(1, N):
        u = s[U_AT + i]
        for j in range(i, N):
            P[N * i + j] -= u * s[U_AT + j]


@kernel
def _read(s, w, p):
    """`cascade.read` of every run, and k1, into the work space."""
    x, P, t, out = (
        at(w, LANES * X_AT, LANES),
        at(w, LANES * P_AT, LANES),
        rot.load_at(s, TURNED_AT),
        at(w, LANES * OUT_AT, LANES),
    )
    step, root, kept = riccati.shown(x, P, s[PENDING_AT], s[PENDING_AT + 2])
    for i in range(4):
        out[i], u = x[i] + P[i] * step, P[i] * root
        out[N + i] = P[(N + 1) * i] - u * u
    out[N] = P[0] * kept
    for block in range(3):
        o = 4 + 3 * block
        shift, u = (P[o] * step, P[o + 1] * step, P[o + 2] * step), (P[o] * root, P[o + 1] * root, P[o + 2] * root)
        out[o], out[o + 1], out[o + 2] = rot.apply_inverse(t, x[o] + shift[0], x[o + 1] + shift[1], x[o + 2] + shift[2])
        k = BLOCKS + 6 * block
        out[k], out[k + 1], out[k + 2], out[k + 3], out[k + 4], out[k + 5] = riccati.turned_block(t, P, o, u)
    out[K1] = attitude.gain(s[MISALIGNED_AT], p)


@kernel
def _write(w, c, k, states, xi_variance, covariances, rotations, gains, mags):
    """Row k of one run, and have the lines of the cache fetched where a later row will be."""
    later = c * states.shape[1] + k + AHEAD
    written_soon(states, 13 * later)
    written_soon(states, 13 * later + 8)
    written_soon(xi_variance, 4 * later)
    for i in range(0, 27, 8):
        written_soon(covariances, 27 * later + i)
    written_soon(rotations, 9 * later)
    written_soon(mags, 3 * later)
    written_soon(gains, later)
    for i in range(N):
        states[c, k, i] = w[LANES * (OUT_AT + i) + c]
    for i in range(4):
        xi_variance[c, k, i] = w[LANES * (OUT_AT + N + i) + c]
    place = LANES * (OUT_AT + BLOCKS) + c
    for block in range(3):
        for i in range(3):
            for j in range(i + 1):
                covariances[c, k, block, i, j] = covariances[c, k, block, j, i] = w[place]
                place += LANES
    for i in range(3):
        mags[c, k, i] = w[LANES * (MAG_AT + i) + c]
        for j in range(3):
            rotations[c, k, i, j] = w[LANES * (ROTATION_AT + 3 * i + j) + c]
    gains[c, k] = w[LANES * (OUT_AT + K1) + c]
