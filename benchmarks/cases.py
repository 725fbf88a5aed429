"""The records and the starts that benchmarks/estimators.py gives every estimator, and the errors of what it returns."""

from dataclasses import dataclass

import msgspec
import numpy as np

from rangenav import cascade, model, preset, record, so3
from rangenav.cascade import ObserverConfig, Start
from rangenav.gains import Gains

RATE, DURATION = 200.0, 20.0
START_SIGMA_EACH_AXIS = 2.0
"""m and m/s, 1 σ on each axis: position and velocity error of a random start. Its attitude is uniformly random."""
TRUE_START_COVARIANCE = np.eye(9) * 0.1**2
"""m², (m/s)² and rad²: the covariance that a filter is given when it starts at the truth."""
RANDOM_START_COVARIANCE = np.diag(np.repeat(np.square([START_SIGMA_EACH_AXIS, START_SIGMA_EACH_AXIS, 1.8]), 3))
"""The same for a random start; 1.8 rad is the standard deviation of a random attitude's angle on each axis."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """An estimated trajectory at every `every`-th IMU sample, in inertial axes, and the processor time (s) it took."""

    position: np.ndarray
    rotation: np.ndarray
    seconds: float
    every: int = 1


@dataclass(frozen=True, eq=False, kw_only=True)
class Case:
    """One record of one path, and where the estimators start on it."""

    preset: preset.Preset
    truth: record.Truth
    measurements: record.Measurements
    start: Start
    random_start: bool

    def observer_config(self, gains: Gains | None = None) -> ObserverConfig:
        """The configuration that the observers are given."""
        return ObserverConfig(world=self.preset.world, sensors=self.preset.sensors, gains=gains or self.preset.gains)

    def initial_state(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, velocity and rotation at which the filters start: the truth, or the random start."""
        if self.random_start:
            p, v = (self.start.rotation @ self.start.state[block] for block in (model.POSITION, model.VELOCITY))
            return np.asarray(self.preset.world.anchor) + p, v, self.start.rotation
        moved = self.truth.motion
        return moved.position[0], moved.velocity[0], moved.rotation[0]

    def errors(self, result: Result) -> tuple[np.ndarray, np.ndarray]:
        """Position (m, body axes) and attitude (degrees) errors over time."""
        rotation, rows = (
            self.truth.motion.rotation[:: result.every],
            result.position - np.asarray(self.preset.world.anchor),
        )
        body = np.einsum("nij,ni->nj", result.rotation, rows)
        off = np.linalg.norm(body - self.truth.state[:: result.every, model.POSITION], axis=-1)
        return off, np.degrees(so3.angle(rotation @ np.swapaxes(result.rotation, -1, -2)))


def case(name: str, seed: int, *, random_start: bool) -> Case:
    """A record of a shipped path, and a start: the preset's own, or a random one of the same seed."""
    shipped = preset.load(name)
    sensors = msgspec.structs.replace(shipped.sensors, imu_rate=RATE, mag_rate=RATE, range_rate=RATE)
    p = msgspec.structs.replace(shipped, duration=DURATION, sensors=sensors)
    course = record.truth_inputs(p)
    truth, z = record.simulated(course), record.measured(course, sensors, seed)
    start = cascade.start(p.guess, state=truth.state[0], rotation=truth.motion.rotation[0], world=p.world)
    return Case(
        preset=p,
        truth=truth,
        measurements=z,
        start=_random_start(truth, p, seed) if random_start else start,
        random_start=random_start,
    )


def _random_start(truth: record.Truth, p: preset.Preset, seed: int) -> Start:
    rng = np.random.default_rng([seed, 1])
    quaternion = rng.standard_normal(4)
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    rotation = so3.exp(2 * np.arctan2(np.linalg.norm([x, y, z]), w) * np.array([x, y, z]) / np.linalg.norm([x, y, z]))
    position = truth.motion.position[0] - np.asarray(p.world.anchor) + START_SIGMA_EACH_AXIS * rng.standard_normal(3)
    velocity = truth.motion.velocity[0] + START_SIGMA_EACH_AXIS * rng.standard_normal(3)
    body = (rotation.T @ position, rotation.T @ velocity, rotation.T @ np.asarray(p.world.gravity))
    return Start(state=model.lift(*body), rotation=rotation)
