"""The whole cascade, one IMU interval at a time: predict in turned axes, correct with each range, turn the attitude.

A range between two IMU samples splits the interval there. A range at an IMU sample is applied in full, or, in the
symmetric (Strang) scheme, half before the estimate is read and half after, which makes x̂ and P second order in h.
"""

import numpy as np

from rangenav.kernels import acquisition, attitude, riccati
from rangenav.kernels import rotation as rot
from rangenav.kernels.jit import kernel
from rangenav.kernels.layout import (
    ACCEL_FAULT,
    COLLECTS,
    GYRO_FAULT,
    MAG_FAULT,
    MATCHED,
    MATCHED_V,
    NO_FAULT,
    PHASE,
    RANGE_FAULT,
    RANGE_TIME_FAULT,
    TIME_FAULT,
)


@kernel
def range_variance(x, matched, p):
    """Variance (m⁴) of one y: constant, or d̂²σ² + ½σ⁴ with the predicted d̂² (the measured d² would bias the gain)."""
    if not matched:
        return p.variance
    square, s2 = max(2 * x[0], 0.0), p.range_sigma * p.range_sigma
    return square * s2 + s2 * s2 / 2


@kernel
def measured_y(distance, p):
    """y = ½d², less the bias ½σ² that noise adds to a square (noise-matched only)."""
    bias = p.range_sigma * p.range_sigma if p.matched else 0.0
    return (distance * distance - bias) / 2


@kernel
def propagate(x, P, a, turned, gyro0, gyro1, accel0, accel1, begin, end, interval, p):
    """Predict from begin to end (fractions of the interval) and return the new turn.

    The acceleration is the mean of both ends, in the axes of the start: with the rate at the middle, order 2.
    """
    h, middle = (end - begin) * interval, (begin + end) / 2
    wx, wy, wz = _between(gyro0, gyro1, middle)
    increment = rot.exp(h * wx, h * wy, h * wz)
    ax0, ay0, az0 = _between(accel0, accel1, begin)
    ax1, ay1, az1 = _between(accel0, accel1, end)
    bx, by, bz = rot.apply(increment, ax1, ay1, az1)
    ax, ay, az = rot.apply(turned, (ax0 + bx) / 2, (ay0 + by) / 2, (az0 + bz) / 2)
    matched = a[PHASE] == MATCHED
    _add_noise(x, P, h / 2, matched, p)
    riccati.predict_state(x, ax, ay, az, h, p.b4)
    riccati.predict_covariance(P, ax, ay, az, h)
    _add_noise(x, P, h / 2, matched, p)
    if a[COLLECTS] > 0:
        acquisition.propagate(a, ax, ay, az, h, p.b4)
    return rot.multiply(turned, increment)


@kernel
def _between(start, end, fraction):
    return (
        start[0] + fraction * (end[0] - start[0]),
        start[1] + fraction * (end[1] - start[1]),
        start[2] + fraction * (end[2] - start[2]),
    )


@kernel
def _add_noise(x, P, h, matched, p):
    if matched:
        riccati.add_block_noise(P, MATCHED_V, h)
        riccati.add_imu_noise(P, x, p.accel_density, p.gyro_density, h)
    else:
        riccati.add_block_noise(P, p.v, h)


@kernel
def begin(s, distance, p):
    """Keep the correction by a range at the very first IMU sample: it is applied when the first interval starts."""
    a, y, matched = s.acquisition, measured_y(distance, p), s.acquisition[PHASE] == MATCHED
    variance = range_variance(s.x, matched, p)
    if a[COLLECTS] > 0:
        acquisition.collect(a, y, p)
    if not (matched and acquisition.outlier(a, y - s.x[0], s.P[0] + variance)):
        s.pending[0], s.pending[1] = y, variance * (2 if p.symmetric else 1)


@kernel
def advance(s, t0, t1, gyro1, accel1, mag1, range_time, distance, first, last, innovation, p):
    """Move the state from IMU sample t0 to t1, applying ranges first ≤ j < last, all stamped in (t0, t1].

    innovation[j] ← (y − ŷ, its variance) for each of them.
    """
    x, P, a, interval, reached = s.x, s.P, s.acquisition, t1 - t0, 0.0
    collects, matched = a[COLLECTS] > 0, a[PHASE] == MATCHED
    old = rot.load(s.turned)
    gravity0 = rot.apply_inverse(old, x[10], x[11], x[12])
    if not np.isnan(s.pending[0]):
        riccati.correct(x, P, s.pending[0], s.pending[1])
        s.pending[0] = np.nan
    turned = old
    for j in range(first, last + 1):  # up to each range, then up to the end: one call compiles in half the time of two
        at_end = j == last or range_time[j] == t1
        fraction = 1.0 if at_end else (range_time[j] - t0) / interval
        if fraction > reached:
            turned = propagate(x, P, a, turned, s.gyro, gyro1, s.accel, accel1, reached, fraction, interval, p)
            reached = fraction
        if j == last:
            break
        y, variance = measured_y(distance[j], p), range_variance(x, matched, p)
        if collects:
            acquisition.collect(a, y, p)
        if matched and acquisition.outlier(a, y - x[0], P[0] + variance):
            innovation[j, 0], innovation[j, 1] = y - x[0], P[0] + variance
            continue
        if p.symmetric and at_end:
            variance *= 2
            s.pending[0], s.pending[1] = y, variance
        innovation[j, 0], total = riccati.correct(x, P, y, variance)
        innovation[j, 1] = total - variance / 2 if p.symmetric and at_end else total  # of the whole correction
    if matched:
        riccati.remind(x, P, interval)
        acquisition.watch(a, P, p)
    if collects:
        acquisition.start(a, x, P, p)
    turned = rot.orthonormal(turned)
    rot.store(turned, s.turned)
    mag0, new_mag = (s.mag[0], s.mag[1], s.mag[2]), (mag1[0], mag1[1], mag1[2])
    if np.isnan(mag1[0] + mag1[1] + mag1[2]):  # no new sample: the last one, carried along by the gyro
        mx, my, mz = rot.apply(old, mag0[0], mag0[1], mag0[2])
        new_mag = rot.apply_inverse(turned, mx, my, mz)
    gravity1 = rot.apply_inverse(turned, x[10], x[11], x[12])
    rotation, s.misaligned[0] = attitude.step(
        rot.load(s.rotation), s.misaligned[0], s.gyro, gyro1, mag0, new_mag, gravity0, gravity1, interval, p
    )
    rot.store(rotation, s.rotation)
    for i in range(3):
        s.gyro[i], s.accel[i], s.mag[i] = gyro1[i], accel1[i], new_mag[i]


