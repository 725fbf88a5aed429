"""What a vehicle carries: the rate of each sensor, its noise, and the effects that the paper does not model."""

import math

from rangenav.inputs import Input, require, require_within
from rangenav.sensors.effects import MODELLED, Effects, sentences, unpredicted
from rangenav.sensors.noise import MAX_RATE, MIN_RANGE_RATE, MIN_RATE, Noise, density, in_unit


class Sensors(Input, frozen=True, kw_only=True):
    """Rates in Hz, the noise, and the effects that the paper does not model."""

    imu_rate: float = 200.0
    """Hz"""
    mag_rate: float = 200.0
    """Hz"""
    range_rate: float = 50.0
    """Hz"""
    noise: Noise = Noise()
    unmodelled: Effects = MODELLED

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("imu_rate", self.imu_rate, MIN_RATE, MAX_RATE, "Hz")
        require(
            MIN_RATE <= self.mag_rate <= self.imu_rate,
            f"mag_rate must lie between 1 Hz and imu_rate, got {self.mag_rate:g}",
        )
        require_within("range_rate", self.range_rate, MIN_RANGE_RATE, MAX_RATE, "Hz")
        try:
            in_unit(self.noise, "sample", rate=self.imu_rate)
        except ValueError as error:
            raise ValueError(f"{error} per sample at {self.imu_rate:g} Hz") from None

    @property
    def sigma(self) -> Noise:
        """The noise per sample, in whatever unit it was given; every computation uses this."""
        return in_unit(self.noise, "sample", rate=self.imu_rate)

    @property
    def arriving(self) -> float:
        """The share of ranges that arrive despite random drop-outs; a burst is not included."""
        return 1 - self.unmodelled.dropout_probability


def drift(sensors: Sensors, window: float) -> float:
    """1-σ (m) of a position that the accelerometer alone carries through a window (s): n δ^(3/2) / √3, from its noise
    of density n; start, attitude and gravity are known, and there are no ranges."""
    return density(sensors.sigma.accel, sensors.imu_rate) * window**1.5 / math.sqrt(3)


def effect_sentences(sensors: Sensors) -> tuple[str, ...]:
    """One sentence for each effect that is on and that the paper does not model."""
    return tuple(f"{name}: {clause}." for name, clause in sentences(sensors.unmodelled).items())


def active_effects(sensors: Sensors) -> tuple[str, ...]:
    """The names of the effects that are on and that the paper does not model."""
    return tuple(sentences(sensors.unmodelled))


def noise_assumption(sensors: Sensors) -> str:
    """What the predicted accuracy assumes, as a text to show with it."""
    lost = sensors.unmodelled.dropout_probability
    thinned = f", {100 * lost:g} of 100 of them lost" if lost else ""
    note = f"ranges at {sensors.range_rate:g} Hz with {sensors.sigma.range:g} m noise{thinned}, no IMU noise"
    ignored = unpredicted(sensors.unmodelled)
    return f"{note}, and nothing of what is on besides: {', '.join(ignored)}" if ignored else note
