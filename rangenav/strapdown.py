"""The nine-state problem of other estimators: p, v and R in inertial axes, gravity known, the range as output.

    ṗ = v,  v̇ = g + R a,  Ṙ = R [ω]x,  d = |p − p_anchor|,  m_y = Rᵀm;   R = exp([φ]x) R̂ defines the attitude error φ

This is the paper's system (1)–(3) before the lift. It needs less excitation than the lifted one, but its output is
nonlinear, so an estimator that linearises it converges only from near the truth. The acceleration of an interval is the
mean of both ends, each turned by the gyro-integrated rotation. A range between two samples is carried to the later one
by the known motion.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav import model, sensors, so3
from rangenav.arguments import array, instance
from rangenav.cascade import Estimate, ObserverConfig
from rangenav.inputs import Vec3, require
from rangenav.kernels.layout import Strapdown
from rangenav.motion import World, to_body
from rangenav.results import result
from rangenav.sensors import Measurements

POSITION, VELOCITY, ATTITUDE = slice(0, 3), slice(3, 6), slice(6, 9)
STATES = 9
MAX_SAMPLES = 150_000
"""IMU samples of a record (12 minutes at 200 Hz); a smoother keeps some 1.5 kB for each."""
MAX_RANGES = 300_000
LEAST_SIGMA = {"gyro": 1e-5, "accel": 1e-3, "mag": 1e-3, "range": 1e-3}
"""Smaller noise counts as this much (units as in `sensors.Noise`): the integration's own error is about as large, and
with zero variances no weights exist."""


@result
class Track:
    """A nine-state estimate of a record, time first, inertial axes."""

    time: Float[Array, "n"]
    position: Float[Array, "n 3"]
    """m"""
    velocity: Float[Array, "n 3"]
    """m/s"""
    rotation: Float[Array, "n 3 3"]
    """R̂."""
    covariance: Float[Array, "n 9 9"]
    """Of the errors of position, velocity and attitude (φ, rad)."""
    innovation: Float[Array, "m 2"]
    """Range less the one expected (m), and the variance of that (m²); NaN for a range outside the IMU's record."""

    @property
    def std(self) -> Float[Array, "n 9"]:
        """Square roots of the covariance's diagonal; NaN where it is negative."""
        with np.errstate(invalid="ignore"):
            return np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1))


class Attached(NamedTuple):
    """The IMU sample at which each range is applied: the one at its stamp, or the next one."""

    kept: slice
    """The ranges that lie within the IMU's record."""
    sample: Int[Array, "r"]
    back: Float[Array, "r"]
    """s: from the range to that sample."""


def check(measurements: Measurements) -> Measurements:
    """The record as float64 arrays. Raises ValueError as `sensors.check` does, and for a record that is too long to
    keep a covariance of each sample."""
    z = sensors.check(measurements)
    samples, ranges = len(z.time), len(z.range)
    require(samples <= MAX_SAMPLES, f"a record may have at most {MAX_SAMPLES} IMU samples here, got {samples}")
    require(ranges <= MAX_RANGES, f"a record may have at most {MAX_RANGES} ranges here, got {ranges}")
    return z


def check_track(track: Track, samples: int) -> Track:
    """The track as float64 arrays with one row for each of so many IMU samples; its covariance and innovations as they
    are. Raises ValueError for another number of rows, or a wrong shape or type; a diverged track holds NaN."""
    instance("nominal", track, Track, called="strapdown.Track")
    rows = len(track.time)
    require(rows == samples, f"the trajectory must have one row for each of the {samples} IMU samples, got {rows}")
    return replace(
        track,
        position=array("position", track.position, (samples, 3)),
        velocity=array("velocity", track.velocity, (samples, 3)),
        rotation=array("rotation", track.rotation, (samples, 3, 3)),
    )


def attach(measurements: Measurements) -> Attached:
    """Which IMU sample each range is applied at."""
    z = measurements
    first = int(np.searchsorted(z.range_time, z.time[0], side="left"))
    last = int(np.searchsorted(z.range_time, z.time[-1], side="right"))
    stamps = z.range_time[first:last]
    sample = np.searchsorted(z.time, stamps, side="left")
    return Attached(kept=slice(first, last), sample=sample, back=z.time[sample] - stamps)


