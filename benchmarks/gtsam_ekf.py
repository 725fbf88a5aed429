"""A peer: GTSAM's NavStateImuEKF (C++) driven from Python over the same record: rotation, position, velocity, 9 × 9.

Its Python interface has `predict(gyro, accel, dt)` and `updateWithVector(prediction, H, z, R)`. There is no range
update to call, so the range and its Jacobian are computed here, as a user of the wheel has to; NavState's tangent is
(rotation, position, velocity), all in body axes: p ← p + R dp. Gravity is known to it; our observer estimates it.
"""

import gtsam
import numpy as np

from rangenav.preset import Preset
from rangenav.sensors import Measurements

USES = ("imu", "imu, range", "imu, range, mag")
"""What is filtered: predictions alone, with every range, with every magnetometer sample too (what our cascade uses)."""
INTEGRATION_VARIANCE = 1e-8
START_SIGMA = (0.1, 0.1, 0.1)
"""rad, m, m/s: it starts at the truth, because from x̂ = 0 it need not converge."""


def start(rotation: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> gtsam.NavState:
    """A start for `run`."""
    return gtsam.NavState(gtsam.Rot3(rotation), position, velocity)


def run(preset: Preset, record: Measurements, first: gtsam.NavState, *, use: str) -> np.ndarray:
    """The last position (m, inertial) after filtering the record with one of `USES`; ranges at the IMU's stamps."""
    world, noise = preset.world, preset.sensors.sigma
    ekf = gtsam.NavStateImuEKF(first, np.diag(np.repeat(np.square(START_SIGMA), 3)), _noise(preset))
    anchor, magnetic = np.asarray(world.anchor), np.asarray(world.magnetic)
    range_noise, mag_noise = np.array([[noise.range**2]]), np.eye(3) * noise.mag**2
    steps = np.diff(record.time)
    for k in range(1, len(record.time)):
        ekf.predict(record.gyro[k - 1], record.accel[k - 1], steps[k - 1])
        if use != USES[0]:
            expected, H = _range(ekf.state(), anchor)
            ekf.updateWithVector(expected, H, record.range[k : k + 1], range_noise)
        if use == USES[2]:
            expected, H = _mag(ekf.state(), magnetic)
            ekf.updateWithVector(expected, H, record.mag[k], mag_noise)
    return ekf.state().position()


def _noise(preset: Preset) -> gtsam.PreintegrationParams:
    noise, h = preset.sensors.sigma, 1 / preset.sensors.imu_rate
    params = gtsam.PreintegrationParams(np.asarray(preset.world.gravity))
    params.setAccelerometerCovariance(np.eye(3) * noise.accel**2 * h)
    params.setGyroscopeCovariance(np.eye(3) * noise.gyro**2 * h)
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