@kernel
def fault(t0, t1, gyro, accel, mag, range_time, distance):
    """The first thing that is wrong with a sample: stamps out of order, or a number that is not finite."""
    if not t1 > t0:
        return TIME_FAULT
    for i in range(3):
        if not np.isfinite(gyro[i]):
            return GYRO_FAULT
        if not np.isfinite(accel[i]):
            return ACCEL_FAULT
        if np.isinf(mag[i]):
            return MAG_FAULT
    last = t0
    for j in range(len(distance)):
        if not np.isfinite(distance[j]):
            return RANGE_FAULT
        if not last < range_time[j] <= t1:
            return RANGE_TIME_FAULT
        last = range_time[j]
    return NO_FAULT


@kernel
def step(s, t0, t1, gyro1, accel1, mag1, range_time, distance, innovation, p):
    """`advance` with all the ranges of a sample, unless the sample has a fault; returns the fault."""
    found = fault(t0, t1, gyro1, accel1, mag1, range_time, distance)
    if found == NO_FAULT:
        advance(s, t0, t1, gyro1, accel1, mag1, range_time, distance, 0, len(distance), innovation, p)
    return found


@kernel
def read(s, state, covariance):
    """state ← x̂ and covariance ← the position, velocity and gravity blocks of P, all in body axes."""
    x, P, t = s.x, s.P, rot.load(s.turned)
    for i in range(4):
        state[i] = x[i]
    for block in range(3):
        o = 4 + 3 * block
        state[o], state[o + 1], state[o + 2] = rot.apply_inverse(t, x[o], x[o + 1], x[o + 2])
        d = 14 * o
        xx, xy, xz, yy, yz, zz = P[d], P[d + 1], P[d + 2], P[d + 14], P[d + 15], P[d + 28]
        for i in range(3):
            tx, ty, tz = t[i], t[3 + i], t[6 + i]
            cx, cy, cz = xx * tx + xy * ty + xz * tz, xy * tx + yy * ty + yz * tz, xz * tx + yz * ty + zz * tz
            for j in range(i + 1):
                covariance[block, i, j] = t[j] * cx + t[3 + j] * cy + t[6 + j] * cz
                covariance[block, j, i] = covariance[block, i, j]


@kernel
def run(
    s, time, gyro, accel, mag, range_time, distance, states, xi_variance, covariances, rotations, gains, phases,
    innovation, first, p
):  # fmt: skip
    """Run a whole record from its range number `first` on, writing the estimate at every IMU sample."""
    for k in range(len(time)):
        if k > 0:
            last = due(range_time, first, time[k])
            advance(
                s, time[k - 1], time[k], gyro[k], accel[k], mag[k], range_time, distance, first, last, innovation, p
            )
            first = last
        read(s, states[k], covariances[k])
        for i in range(4):
            xi_variance[k, i] = s.P[14 * i]
        rot.store(rot.load(s.rotation), rotations[k])
        gains[k], phases[k] = attitude.gain(s.misaligned[0], p), s.acquisition[PHASE]


@kernel
def k1(s, p):
    """The attitude gain in force."""
    return attitude.gain(s.misaligned[0], p)


@kernel
def due(range_time, first, time):
    """One past the last range, from number `first` on, that is stamped at or before `time`."""
    while first < len(range_time) and range_time[first] <= time:
        first += 1
    return first


@kernel
def run_attitudes(s, time, gyro, accel, mag, range_time, distance, rotations, innovation, first, p):
    """Run a whole record once for x̂, and one attitude filter from each R̂(0) in rotations[:, 0].

    rotations[j, k] ← R̂ of filter j at sample k. All filters share one x̂, because in the cascade x̂ does not depend on R̂.
    """
    misaligned = np.full(len(rotations), s.misaligned[0])
    for k in range(1, len(time)):
        last = due(range_time, first, time[k])
        mag0, gravity0 = (s.mag[0], s.mag[1], s.mag[2]), gravity(s)
        advance(s, time[k - 1], time[k], gyro[k], accel[k], mag[k], range_time, distance, first, last, innovation, p)
        gravity1, h = gravity(s), time[k] - time[k - 1]
        for j in range(len(rotations)):
            r = rot.load(rotations[j, k - 1])
            r, misaligned[j] = attitude.step(
                r, misaligned[j], gyro[k - 1], gyro[k], mag0, s.mag, gravity0, gravity1, h, p
            )
            rot.store(r, rotations[j, k])
        first = last


@kernel
def gravity(s):
    """ĝ_B"""
    return rot.apply_inverse(rot.load(s.turned), s.x[10], s.x[11], s.x[12])
