"""What the vehicle measures: rates, noise, effects that the paper does not model, and the record of a motion."""

from rangenav.sensors import effects
from rangenav.sensors.antenna import distance
from rangenav.sensors.effects import MODELLED, Effect, Effects
from rangenav.sensors.measuring import NO_SAMPLE, Measurements, check, measure
from rangenav.sensors.noise import (
    MAX_RATE,
    MAX_SIGMA,
    MIN_DENSITY,
    MIN_RANGE_RATE,
    MIN_RATE,
    MIN_SIGMA,
    Noise,
    Unit,
    density,
    in_unit,
    per_sample,
)
from rangenav.sensors.suite import Sensors, active_effects, drift, effect_sentences, noise_assumption

__all__ = [
    "MAX_RATE",
    "MAX_SIGMA",
    "MIN_DENSITY",
    "MIN_RANGE_RATE",
    "MIN_RATE",
    "MIN_SIGMA",
    "MODELLED",
    "NO_SAMPLE",
    "Effect",
    "Effects",
    "Measurements",
    "Noise",
    "Sensors",
    "Unit",
    "active_effects",
    "check",
    "density",
    "distance",
    "drift",
    "effect_sentences",
    "effects",
    "in_unit",
    "measure",
    "noise_assumption",
    "per_sample",
]
