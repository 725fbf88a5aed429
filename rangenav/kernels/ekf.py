"""The nine-state extended Kalman filter over a whole record: predict, linearise there, correct with all that came."""

import numpy as np

from rangenav.kernels import rotation as rot
from rangenav.kernels import strapdown
from rangenav.kernels.jit import kernel

N = strapdown.N


@kernel
def inject(x, position, velocity, r):
    """Move the error x into the estimate."""
    turned = rot.orthonormal(rot.multiply(rot.exp(x[6], x[7], x[8]), r))
    return (
        (position[0] + x[0], position[1] + x[1], position[2] + x[2]),
        (velocity[0] + x[3], velocity[1] + x[4], velocity[2] + x[5]),
        turned,
    )


@kernel
def run(time, gyro, accel, mag, distance, attached, back, positions, velocities, rotations, covariances, innovation, p):
    """Filter a record; range j is applied at IMU sample attached[j], which it precedes by back[j] seconds.

    It starts from what stands in the first rows of positions, velocities, rotations and covariances (flat, 81).
    """
    position = (positions[0, 0], positions[0, 1], positions[0, 2])
    velocity = (velocities[0, 0], velocities[0, 1], velocities[0, 2])
    r, P = rot.load(rotations[0]), covariances[0].copy()
    x, row, gain = np.empty(N), np.zeros(N), np.empty(N)
    a, j, count = (0.0, 0.0, 0.0), 0, len(distance)
    for k in range(len(time)):
        if k > 0:
            h = time[k] - time[k - 1]
            position, velocity, r, a = strapdown.move(
                position, velocity, r, gyro[k - 1], gyro[k], accel[k - 1], accel[k], h, p
            )
            strapdown.predict_covariance(P, a, h, p)
        x[:] = 0.0
        while j < count and attached[j] == k:
            residual = distance[j] - strapdown.range_row(position, velocity, a, back[j], p, row)
            innovation[j] = strapdown.correct(x, P, row, residual, p.range_variance, gain)
            j += 1
        if not np.isnan(mag[k, 0] + mag[k, 1] + mag[k, 2]):
            first, second = strapdown.mag_residuals(r, mag[k], p)
            strapdown.mag_row(p.across2, -1.0, row)
            strapdown.correct(x, P, row, first, p.mag_variance, gain)
            strapdown.mag_row(p.across1, 1.0, row)
            strapdown.correct(x, P, row, second, p.mag_variance, gain)
        position, velocity, r = inject(x, position, velocity, r)
        for i in range(3):
            positions[k, i], velocities[k, i] = position[i], velocity[i]
        rot.store(r, rotations[k])
        covariances[k] = P
