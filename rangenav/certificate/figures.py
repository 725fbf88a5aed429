"""Sampled figures of a preset, for searches: μ and predicted σ on few windows, and how far it exceeds its vehicle.

They take some 5 ms instead of the certificate's 100, but are samples and no bounds. So the result of a search is
certified afterwards.
"""

import math
from dataclasses import dataclass

import numpy as np

from rangenav import record, vehicle, verdict
from rangenav.observability import accuracy, derivative_bounds
from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.observability.sums import least
from rangenav.preset import Preset
from rangenav.signals import Signal
from rangenav.vehicle import THRUST_MARGIN, Demands, Vehicle

WINDOWS = 24
"""Start times that are sampled; added are those at which knots enter or leave the window."""
MAX_KNOTS = 24
RATE, MAX_SAMPLES = 50.0, 1500
"""The highest rate (Hz) and the most samples on which the vehicle's limits are tested."""
BLIND_MU = 1e-30
"""m²/s⁷; replaces μ = 0, so that its logarithm exists."""
UPPER_LIMITS = {"thrust_to_weight", "speed", "acceleration", "jerk", "snap", "tilt", "body_rate"}
"""Limits that are a largest value; the other limits are heights and distances."""


@dataclass(frozen=True, kw_only=True)
class Figures:
    """Sampled figures, SI."""

    mu: float
    """The least over the sampled windows."""
    sigma: float
    """m, the largest lifted position σ at a window's end; infinite where blind."""
    excess: dict[str, float]
    """How far each limit of the vehicle is exceeded: log(reached/allowed), or m for heights; at most 0 is within it."""

    farthest: float = math.inf
    """m, the largest distance to the anchor."""

    @property
    def worst_excess(self) -> float:
        """The largest excess; −∞ for a vehicle without limits."""
        return max(self.excess.values(), default=-math.inf)


def figures(preset: Preset) -> Figures:
    """The figures of a preset. Raises ValueError if the motion has no attitude somewhere, or for too much work."""
    path, window = preset.path, preset.requirement.window
    last = preset.duration - window
    edges = derivative_bounds.knots_until(path, preset.duration)
    few = edges[:: 1 + len(edges) // MAX_KNOTS]
    events = np.concatenate([few, few - window])
    start = np.union1d(np.linspace(0, last, WINDOWS), events[(events >= 0) & (events <= last)])
    ranging = preset.sensors
    sigma = accuracy.end_sigmas(
        path,
        preset.world,
        start,
        window,
        sigma=ranging.sigma.range,
        rate=ranging.range_rate,
        kind="lifted",
        share=ranging.arriving,
    )[:, 0]
    demands = demanded(preset)
    return Figures(
        farthest=float(demands.anchor_distance.max()),
        mu=max(BLIND_MU, _least(path, window, last)),
        sigma=float(np.max(np.nan_to_num(sigma, nan=np.inf))),
        excess=excess(demands, preset.vehicle),
    )


def _least(path: Signal, window: float, last: float) -> float:
    """λ_min of the least sampled window, over a period of the path; over the flight if there is none or a long one."""
    try:
        return least(path, window, path.period or last)
    except UnboundedDerivativeError:
        return least(path, window, last)


def demanded(preset: Preset) -> Demands:
    """The motion's demands on a vehicle, on a coarse grid of the flight."""
    rate = min(preset.sensors.imu_rate, RATE, MAX_SAMPLES / preset.duration)
    moved = record.motion_of(record.truth_inputs(preset, rate=rate))
    return vehicle.demands(moved, world=preset.world)


def excess(demands: Demands, limits: Vehicle) -> dict[str, float]:
    """How far each limit is exceeded, positive where it is broken. The thrust has to keep THRUST_MARGIN."""
    excesses = {}
    for limit in UPPER_LIMITS:
        allowed = getattr(limits, limit)
        if allowed is not None:
            allowed = allowed / (1 + THRUST_MARGIN) if limit == "thrust_to_weight" else allowed
            excesses[limit] = math.log(max(float(getattr(demands, limit).max()), 1e-300) / allowed)
    if limits.height_min is not None:
        excesses["height_min"] = limits.height_min - float(demands.height.min())
    if limits.height_max is not None:
        excesses["height_max"] = float(demands.height.max()) - limits.height_max
    if limits.anchor_distance_min is not None:
        nearest = max(float(demands.anchor_distance.min()), 1e-300)
        excesses["anchor_distance_min"] = math.log(limits.anchor_distance_min / nearest)
    return excesses


def shortfall(reached: Figures, preset: Preset, *, margin: float = 0.0) -> dict[str, float]:
    """How far μ and σ are from their requirements, as logarithms: met at 0 or below. margin: log, required of both.

    A σ above the sphere on which a range leaves the position misses any requirement, see `verdict.judge`.
    """
    needed = preset.requirement
    sigma = min(needed.position_sigma, verdict.sphere(reached.farthest))
    return {
        "excitation": math.log(needed.mu / reached.mu) + margin,
        "accuracy": math.log(max(reached.sigma, 1e-300) / max(sigma, 1e-300)) + margin,
    }
