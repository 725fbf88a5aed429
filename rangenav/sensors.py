"""What the vehicle measures (paper, eq. 2–3): gyro ω + η, accel Rᵀ(p̈ − g) + η, mag Rᵀm + η, range |p − p_anchor| + η.

Gyro and accel share the IMU's clock. The magnetometer is read on that clock too, at its own slower rate: samples in
between are NaN. Ranges carry their own time stamps, so they may come at any rate, with gaps, between IMU samples.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.inputs import Input, require, require_within
from rangenav.motion import Motion, World, to_body
from rangenav.signals import Signal

MIN_RATE, MAX_RATE = 1.0, 10_000.0
MIN_SIGMA, MAX_SIGMA = 1e-9, 1e3
"""Besides exactly none; smaller noise means nothing to any sensor, and its square would underflow."""


class Noise(Input, frozen=True, kw_only=True):
    """Standard deviation per sample of each sensor's white Gaussian noise; the paper prints only mag, variance 1e-2."""

    gyro: float = 0.01
    """rad/s"""
    accel: float = 0.1
    """m/s²"""
    mag: float = 0.1
    """The measured vector has unit length."""
    range: float = 0.1
    """m"""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in self.__struct_fields__:
            value = getattr(self, name)
            rule = f"noise {name} must lie between {MIN_SIGMA:g} and {MAX_SIGMA:g} or be 0, got {value:g}"
            require(value == 0 or MIN_SIGMA <= value <= MAX_SIGMA, rule)


class Sensors(Input, frozen=True, kw_only=True):
    """Rates in Hz, and the noise."""

    imu_rate: float = 200.0
    mag_rate: float = 200.0
    range_rate: float = 50.0
    noise: Noise = Noise()

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("imu_rate", self.imu_rate, MIN_RATE, MAX_RATE, "Hz")
        require(
            MIN_RATE <= self.mag_rate <= self.imu_rate,
            f"mag_rate must lie between 1 Hz and imu_rate, got {self.mag_rate:g}",
        )
        require_within("range_rate", self.range_rate, MIN_RATE, MAX_RATE, "Hz")


@dataclass(frozen=True, eq=False, kw_only=True)
class Measurements:
    """One record, as a logger would have it; body frame."""

    time: Float[Array, "n"]
    """s, the IMU's clock."""
    gyro: Float[Array, "n 3"]
    accel: Float[Array, "n 3"]
    mag: Float[Array, "n 3"]
    """NaN where the magnetometer gave no sample."""
    range_time: Float[Array, "m"]
    """s, increasing."""
    range: Float[Array, "m"]
    """m; never clipped, so it may be negative close to the anchor."""


def measure(motion: Motion, *, path: Signal, world: World, sensors: Sensors, rng: np.random.Generator) -> Measurements:
    """The noisy record of a motion. Each sensor draws from its own stream, so that changing one leaves the others."""
    gyro_rng, accel_rng, mag_rng, range_rng = rng.spawn(4)
    time, noise = motion.time, sensors.noise
    mag = to_body(motion.rotation, np.broadcast_to(np.asarray(world.magnetic), motion.position.shape))
    mag = mag + noise.mag * mag_rng.standard_normal(mag.shape)
    mag[~_sampled(time, rate=sensors.mag_rate, clock=sensors.imu_rate)] = np.nan
    range_time = _range_times(time, rate=sensors.range_rate, clock=sensors.imu_rate)
    distance = np.linalg.norm(path(range_time) - np.asarray(world.anchor), axis=-1)
    return Measurements(
        time=time,
        gyro=motion.angular_velocity + noise.gyro * gyro_rng.standard_normal((*time.shape, 3)),
        accel=motion.apparent_acceleration + noise.accel * accel_rng.standard_normal((*time.shape, 3)),
        mag=mag,
        range_time=range_time,
        range=distance + noise.range * range_rng.standard_normal(range_time.shape),
    )


def check(measurements: Measurements) -> None:
    """Raise ValueError at the first sample whose stamp does not increase or that is not finite (mag may be NaN)."""
    z = measurements
    require(len(z.time) >= 2, f"a record needs at least two IMU samples, got {len(z.time)}")
    for name, stamps in (("time", z.time), ("range_time", z.range_time)):
        _refuse_first(np.asarray(~(np.diff(stamps) > 0)), f"{name} must increase", offset=1)
    for name in ("gyro", "accel", "range", "time", "range_time"):
        finite = np.asarray(np.isfinite(getattr(z, name)))
        _refuse_first(np.asarray(~finite.all(axis=tuple(range(1, finite.ndim)))), f"{name} must be finite")
    _refuse_first(np.asarray(np.isinf(z.mag).any(axis=-1)), "mag must be finite, or NaN where there is none")


def _refuse_first(bad: Bool[Array, "n"], rule: str, *, offset: int = 0) -> None:
    if bad.any():
        raise ValueError(f"{rule}: broken at sample {int(np.argmax(bad)) + offset}")


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
    return np.arange(count) / rate