def parameters(setting: ObserverConfig) -> Strapdown:
    """The world and the sensors' noise in the kernels' terms."""
    world, carried = setting.world, setting.sensors
    sigma = {name: max(float(getattr(carried.sigma, name)), least) for name, least in LEAST_SIGMA.items()}
    magnetic = np.asarray(world.magnetic, dtype=float)
    across = np.cross(magnetic, np.eye(3)[np.argmin(np.abs(magnetic))])
    across /= np.linalg.norm(across)
    return Strapdown(
        gravity=_floats(np.asarray(world.gravity)),
        across1=_floats(across),
        across2=_floats(np.cross(magnetic, across)),
        range_variance=sigma["range"] ** 2,
        mag_variance=sigma["mag"] ** 2,
        accel_density=sigma["accel"] ** 2 / carried.imu_rate,
        gyro_density=sigma["gyro"] ** 2 / carried.imu_rate,
    )


def reversed_record(measurements: Measurements) -> Measurements:
    """The same record run backwards: time and gyro change their sign, and so will every velocity."""
    z = measurements

    def backwards(array: Array) -> Array:
        return np.ascontiguousarray(array[::-1])

    return Measurements(
        time=backwards(-z.time),
        gyro=backwards(-z.gyro),
        accel=backwards(z.accel),
        mag=backwards(z.mag),
        range_time=backwards(-z.range_time),
        range=backwards(z.range),
    )


def reversed_track(track: Track) -> Track:
    """The track of a reversed record as one of the record itself."""

    def backwards(array: Array) -> Array:
        return np.ascontiguousarray(array[::-1])

    return Track(
        time=backwards(-track.time),
        position=backwards(track.position),
        velocity=backwards(-track.velocity),
        rotation=backwards(track.rotation),
        covariance=_flipped(backwards(track.covariance)),
        innovation=backwards(track.innovation),
    )


def lifted(track: Track, measurements: Measurements, world: World) -> Estimate:
    """The track as an `Estimate`: the 13-state in body axes, covariances to first order, innovations of y = ½d².

    `errors.of`, `record.summarise` and the plots then treat it as they treat the cascade. The position error is that of
    p_B = R̂ᵀ(p̂ − p_anchor): a turn of everything about the anchor changes no range, and no p_B either.
    """
    gravity = np.broadcast_to(np.asarray(world.gravity, dtype=float), track.position.shape)
    relative = track.position - np.asarray(world.anchor)
    inertial = (relative, track.velocity, gravity)
    rows = [np.zeros((len(track.time), 3, STATES)) for _ in inertial]
    for block, vector, row in zip((POSITION, VELOCITY, None), inertial, rows, strict=True):
        if block is not None:
            row[:, :, block] = np.eye(3)
        row[:, :, ATTITUDE] = so3.hat(vector)  # Rᵀu = R̂ᵀ(u − φ × u)
    body = [np.swapaxes(track.rotation, -1, -2) @ row for row in rows]
    expected = measurements.range - track.innovation[:, 0]
    innovation = track.innovation * np.stack([(measurements.range + expected) / 2, expected**2], axis=-1)
    return Estimate(
        time=track.time,
        state=model.lift(*(to_body(track.rotation, vector) for vector in inertial)),
        covariance=np.stack([row @ track.covariance @ np.swapaxes(row, -1, -2) for row in body], axis=1),
        xi_variance=_xi_variance(track, relative, gravity),
        rotation=track.rotation,
        innovation=innovation,
    )


def _flipped(covariance: Float[Array, "n 9 9"]) -> Float[Array, "n 9 9"]:
    """The covariance of a velocity that has changed its sign."""
    covariance[:, VELOCITY, :] *= -1
    covariance[:, :, VELOCITY] *= -1
    return covariance


def _xi_variance(track: Track, relative: Float[Array, "n 3"], gravity: Float[Array, "n 3"]) -> Float[Array, "n 4"]:
    """Variances of ξ1 = ½|p|², ξ2 = p·v, ξ3 = |v|² + p·g, ξ4 = 3 v·g; no rotation changes them."""
    rows = np.zeros((len(track.time), 4, STATES))
    rows[:, 0, POSITION] = relative
    rows[:, 1, POSITION], rows[:, 1, VELOCITY] = track.velocity, relative
    rows[:, 2, POSITION], rows[:, 2, VELOCITY] = gravity, 2 * track.velocity
    rows[:, 3, VELOCITY] = 3 * gravity
    return np.einsum("nij,njk,nik->ni", rows, track.covariance, rows)


def _floats(vector: Array) -> Vec3:
    return float(vector[0]), float(vector[1]), float(vector[2])
