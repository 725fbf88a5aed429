"""GTSAM's NavStateImuEKF (C++), called from Python on the same record: rotation, position, velocity, covariance 9 × 9.

Its Python interface has `predict(gyro, accel, dt)` and `updateWithVector(prediction, H, z, R)`, but no range update.
The range and its Jacobian are therefore computed here, as every user of the wheel has to do. NavState's tangent is
(rotation, position, velocity) in body axes: p ← p + R dp. The filter knows gravity; the cascade estimates it.
"""

from collections.abc import Iterator

import gtsam
import numpy as np

from rangenav.preset import Preset
from rangenav.sensors import Measurements

USES = ("imu", "imu, range", "imu, range, mag")
"""The measurements that are used: none, every range, or every range and magnetometer sample, as the cascade uses."""
INTEGRATION_VARIANCE = 1e-8
START_SIGMA = (0.1, 0.1, 0.1)
"""rad, m, m/s, 1 σ: the filter starts at the truth, because it need not converge from x̂ = 0."""


def start(rotation: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> gtsam.NavState:
    """A start for `run`."""
    return gtsam.NavState(gtsam.Rot3(rotation), position, velocity)


def run(preset: Preset, record: Measurements, first: gtsam.NavState, *, use: str) -> np.ndarray:
    """The last position (m, inertial) after filtering the record with one of `USES`; ranges at the IMU's stamps."""
    *_, ekf = steps(preset, record, first, use=use)
    return ekf.state().position()


def steps(
    preset: Preset, record: Measurements, first: gtsam.NavState, *, use: str, sigma: tuple = START_SIGMA
) -> Iterator[gtsam.NavStateImuEKF]:
    """The filter (one object, read it before the next step) after each IMU sample but the first."""
    world, noises = preset.world, preset.sensors.sigma
    ekf = gtsam.NavStateImuEKF(first, np.diag(np.repeat(np.square(sigma), 3)), noise(preset))
    anchor, magnetic = np.asarray(world.anchor), np.asarray(world.magnetic)
    range_noise, mag_noise = np.array([[noises.range**2]]), np.eye(3) * noises.mag**2
    accel, gyro = means(record)
    intervals = np.diff(record.time)
    for k in range(1, len(record.time)):
        ekf.predict(gyro[k - 1], accel[k - 1], intervals[k - 1])
        if use != USES[0]:
            expected, H = _range(ekf.state(), anchor)
            ekf.updateWithVector(expected, H, record.range[k : k + 1], range_noise)
        if use == USES[2]:
            expected, H = _mag(ekf.state(), magnetic)
            ekf.updateWithVector(expected, H, record.mag[k], mag_noise)
        yield ekf


def means(record: Measurements) -> tuple[np.ndarray, np.ndarray]:
    """Accel and gyro over each interval as means of both ends; with the first end alone they lag by half a sample."""
    return (record.accel[:-1] + record.accel[1:]) / 2, (record.gyro[:-1] + record.gyro[1:]) / 2


def noise(preset: Preset) -> gtsam.PreintegrationParams:
    """The IMU's noise as GTSAM asks for it: densities."""
    sigma, h = preset.sensors.sigma, 1 / preset.sensors.imu_rate
    params = gtsam.PreintegrationParams(np.asarray(preset.world.gravity))
    params.setAccelerometerCovariance(np.eye(3) * sigma.accel**2 * h)
    params.setGyroscopeCovariance(np.eye(3) * sigma.gyro**2 * h)
    params.setIntegrationCovariance(np.eye(3) * INTEGRATION_VARIANCE)
    return params


def _range(state: gtsam.NavState, anchor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """|p − p_anchor| and its row: uᵀR on the position block."""
    away = state.position() - anchor
    distance = np.sqrt(away @ away)
    H = np.zeros((1, 9))
    H[0, 3:6] = (away / distance) @ state.attitude().matrix()
    return np.array([distance]), H


def _mag(state: gtsam.NavState, magnetic: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rᵀm and its rows: [Rᵀm]x on the rotation block."""
    x, y, z = expected = state.attitude().matrix().T @ magnetic
    H = np.zeros((3, 9))
    H[0, 1], H[0, 2], H[1, 0], H[1, 2], H[2, 0], H[2, 1] = -z, y, z, -x, -y, x
    return expected, H


def run_invariant(preset: Preset, record: Measurements, first: gtsam.NavState) -> np.ndarray:
    """The last position of InvariantEKFNavState with every sensor; it has no IMU, so the increment is computed here.

    X⁺ = X U(X), U = (exp(ω h), Rᵀ(v h + ½g h²) + ½a h², Rᵀg h + a h), with the Jacobian of U, which depends on X since
    p grows by v h and gravity is known in inertial axes.
    """
    world, noises = preset.world, preset.sensors.sigma
    ekf = gtsam.InvariantEKFNavState(first, np.diag(np.repeat(np.square(START_SIGMA), 3)))
    anchor, magnetic, gravity = (np.asarray(vector) for vector in (world.anchor, world.magnetic, world.gravity))
    range_noise, mag_noise = np.array([[noises.range**2]]), np.eye(3) * noises.mag**2
    accel, gyro = means(record)
    intervals, J, Q = np.diff(record.time), np.zeros((9, 9)), np.zeros((9, 9))
    for k in range(1, len(record.time)):
        h, state, a = intervals[k - 1], ekf.state(), accel[k - 1]
        R = state.attitude().matrix()
        fall, moved = R.T @ gravity * h, R.T @ state.velocity() * h
        turn = gtsam.Rot3.Expmap(gyro[k - 1] * h)
        back = turn.matrix().T
        J[3:6, :3], J[3:6, 6:] = back @ _cross(moved + fall * h / 2), back * h
        J[6:, :3] = back @ _cross(fall)
        density = h / preset.sensors.imu_rate
        Q[range(9), range(9)] = np.repeat(
            [noises.gyro**2 * density, INTEGRATION_VARIANCE * h, noises.accel**2 * density], 3
        )
        U = gtsam.NavState(turn, moved + (fall + a * h) * h / 2, fall + a * h)
        ekf.predictWithCompose(U, J, Q)
        expected, H = _range(ekf.state(), anchor)
        ekf.updateWithVector(expected, H, record.range[k : k + 1], range_noise)
        expected, H = _mag(ekf.state(), magnetic)
        ekf.updateWithVector(expected, H, record.mag[k], mag_noise)
    return ekf.state().position()


def _cross(v: np.ndarray) -> np.ndarray:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
