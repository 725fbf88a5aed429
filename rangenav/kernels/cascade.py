"""The whole cascade, one IMU interval at a time: predict in turned axes, correct with each range, turn the attitude.

A range between two IMU samples splits the interval there. A range at an IMU sample is applied in full, or, in the
symmetric (Strang) scheme, half before the estimate is read and half after, which makes x̂ and P second order in h.
"""

import numpy as np

from rangenav.kernels import attitude, riccati
from rangenav.kernels import rotation as rot
from rangenav.kernels.compiled import kernel


@kernel
def to_body(turned, vector, out):
    """out ← turnedᵀ vector."""
    for i in range(3):
        out[i] = turned[0, i] * vector[0] + turned[1, i] * vector[1] + turned[2, i] * vector[2]


@kernel
def range_variance(x, p):
    """Variance (m⁴) of one y: constant, or d̂²σ² + ½σ⁴ with the predicted d̂² (the measured one would bias the gain)."""
    if not p.matched:
        return p.variance
    square, s2 = max(2 * x[0], 0.0), p.range_sigma * p.range_sigma
    return square * s2 + s2 * s2 / 2


@kernel
def measured_y(distance, p):
    """y = ½d², less the bias ½σ² that noise adds to a square (noise-matched only)."""
    bias = p.range_sigma * p.range_sigma if p.matched else 0.0
    return (distance * distance - bias) / 2


@kernel
def propagate(s, gyro1, accel1, begin, end, interval, p):
    """Predict from begin to end (fractions of the interval): the mean of a at both ends, in the axes of the start."""
    h, middle = (end - begin) * interval, (begin + end) / 2
    increment, a = np.empty((3, 3)), np.empty(3)
    wx = s.gyro[0] + middle * (gyro1[0] - s.gyro[0])
    wy = s.gyro[1] + middle * (gyro1[1] - s.gyro[1])
    wz = s.gyro[2] + middle * (gyro1[2] - s.gyro[2])
    rot.exp(h * wx, h * wy, h * wz, increment)
    ax0, ay0, az0 = _between(s.accel, accel1, begin)
    ax1, ay1, az1 = _between(s.accel, accel1, end)
    bx = (ax0 + increment[0, 0] * ax1 + increment[0, 1] * ay1 + increment[0, 2] * az1) / 2
    by = (ay0 + increment[1, 0] * ax1 + increment[1, 1] * ay1 + increment[1, 2] * az1) / 2
    bz = (az0 + increment[2, 0] * ax1 + increment[2, 1] * ay1 + increment[2, 2] * az1) / 2
    for i in range(3):
        a[i] = s.turned[i, 0] * bx + s.turned[i, 1] * by + s.turned[i, 2] * bz
    _add_noise(s, h / 2, p)
    riccati.predict_state(s.x, a, h, p.b4)
    riccati.predict_covariance(s.P, a, h)
    _add_noise(s, h / 2, p)
    rot.turn(s.turned, increment)


@kernel
def _between(start, end, fraction):
    return (
        start[0] + fraction * (end[0] - start[0]),
        start[1] + fraction * (end[1] - start[1]),
        start[2] + fraction * (end[2] - start[2]),
    )


@kernel
def _add_noise(s, h, p):
    riccati.add_block_noise(s.P, p.v, h)
    if p.matched:
        riccati.add_imu_noise(s.P, s.x, p.accel_density, p.gyro_density, h)


@kernel
def correct(s, y, at_sample, p):
    """Apply one range; at an IMU sample of the symmetric scheme half of it now and the other half pending."""
    variance = range_variance(s.x, p)
    if p.symmetric and at_sample:
        s.pending[0], s.pending[1] = y, 2 * variance
        return riccati.correct(s.x, s.P, y, 2 * variance)
    return riccati.correct(s.x, s.P, y, variance)


@kernel
def begin(s, distance, p):
    """Note a range that came with the very first IMU sample: it is due when the first interval starts."""
    s.pending[0] = measured_y(distance, p)
    s.pending[1] = range_variance(s.x, p) * (2 if p.symmetric else 1)


@kernel
def advance(s, t0, t1, gyro1, accel1, mag1, range_time, distance, first, last, innovation, p):
    """Move the state from IMU sample t0 to t1, applying ranges first ≤ j < last, all stamped in (t0, t1].

    innovation[j] ← (y − ŷ, its variance) for each of them.
    """
    gravity0, gravity1, mag, mag_end = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    to_body(s.turned, s.x[10:13], gravity0)
    if not np.isnan(s.pending[0]):
        riccati.correct(s.x, s.P, s.pending[0], s.pending[1])
        s.pending[0] = np.nan
    interval, reached = t1 - t0, 0.0
    for i in range(3):
        mag[i] = s.turned[i, 0] * s.mag[0] + s.turned[i, 1] * s.mag[1] + s.turned[i, 2] * s.mag[2]
    for j in range(first, last):
        at_sample = range_time[j] == t1
        fraction = 1.0 if at_sample else (range_time[j] - t0) / interval
        if fraction > reached:
            propagate(s, gyro1, accel1, reached, fraction, interval, p)
            reached = fraction
        innovation[j, 0], innovation[j, 1] = correct(s, measured_y(distance[j], p), at_sample, p)
    if reached < 1.0:
        propagate(s, gyro1, accel1, reached, 1.0, interval, p)
    rot.orthonormalise(s.turned)
    if np.isnan(mag1[0]):  # no new sample: the last one, carried along by the gyro
        to_body(s.turned, mag, mag_end)
    else:
        mag_end[:] = mag1
    to_body(s.turned, s.x[10:13], gravity1)
    attitude.step(s.rotation, s.gyro, gyro1, s.mag, mag_end, gravity0, gravity1, interval, p)
    s.gyro[:], s.accel[:], s.mag[:] = gyro1, accel1, mag_end


@kernel
def read(s, state, covariance):
    """state ← x̂ in body axes; covariance ← the four symmetric blocks of P in body axes: ξ's diagonal, then 3 × 3 each."""
    turned, x, P = s.turned, s.x, s.P
    for i in range(4):
        state[i] = x[i]
    for block in range(3):
        o = 4 + 3 * block
        for i in range(3):
            state[o + i] = turned[0, i] * x[o] + turned[1, i] * x[o + 1] + turned[2, i] * x[o + 2]
            for j in range(i, 3):
                total = 0.0
                for k in range(3):
                    row = P[o + k, o] * turned[0, j] + P[o + k, o + 1] * turned[1, j] + P[o + k, o + 2] * turned[2, j]
                    total += turned[k, i] * row
                covariance[block, i, j] = total
                covariance[block, j, i] = total


@kernel
def run(s, time, gyro, accel, mag, range_time, distance, states, xi_variance, covariances, rotations, innovation, first, p):
    """Run a whole record from its range number `first` on, writing the estimate at every IMU sample."""
    count = len(range_time)
    for k in range(len(time)):
        if k > 0:
            last = first
            while last < count and range_time[last] <= time[k]:
                last += 1
            advance(
                s, time[k - 1], time[k], gyro[k], accel[k], mag[k], range_time, distance, first, last, innovation, p
            )
            first = last
        read(s, states[k], covariances[k])
        for i in range(4):
            xi_variance[k, i] = s.P[i, i]
        rotations[k] = s.rotation
