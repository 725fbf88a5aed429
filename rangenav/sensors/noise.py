"""White noise, per sample or as a density: σ = n·√f at a rate f (Hz), so a faster sensor is noisier sample by sample.

The density n is two-sided, as in the observer's V = n² and in Kalibr's model: integrated white noise of density n walks
by n·√t. A data sheet's one-sided figure, σ = n·√(f/2), is √2 larger than n; taken as it stands it is on the safe side.
"""

import math
from typing import Literal

import msgspec

from rangenav.inputs import Input, require

MIN_RATE, MAX_RATE = 1.0, 10_000.0
"""Hz, of any sensor but the range's slowest."""
MIN_RANGE_RATE = 0.1
"""Hz: acoustic ranges come every few seconds."""
MIN_SIGMA, MAX_SIGMA = 1e-9, 1e3
"""Limits of noise that is not zero: no sensor has less, and the square of less would underflow."""
MIN_DENSITY = MIN_SIGMA / math.sqrt(MAX_RATE)
"""The least noise per sample as a density, at the highest rate."""
SENSORS = ("gyro", "accel", "mag", "range")
Unit = Literal["sample", "density"]


class Noise(Input, frozen=True, kw_only=True):
    """Standard deviation of each sensor's white Gaussian noise, in the unit in which it was given.

    The paper prints only the magnetometer's, σ² = 1e-2. Computations use `Sensors.sigma`, which is always per sample.
    """

    gyro: float = 0.01
    """rad/s, per sample; or rad/s/√Hz."""
    accel: float = 0.1
    """m/s², per sample; or m/s²/√Hz."""
    mag: float = 0.1
    """Per sample; the measured vector has unit length."""
    range: float = 0.1
    """m, per sample."""
    imu_unit: Unit = "sample"
    """The unit of gyro and accel. A density stays the same when the IMU's rate changes. Mag and range have no such
    choice, because their data sheets give the deviation of a reading."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in SENSORS:
            value = getattr(self, name)
            least = MIN_DENSITY if self.imu_unit == "density" and name in ("gyro", "accel") else MIN_SIGMA
            rule = f"noise {name} must be 0, or lie between {least:g} and {MAX_SIGMA:g}, got {value:g}"
            require(value == 0 or least <= value <= MAX_SIGMA, rule)


def per_sample(density: float, rate: float) -> float:
    """σ of one sample at `rate` (Hz) of white noise with a density (unit/√Hz)."""
    return density * math.sqrt(rate)


def density(sigma: float, rate: float) -> float:
    """Density (unit/√Hz) of white noise with σ per sample at `rate` (Hz)."""
    return sigma / math.sqrt(rate)


def in_unit(noise: Noise, unit: Unit, *, rate: float) -> Noise:
    """The same noise with gyro and accel in a unit, for an IMU at `rate` (Hz); the same object if it has that unit."""
    if noise.imu_unit == unit:
        return noise
    turn = per_sample if unit == "sample" else density
    return msgspec.structs.replace(noise, gyro=turn(noise.gyro, rate), accel=turn(noise.accel, rate), imu_unit=unit)
