"""A quick look at a preset, for searches: μ and predicted σ on few windows, and what of its vehicle's limits it uses.

Some 5 ms instead of a certificate's 100: samples and no bounds, so whatever a search ends with is certified afterwards.
"""

import math
from dataclasses import dataclass

import numpy as np

from rangenav import motion, vehicle
from rangenav.certificate import derivative_bounds
from rangenav.certificate.derivative_bounds import UnboundedDerivativeError
from rangenav.certificate.sums import least
from rangenav.observability import accuracy
from rangenav.preset import Preset
from rangenav.signals import Signal
from rangenav.vehicle import THRUST_MARGIN, Demands, Vehicle

WINDOWS = 24
"""Start times looked at, besides those at which knots enter or leave the window."""
MAX_KNOTS = 24
RATE, MAX_SAMPLES = 50.0, 1500
"""Hz at most, and samples at most, on which the vehicle's limits are looked at."""
BLIND_MU = 1e-30
"""m²/s⁷; stands for none at all, so that logarithms exist."""
MOST = {"thrust_to_weight", "speed", "acceleration", "jerk", "snap", "tilt", "body_rate"}
"""Limits of which a motion may use at most all; the others are heights and distances."""


@dataclass(frozen=True, kw_only=True)
class Figures:
    """How much is asked and had; SI."""

    mu: float
    """The least over the sampled windows."""
    sigma: float
    """m, the largest lifted position σ at a window's end; infinite where blind."""
    excess: dict[str, float]
    """For each limit of the vehicle how far it is exceeded: log(reached/allowed), or m for heights; fine up to 0."""

    @property
    def worst_excess(self) -> float:
        """−∞ for a vehicle without limits."""
        return max(self.excess.values(), default=-math.inf)


def figures(preset: Preset) -> Figures:
    """The quick look. Raises ValueError where the motion cannot be flown at all, or would be too much work."""
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
    return Figures(
        mu=max(BLIND_MU, _least(path, window, last)),
        sigma=float(np.max(np.nan_to_num(sigma, nan=np.inf))),
        excess=excess(demanded(preset), preset.vehicle),
    )


def _least(path: Signal, window: float, last: float) -> float:
    """λ_min of the least sampled window: over a period where there is one, and it is not too long to look at."""
    try:
        return least(path, window, path.period or last)
    except UnboundedDerivativeError:
        return least(path, window, last)


def demanded(preset: Preset) -> Demands:
    """What the motion asks for on a coarse grid of the flight."""
    rate = min(preset.sensors.imu_rate, RATE, MAX_SAMPLES / preset.duration)
    moved = motion.simulate(
        preset.path,
        preset.angular_velocity,
        world=preset.world,
        initial_rotation=preset.initial_rotation,
        duration=preset.duration,
        rate=rate,
    )
    return vehicle.demands(moved, world=preset.world)


def excess(asked: Demands, flying: Vehicle) -> dict[str, float]:
    """How far each limit is exceeded; positive where it is broken, the thrust margin kept."""
    found = {}
    for limit in MOST:
        allowed = getattr(flying, limit)
        if allowed is not None:
            allowed = allowed / (1 + THRUST_MARGIN) if limit == "thrust_to_weight" else allowed
            found[limit] = math.log(max(float(getattr(asked, limit).max()), 1e-300) / allowed)
    if flying.height_min is not None:
        found["height_min"] = flying.height_min - float(asked.height.min())
    if flying.height_max is not None:
        found["height_max"] = float(asked.height.max()) - flying.height_max
    if flying.anchor_distance_min is not None:
        nearest = max(float(asked.anchor_distance.min()), 1e-300)
        found["anchor_distance_min"] = math.log(flying.anchor_distance_min / nearest)
    return found


def shortfall(found: Figures, preset: Preset, *, margin: float = 0.0) -> dict[str, float]:
    """How far μ and σ stay behind what is required, as logarithms: fine up to 0. A margin asks for more of both."""
    needed = preset.requirement
    return {
        "excitation": math.log(needed.mu / found.mu) + margin,
        "accuracy": math.log(max(found.sigma, 1e-300) / needed.position_sigma) + margin,
    }
