"""The whole cascade, one IMU interval at a time: predict in turned axes, correct with each range, turn the attitude.

A range between two IMU samples splits the interval there. A range at an IMU sample is applied in full, or, in the
symmetric (Strang) scheme, half before the estimate is read and half after, which makes x̂ and P second order in h. Both
halves have the same row and innovation, so that one correction in full makes both, at the start of the next interval:
between the samples the state stands before it, and `read` shows what half of it makes.
All that changes is one packed array `s`, in the places that `layout` names.
"""

import numpy as np

from rangenav.kernels import acquisition, attitude, riccati
from rangenav.kernels import rotation as rot
from rangenav.kernels.jit import inlined, kernel
from rangenav.kernels.layout import (
    ACCEL_AT,
    ACQUISITION_AT,
    COLLECTS,
    GRAVITY_AT,
    GYRO_AT,
    LENGTH,
    MAG_AT,
    MATCHED,
    MATCHED_V,
    MISALIGNED_AT,
    P_AT,
    PENDING_AT,
    PHASE,
    ROTATION_AT,
    TIME_AT,
    TURNED_AT,
    X_AT,
)
from rangenav.kernels.vectors import shared


@inlined
def three(flat, at):
    """The vector that stands in a flat array from `at` on."""
    return flat[at], flat[at + 1], flat[at + 2]


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
    h = (end - begin) * interval
    increment, ax, ay, az = moved(turned, gyro0, gyro1, accel0, accel1, begin, end, interval)
    matched = a[PHASE] == MATCHED
    _add_noise(x, P, h / 2, matched, p)
    riccati.predict_state(x, ax, ay, az, h, p.b4)
    riccati.predict_covariance(P, ax, ay, az, h)
    _add_noise(x, P, h / 2, matched, p)
    if a[COLLECTS] > 0:
        acquisition.propagate(a, ax, ay, az, h, p.b4)
    return rot.multiply(turned, increment)


@inlined
def moved(turned, gyro0, gyro1, accel0, accel1, begin, end, interval):
    """The increment of the turn from begin to end, and the acceleration in turned axes."""
    h, middle = (end - begin) * interval, (begin + end) / 2
    wx, wy, wz = _between(gyro0, gyro1, middle)
    increment = rot.exp(h * wx, h * wy, h * wz)
    ax0, ay0, az0 = _between(accel0, accel1, begin)
    ax1, ay1, az1 = _between(accel0, accel1, end)
    bx, by, bz = rot.apply(increment, ax1, ay1, az1)
    ax, ay, az = rot.apply(turned, (ax0 + bx) / 2, (ay0 + by) / 2, (az0 + bz) / 2)
    return increment, ax, ay, az


@inlined
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
def begin(s, distance, packed):
    """Keep the correction by a range at the very first IMU sample: it is applied when the first interval starts."""
    p, x, P, a = attitude.unpacked(packed), s[X_AT:P_AT], s[P_AT:TURNED_AT], s[ACQUISITION_AT:LENGTH]
    y, matched = measured_y(distance, p), a[PHASE] == MATCHED
    variance = range_variance(x, matched, p)
    if a[COLLECTS] > 0:
        acquisition.collect(a, y, p)
    if not (matched and acquisition.outlier(a, y - x[0], P[0] + variance)):
        s[PENDING_AT], s[PENDING_AT + 1] = y, variance * (2 if p.symmetric else 1)


@kernel
def advance(s, t1, gyro1, accel1, mag1, range_time, distance, first, last, innovation, p):
    """Move the state to the IMU sample at t1, applying ranges first ≤ j < last, all stamped after the last sample.

    gyro1, accel1, mag1: tuples. innovation[j] ← (y − ŷ, its variance) for each range.
    """
    x, P, a = s[X_AT:P_AT], s[P_AT:TURNED_AT], s[ACQUISITION_AT:LENGTH]
    t0, reached = s[TIME_AT], 0.0
    interval = t1 - t0
    collects, matched = a[COLLECTS] > 0, a[PHASE] == MATCHED
    gyro0, accel0, old = three(s, GYRO_AT), three(s, ACCEL_AT), rot.load_at(s, TURNED_AT)
    if s[PENDING_AT + 1] > 0:
        riccati.correct(x, P, s[PENDING_AT], s[PENDING_AT + 1])
    s[PENDING_AT + 1] = s[PENDING_AT + 2] = 0.0
    turned = old
    for j in range(first, last + 1):  # up to each range, then up to the end: one call compiles in half the time of two
        at_end = j == last or range_time[j] == t1
        fraction = 1.0 if at_end else (range_time[j] - t0) / interval
        if fraction > reached:
            turned = propagate(x, P, a, turned, gyro0, gyro1, accel0, accel1, reached, fraction, interval, p)
            reached = fraction
        if j == last:
            break
        y, variance = measured_y(distance[j], p), range_variance(x, matched, p)
        if collects:
            acquisition.collect(a, y, p)
        innovation[j, 0], innovation[j, 1] = y - x[0], P[0] + variance
        if matched and acquisition.outlier(a, y - x[0], P[0] + variance):
            continue
        if p.symmetric and at_end:
            s[PENDING_AT], s[PENDING_AT + 1], s[PENDING_AT + 2] = y, variance, 2 * variance
        else:
            riccati.correct(x, P, y, variance)
    if matched:
        riccati.remind(x, P, interval)
        acquisition.watch(a, P, p)
    if collects:
        acquisition.start(a, x, P, p)
    turn_attitude(s, x, P, old, rot.orthonormal(turned), gyro1, accel1, mag1, interval, p)
    s[TIME_AT] = t1


