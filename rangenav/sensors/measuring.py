"""What the vehicle measures (paper, eq. 2–3): gyro ω + η, accel Rᵀ(p̈ − g) + η, mag Rᵀm + η, range |p − p_anchor| + η.

Gyro and accel share the IMU's clock. The magnetometer is read on that clock too, at its own slower rate: samples in
between are NaN. Ranges carry their own time stamps, so they may come at any rate, with gaps, between IMU samples.
Biases, outliers, drop-outs and a lever arm are added where `Effects` has them.
"""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.arguments import array, instance
from rangenav.inputs import require
from rangenav.motion import Motion, World, to_body
from rangenav.results import result
from rangenav.sensors import antenna
from rangenav.sensors.effects import Effects
from rangenav.sensors.suite import Sensors
from rangenav.signals import Signal

NO_SAMPLE = ": where the magnetometer gave no sample, write NaN in all three columns"
"""What a refusal of mag = None adds."""


@result
class Measurements:
    """One record, as a logger would have it; body frame."""

    time: Float[Array, "n"]
    """s, the IMU's clock."""
    gyro: Float[Array, "n 3"]
    """rad/s"""
    accel: Float[Array, "n 3"]
    """m/s²"""
    mag: Float[Array, "n 3"]
    """Unit vector and its noise; NaN where the magnetometer gave no sample."""
    range_time: Float[Array, "m"]
    """s, increasing."""
    range: Float[Array, "m"]
    """m; never clipped, so it may be negative close to the anchor."""


@result
class Noiseless:
    """What all records of one motion share: the truth, and what sensors without noise, biases and gaps would measure.

    Of sensors: their rates and lever arm."""

    motion: Motion
    mag: Float[Array, "n 3"]
    """At every IMU sample."""
    mag_sampled: Bool[Array, "n"]
    """Where the magnetometer gives a sample."""
    range_time: Float[Array, "m"]
    """s"""
    distance: Float[Array, "m"]
    """m"""


@result
class Noise:
    """What chance adds to one record, before it is scaled by the noise of each sensor."""

    gyro: Float[Array, "n 3"]
    accel: Float[Array, "n 3"]
    mag: Float[Array, "n 3"]
    range: Float[Array, "m"]
    struck: Float[Array, "m"]
    """Even between 0 and 1; a range is an outlier where this is below the probability of one."""
    excess: Float[Array, "m"]
    """Exponential: the size of an outlier, if it is one."""
    lost: Float[Array, "m"]
    """Even between 0 and 1; a range is lost where this is below the probability of a drop-out."""


def draw(rng: np.random.Generator, samples: int, ranges: int) -> Noise:
    """The noise of a record of so many IMU samples and ranges.

    Each sensor and each effect draws from its own random stream, so that a change of one leaves the others the same to
    the last bit.
    """
    gyro, accel, mag, noise, struck, excess, lost = rng.spawn(7)  # always in this order: a seed means the same noise
    return Noise(
        gyro=gyro.standard_normal((samples, 3)),
        accel=accel.standard_normal((samples, 3)),
        mag=mag.standard_normal((samples, 3)),
        range=noise.standard_normal(ranges),
        struck=struck.random(ranges),
        excess=excess.standard_exponential(ranges),
        lost=lost.random(ranges),
    )


def measure(motion: Motion, *, path: Signal, world: World, sensors: Sensors, rng: np.random.Generator) -> Measurements:
    """The record of a motion."""
    exact = without_noise(motion, path=path, world=world, sensors=sensors)
    return with_noise(exact, draw(rng, len(exact.mag), len(exact.distance)), sensors=sensors)


def without_noise(motion: Motion, *, path: Signal, world: World, sensors: Sensors) -> Noiseless:
    """What perfect sensors with the rates and the lever arm of these would measure."""
    range_time = _range_times(motion.time, rate=sensors.range_rate, clock=sensors.imu_rate)
    arm = sensors.unmodelled.lever_arm
    return Noiseless(
        motion=motion,
        mag=to_body(motion.rotation, np.broadcast_to(np.asarray(world.magnetic), motion.position.shape)),
        mag_sampled=_sampled(motion.time, rate=sensors.mag_rate, clock=sensors.imu_rate),
        range_time=range_time,
        distance=antenna.distance(motion, range_time, path=path, world=world, lever_arm=arm),
    )


