"""What a metric of a study must not exceed, or must reach: the preset's requirement, or a limit of its vehicle."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav import record, vehicle
from rangenav.preset import Preset
from rangenav.studies.metrics import SETTLED
from rangenav.vehicle import THRUST_MARGIN, WORDS, Vehicle


class Bound(NamedTuple):
    """What a metric must not exceed, or must reach."""

    level: float
    most: bool
    """Whether the level is the largest value allowed; else it is the least."""
    words: str
    """Where it comes from."""

    def met(self, values: Float[Array, "*n"]) -> Bool[Array, "*n"]:
        """Whether each value meets it; NaN does not."""
        with np.errstate(invalid="ignore"):
            return values <= self.level if self.most else values >= self.level


def bound_of(metric: str, preset: Preset) -> Bound | None:
    """The requirement of a preset, or the limit of its vehicle, that a metric is compared with; None without one."""
    of = BOUNDS.get(metric)
    return None if of is None else of(preset)


def limited(of: Vehicle) -> bool:
    """Whether a vehicle has any limit."""
    return any(vehicle.bound(of, limit) is not None for limit in WORDS)


def broken(preset: Preset) -> tuple[str, ...]:
    """The limits of the vehicle that a preset's motion breaks, a text for each, the most broken one first."""
    moved = record.simulated(record.truth_inputs(preset)).motion
    return tuple(one.summary for one in vehicle.broken(moved, preset.vehicle, world=preset.world))


def _required_error(preset: Preset) -> Bound:
    return Bound(preset.requirement.position_sigma, True, "position error wanted")


def _vehicle(name: str, *, most: bool = True, share: float = 1.0) -> Callable[[Preset], Bound | None]:
    def limit_of(preset: Preset) -> Bound | None:
        limit = getattr(preset.vehicle, name)
        return None if limit is None else Bound(limit * share, most, f"limit of the {preset.vehicle.name}")

    return limit_of


def _yes(words: str) -> Callable[[Preset], Bound]:
    return lambda _: Bound(0.5, False, words)


LIMITS = "keeps the vehicle's limits"
NO_LIMITS = "no vehicle is chosen, so no limit applies"
BOUNDS: Mapping[str, Callable[[Preset], Bound | None]] = {
    "mu": lambda preset: Bound(preset.requirement.mu, False, "excitation μ wanted"),
    "sigma_lifted": _required_error,
    "sigma_nonlinear": _required_error,
    "steady_position": _required_error,
    "rank": lambda _: Bound(12.5, False, "all 13 quantities"),
    "rank_nonlinear": lambda _: Bound(8.5, False, "all 9 quantities"),
    "observable": _yes("observable"),
    "flyable": lambda preset: Bound(0.5, False, LIMITS if limited(preset.vehicle) else NO_LIMITS),
    "settled": _yes(f"position and attitude settle to {SETTLED}"),
    "diverged": lambda _: Bound(0.5, True, "has not diverged"),
    "speed": _vehicle("speed"),
    "acceleration": _vehicle("acceleration"),
    "thrust_to_weight": _vehicle("thrust_to_weight", share=1 / (1 + THRUST_MARGIN)),
    "body_rate": _vehicle("body_rate"),
    "snap": _vehicle("snap"),
    "anchor_distance": _vehicle("anchor_distance_min", most=False),
}
"""What each metric is compared with; the others have no requirement."""
FIXED = ("rank", "rank_nonlinear", "observable", "flyable", "settled", "diverged")
DEPENDENT = frozenset(BOUNDS) - frozenset(FIXED)
"""Metrics whose bound is a number of the preset's requirement or of its vehicle."""
OF_PRESET = ("mu", "sigma_lifted", "sigma_nonlinear", "steady_position", "observable")


def whose(metric: str) -> str:
    """Who requires what a metric is compared with, for a person."""
    if metric in OF_PRESET:
        return "required by the preset"
    return "required by the vehicle" if metric == "flyable" or metric in DEPENDENT else "required of every study"
