"""What a metric of a study must not exceed, or must reach: the preset's requirement, or a limit of its vehicle."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.preset import Preset
from rangenav.vehicle import THRUST_MARGIN


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


def _required_error(preset: Preset) -> Bound:
    return Bound(preset.requirement.position_sigma, True, "position error wanted")


def _vehicle(name: str, *, most: bool = True, share: float = 1.0) -> Callable[[Preset], Bound | None]:
    def bound(preset: Preset) -> Bound | None:
        limit = getattr(preset.vehicle, name)
        return None if limit is None else Bound(limit * share, most, f"limit of the {preset.vehicle.name}")

    return bound


def _yes(words: str) -> Callable[[Preset], Bound]:
    return lambda _: Bound(0.5, False, words)


BOUNDS: Mapping[str, Callable[[Preset], Bound | None]] = {
    "mu": lambda preset: Bound(preset.requirement.mu, False, "excitation μ wanted"),
    "sigma_lifted": _required_error,
    "sigma_nonlinear": _required_error,
    "steady_position": _required_error,
    "rank": lambda _: Bound(12.5, False, "all 13 quantities"),
    "rank_nonlinear": lambda _: Bound(8.5, False, "all 9 quantities"),
    "observable": _yes("observable"),
    "flyable": _yes("keeps the vehicle's limits"),
    "settled": _yes("position and attitude settle"),
    "diverged": lambda _: Bound(0.5, True, "has not diverged"),
    "speed": _vehicle("speed"),
    "acceleration": _vehicle("acceleration"),
    "thrust_to_weight": _vehicle("thrust_to_weight", share=1 / (1 + THRUST_MARGIN)),
    "body_rate": _vehicle("body_rate"),
    "snap": _vehicle("snap"),
    "anchor_distance": _vehicle("anchor_distance_min", most=False),
}
"""What each metric is compared with; the others have no requirement."""