def with_noise(exact: Noiseless, noise: Noise, *, sensors: Sensors) -> Measurements:
    """The record with noise that has been drawn for as many samples and ranges as it has."""
    motion, sigma, unmodelled = exact.motion, sensors.sigma, sensors.unmodelled
    mag = exact.mag + sigma.mag * noise.mag
    mag[~exact.mag_sampled] = np.nan
    gyro = motion.angular_velocity + sigma.gyro * noise.gyro
    accel = motion.apparent_acceleration + sigma.accel * noise.accel
    arrived, measured = _ranges(exact.range_time, exact.distance, sigma.range, unmodelled, noise)
    return Measurements(
        time=motion.time,
        gyro=gyro + np.asarray(unmodelled.gyro_bias),
        accel=accel + np.asarray(unmodelled.accel_bias),
        mag=mag,
        range_time=exact.range_time[arrived],
        range=measured[arrived],
    )


def check(measurements: Measurements) -> Measurements:
    """The record as float64 arrays, safe for every kernel; lists and other dtypes are converted.

    Raises ValueError in one sentence for an array of the wrong shape or type, and for the first sample whose stamp does
    not increase or that is not finite. Only mag may be NaN, where the magnetometer gave no sample.
    """
    instance("measurements", measurements, Measurements, called="sensors.Measurements")
    z = _in_shape(measurements)
    require(len(z.time) >= 2, f"a record needs at least two IMU samples, got {len(z.time)}")
    for name, stamps in (("time", z.time), ("range_time", z.range_time)):
        _refuse_first(np.asarray(~(np.diff(stamps) > 0)), f"{name} must increase", offset=1)
    for name in ("gyro", "accel", "range", "time", "range_time"):
        _refuse_first(_unlike(np.isfinite(getattr(z, name))), f"{name} must be finite")
    _refuse_first(_unlike(~np.isinf(z.mag)), "mag must be finite, or NaN where there is none")
    return z


def _unlike(good: Bool[Array, "n *k"]) -> Bool[Array, "m"]:
    """Which samples have a number that is not good; where all are good, which takes a tenth of the time, no list."""
    return np.zeros(0, dtype=bool) if good.all() else np.asarray(~good.reshape(len(good), -1).all(axis=1))


def _in_shape(z: Measurements) -> Measurements:
    """One row of gyro, accel and mag for each IMU stamp, one range for each range stamp."""
    time, range_time = array("time", z.time, ("n",)), array("range_time", z.range_time, ("m",))
    rows = (len(time), 3)
    return Measurements(
        time=time,
        gyro=array("gyro", z.gyro, rows),
        accel=array("accel", z.accel, rows),
        mag=array("mag", z.mag, rows, none=NO_SAMPLE),
        range_time=range_time,
        range=array("range", z.range, range_time.shape),
    )


def _refuse_first(bad: Bool[Array, "n"], rule: str, *, offset: int = 0) -> None:
    if bad.any():
        raise ValueError(f"{rule}: broken at sample {int(np.argmax(bad)) + offset}")


def _ranges(time: Array, distance: Array, sigma: float, unmodelled: Effects, noise: Noise) -> tuple[Array, Array]:
    """Which ranges arrive, and the value of every range, whether it arrives or not."""
    measured = distance + sigma * noise.range + unmodelled.range_bias
    hit = noise.struck < unmodelled.outlier_probability
    measured = measured + hit * unmodelled.outlier_size * noise.excess
    since = time - unmodelled.burst_start
    silent = (since >= 0) & (since < unmodelled.burst_length)
    return (noise.lost >= unmodelled.dropout_probability) & ~silent, measured


def _sampled(time: Array, *, rate: float, clock: float) -> Array:
    """True at those samples of the clock at which a slower sensor has a new reading."""
    count = np.floor(np.arange(len(time)) * (rate / clock) + 1e-9)
    return np.diff(count, prepend=-1) > 0


def _range_times(time: Array, *, rate: float, clock: float) -> Array:
    """Times of the ranges; exactly the IMU's own stamps wherever the two rates divide."""
    count = int(np.floor(time[-1] * rate + 1e-9)) + 1
    ratio = clock / rate
    if abs(ratio - round(ratio)) < 1e-9:
        return time[:: round(ratio)].copy()
    return np.minimum(np.arange(count) / rate, time[-1])  # whose rounding may lie before that of the range