@inlined
def turn_attitude(s, x, P, old, turned, gyro1, accel1, mag1, interval, p):
    """R̂ at the end of an interval, from the ĝ that the estimate shows there, and what the next interval starts from.

    old and turned: the turn at both ends, tuples of nine. Without a new sample of the magnetometer the gyro carries the
    last one along.
    """
    gyro0, mag0, gravity0, new_mag = three(s, GYRO_AT), three(s, MAG_AT), three(s, GRAVITY_AT), mag1
    if np.isnan(shared(mag1[0]) + shared(mag1[1]) + shared(mag1[2])):
        mx, my, mz = rot.apply(old, mag0[0], mag0[1], mag0[2])
        new_mag = rot.apply_inverse(turned, mx, my, mz)
    step, _, _ = riccati.shown(x, P, s[PENDING_AT], s[PENDING_AT + 2])
    gravity1 = rot.apply_inverse(turned, x[10] + P[10] * step, x[11] + P[11] * step, x[12] + P[12] * step)
    rotation, s[MISALIGNED_AT] = attitude.step(
        rot.load_at(s, ROTATION_AT), s[MISALIGNED_AT], gyro0, gyro1, mag0, new_mag, gravity0, gravity1, interval, p
    )
    rot.store_at(turned, s, TURNED_AT)
    rot.store_at(rotation, s, ROTATION_AT)
    for i in range(3):
        s[GYRO_AT + i], s[ACCEL_AT + i], s[MAG_AT + i], s[GRAVITY_AT + i] = gyro1[i], accel1[i], new_mag[i], gravity1[i]


@kernel
def read(s, k, states, xi_variance, covariances):
    """Row k of each: x̂, the first four of P's diagonal, its position, velocity and gravity blocks, in body axes."""
    x, P, t = s[X_AT:P_AT], s[P_AT:TURNED_AT], rot.load_at(s, TURNED_AT)
    step, root, kept = riccati.shown(x, P, s[PENDING_AT], s[PENDING_AT + 2])
    for i in range(4):
        states[k, i] = x[i] + P[i] * step
        u = P[i] * root
        xi_variance[k, i] = P[14 * i] - u * u
    xi_variance[k, 0] = P[0] * kept
    for block in range(3):
        o = 4 + 3 * block
        ux, uy, uz = P[o] * root, P[o + 1] * root, P[o + 2] * root
        states[k, o], states[k, o + 1], states[k, o + 2] = rot.apply_inverse(
            t, x[o] + P[o] * step, x[o + 1] + P[o + 1] * step, x[o + 2] + P[o + 2] * step
        )
        cov = riccati.turned_block(t, P, o, (ux, uy, uz))
        covariances[k, block, 0, 0], covariances[k, block, 1, 1], covariances[k, block, 2, 2] = cov[0], cov[2], cov[5]
        covariances[k, block, 1, 0] = covariances[k, block, 0, 1] = cov[1]
        covariances[k, block, 2, 0] = covariances[k, block, 0, 2] = cov[3]
        covariances[k, block, 2, 1] = covariances[k, block, 1, 2] = cov[4]


@kernel
def run(
    s, time, gyro, accel, mag, range_time, distance, states, xi_variance, covariances, rotations, gains, phases,
    mags, innovation, first, packed
):  # fmt: skip
    """Run a whole record from its range number `first` on, writing the estimate at every IMU sample."""
    p = attitude.unpacked(packed)
    for k in range(len(time)):
        if k > 0:
            last = due(range_time, first, time[k])
            advance(
                s,
                time[k],
                rot.row(gyro, k),
                rot.row(accel, k),
                rot.row(mag, k),
                range_time,
                distance,
                first,
                last,
                innovation,
                p,
            )
            first = last
        read(s, k, states, xi_variance, covariances)
        for i in range(3):
            mags[k, i] = s[MAG_AT + i]
            for j in range(3):
                rotations[k, i, j] = s[ROTATION_AT + 3 * i + j]
        gains[k], phases[k] = attitude.gain(s[MISALIGNED_AT], p), s[ACQUISITION_AT + PHASE]


@kernel
def k1(s, packed):
    """The attitude gain in force."""
    return attitude.gain(s[MISALIGNED_AT], attitude.unpacked(packed))


@kernel
def due(range_time, first, time):
    """One past the last range, from number `first` on, that is stamped at or before `time`."""
    while first < len(range_time) and range_time[first] <= time:
        first += 1
    return first
