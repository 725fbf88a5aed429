"""The baseline of the field: an extended Kalman filter on nine states and the nonlinear range.

    predict x̂⁺ = f(x̂), P⁺ = Φ P Φᵀ + Q;   correct with ν = d − |p̂ − p_anchor| and R̂ m_y − m, both linearised at x̂⁺

It has the same measurements, the same noise and the same initial covariance as the noise-matched cascade. Near the
truth it is the better estimator, because it spends no state on the lift. Far from the truth nothing is proven of it: it
may converge to another minimum with a small covariance, or diverge, and it reports neither. At the anchor the range has
no gradient; a range there corrects nothing.
"""

from types import ModuleType

import numpy as np

from rangenav import strapdown
from rangenav.arguments import array
from rangenav.cascade import ObserverConfig, Start, checked_start
from rangenav.model import POSITION, VELOCITY
from rangenav.sensors import Measurements
from rangenav.strapdown import STATES, Track


def ekf(measurements: Measurements, start: Start, setting: ObserverConfig) -> Track:
    """Filter a record. Of the start, position, velocity and R̂ are used; gravity is known here.

    P(0) is diagonal: the Riccati gains' p0 for position and velocity, and (σ_gravity/|g|)² rad² for the attitude, the
    tilt that such an error of gravity stands for. Where the filter diverges the result is not finite.
    Raises ValueError for arrays of the wrong shape or type, stamps out of order, or numbers that are not finite.
    """
    start = checked_start(start)
    p0 = setting.gains.riccati.p0
    tilt = p0.gravity / float(np.sum(np.square(setting.world.gravity)))
    covariance = np.diag(np.repeat([p0.position, p0.velocity, tilt], 3))
    position = np.asarray(setting.world.anchor) + start.rotation @ start.state[POSITION]
    velocity = start.rotation @ start.state[VELOCITY]
    return filtered(measurements, (position, velocity, start.rotation), covariance, setting)


def filtered(
    measurements: Measurements,
    start: tuple[np.ndarray, np.ndarray, np.ndarray],
    covariance: np.ndarray,
    setting: ObserverConfig,
) -> Track:
    """The same from a position (m), velocity (m/s) and rotation in inertial axes, and the covariance of their errors.

    The covariance is 9 × 9, in the order position, velocity, attitude (rad).
    Raises ValueError as `ekf` does, but for a start that is not finite: from there the filter diverges.
    """
    z = strapdown.check(measurements)
    count, anchor = len(z.time), np.asarray(setting.world.anchor, dtype=float)
    position, velocity, rotation = start
    attached = strapdown.attach(z)
    track = Track(
        time=z.time,
        position=np.empty((count, 3)),
        velocity=np.empty((count, 3)),
        rotation=np.empty((count, 3, 3)),
        covariance=np.empty((count, STATES, STATES)),
        innovation=np.full((len(z.range), 2), np.nan),
    )
    track.position[0] = array("start position", position, (3,)) - anchor
    track.velocity[0] = array("start velocity", velocity, (3,))
    track.rotation[0] = array("start rotation", rotation, (3, 3))
    track.covariance[0] = array("covariance", covariance, (STATES, STATES))
    _kernel().run(
        z.time, z.gyro, z.accel, z.mag, z.range[attached.kept], attached.sample, attached.back, track.position,
        track.velocity, track.rotation, track.covariance.reshape(count, -1), track.innovation[attached.kept],
        strapdown.parameters(setting),
    )  # fmt: skip
    track.position[:] += anchor
    return track


def _kernel() -> ModuleType:
    """The compiled kernel, imported where it is used: numba alone takes as long to import as everything else."""
    from rangenav.kernels import ekf as kernel

    return kernel
