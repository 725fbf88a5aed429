"""GTSAM's factor graph over a whole record, built from Python and optimised by Levenberg–Marquardt (C++).

There is a key (pose, velocity) at every `every`-th IMU sample and a preintegrated IMU factor between neighbouring keys.
Each key has a factor for the range to the anchor and one for the magnetometer's sample. Ranges and magnetometer samples
between keys are not used: keys at 200 Hz use all of them, keys at 50 Hz use a quarter. As in `rangenav.refine`, gravity
is known and the IMU has no bias.
"""

from typing import NamedTuple

import gtsam
import gtsam_ekf
import numpy as np
from gtsam.symbol_shorthand import B, L, V, X

from rangenav.preset import Preset
from rangenav.sensors import Measurements

PRIOR_SIGMA = np.array([1.0, 1.0, 1.0, 10.0, 10.0, 10.0])
"""rad and m: σ of the first pose about the start; as wide as the prior of `rangenav.refine`."""
PRIOR_SPEED = 10.0
FIXED = 1e-6
"""σ of the quantities that are known: the anchor and the bias."""
MAX_ITERATIONS = 100


class Trajectory(NamedTuple):
    """Inertial axes, one row for each sample."""

    position: np.ndarray
    velocity: np.ndarray
    rotation: np.ndarray


def solve(preset: Preset, record: Measurements, start: Trajectory, *, every: int) -> tuple[Trajectory, int]:
    """The optimised trajectory at the keys, and the iterations it took; ranges at the IMU's stamps."""
    keys = range(0, len(record.time), every)
    optimizer = gtsam.LevenbergMarquardtOptimizer(
        _graph(preset, record, start, every, keys), _values(preset, start, keys), _parameters()
    )
    result = optimizer.optimize()
    poses = [result.atPose3(X(k)) for k in keys]
    result = Trajectory(
        np.array([pose.translation() for pose in poses]),
        np.array([result.atVector(V(k)) for k in keys]),
        np.array([pose.rotation().matrix() for pose in poses]),
    )
    return result, optimizer.iterations()


def _graph(
    preset: Preset, record: Measurements, start: Trajectory, every: int, keys: range
) -> gtsam.NonlinearFactorGraph:
    noise, world, graph = preset.sensors.sigma, preset.world, gtsam.NonlinearFactorGraph()
    ranges, mags = gtsam.noiseModel.Isotropic.Sigma(1, noise.range), gtsam.noiseModel.Isotropic.Sigma(3, noise.mag)
    params, magnetic, anchor = gtsam_ekf.noise(preset), np.asarray(world.magnetic), np.asarray(world.anchor)
    graph.add(gtsam.PriorFactorPoint3(L(0), anchor, gtsam.noiseModel.Isotropic.Sigma(3, FIXED)))
    none = gtsam.imuBias.ConstantBias()
    graph.add(gtsam.PriorFactorConstantBias(B(0), none, gtsam.noiseModel.Isotropic.Sigma(6, FIXED)))
    graph.add(gtsam.PriorFactorPose3(X(0), _pose(start, 0), gtsam.noiseModel.Diagonal.Sigmas(PRIOR_SIGMA)))
    speed = gtsam.noiseModel.Isotropic.Sigma(3, PRIOR_SPEED)
    graph.add(gtsam.PriorFactorVector(V(0), start.velocity[0], speed))
    (accel, gyro), intervals = _means(record), np.diff(record.time)
    for k in keys:
        graph.add(gtsam.RangeFactor3D(X(k), L(0), float(record.range[k]), ranges))
        graph.add(gtsam.MagPoseFactorPose3(X(k), record.mag[k], 1.0, magnetic, np.zeros(3), mags))
        if k > 0:
            between = gtsam.PreintegratedImuMeasurements(params)
            for i in range(k - every, k):
                between.integrateMeasurement(accel[i], gyro[i], intervals[i])
            graph.add(gtsam.ImuFactor(X(k - every), V(k - every), X(k), V(k), B(0), between))
    return graph


def _means(record: Measurements) -> tuple[np.ndarray, np.ndarray]:
    """The means of `gtsam_ekf.means`, but the accel in the body axes at the start of its interval, as preintegration
    expects it.

    Without this rotation the attitude would be tilted by 0.07°. With it, the minimum of GTSAM's graph and that of
    `rangenav.refine` agree within 1e-4° and 0.3 mm.
    """
    _, gyro = gtsam_ekf.means(record)
    later = record.accel[1:]
    turned = later + np.diff(record.time)[:, None] * np.cross(gyro, later)
    return (record.accel[:-1] + turned) / 2, gyro


def _values(preset: Preset, start: Trajectory, keys: range) -> gtsam.Values:
    values = gtsam.Values()
    values.insert(L(0), np.asarray(preset.world.anchor, dtype=float))
    values.insert(B(0), gtsam.imuBias.ConstantBias())
    for k in keys:
        values.insert(X(k), _pose(start, k))
        values.insert(V(k), start.velocity[k])
    return values


def _pose(start: Trajectory, k: int) -> gtsam.Pose3:
    return gtsam.Pose3(gtsam.Rot3(start.rotation[k]), start.position[k])


def _parameters() -> gtsam.LevenbergMarquardtParams:
    parameters = gtsam.LevenbergMarquardtParams()
    parameters.setMaxIterations(MAX_ITERATIONS)
    return parameters
