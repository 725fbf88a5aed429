"""The baseline every navigator knows: an extended Kalman filter on nine states and the nonlinear range.

    predict x̂⁺ = f(x̂), P⁺ = Φ P Φᵀ + Q;   correct with ν = d − |p̂ − p_anchor| and R̂ m_y − m, both linearised at x̂⁺
Same measurements, same noise and the same initial covariance as the noise-matched cascade. Near the truth it is the
better estimator: no state is spent on the lift. But it has no claim beyond: started cold it may go into another
minimum with a small covariance, or to infinity, and it says neither. At the anchor itself a range has no gradient;
there a range is left out, where other filters return NaN.
"""

from types import ModuleType

import numpy as np

from rangenav import strapdown
from rangenav.cascade import ObserverConfig, Start
from rangenav.model import POSITION, VELOCITY
from rangenav.sensors import Measurements
from rangenav.strapdown import STATES, Track


def ekf(measurements: Measurements, start: Start, setting: ObserverConfig) -> Track:
    """Filter a record. Of the start, position, velocity and R̂ are used; gravity is known here.

    P(0) is diagonal: the Riccati gains' p0 of position and velocity, and for the attitude (σ_gravity/|g|)² rad², as far
    as such a gravity error would tilt. What is not finite in the result is what the filter came to.
    """
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
    """The same from a position, velocity and rotation in inertial axes and any covariance of theirs."""
    strapdown.check(measurements)
    z, count, anchor = measurements, len(measurements.time), np.asarray(setting.world.anchor, dtype=float)
    attached = strapdown.attach(z)
    track = Track(
        time=z.time,
        position=np.empty((count, 3)),
        velocity=np.empty((count, 3)),
        rotation=np.empty((count, 3, 3)),
        covariance=np.empty((count, STATES, STATES)),
        innovation=np.full((len(z.range), 2), np.nan),
    )
    track.position[0], track.velocity[0], track.rotation[0] = start[0] - anchor, start[1], start[2]
    track.covariance[0] = covariance
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
