"""Passed when a closed path through the eight points, at heights that may be chosen, predicts the position well."""

import math
from pathlib import Path

import numpy as np

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from explorer.lessons.state import read
from rangenav.model import STATES
from rangenav.preset import Preset

SIGMA, THRUST = 0.25, 1.9
"""m, and multiples of the weight."""
POINTS = ((0.0, 0.0), (0.71, 0.5), (1.0, 0.0), (0.71, -0.5), (-0.71, 0.5), (-1.0, 0.0), (-0.71, -0.5))
"""m, where the path must pass, seen from above."""
NEAR, SAMPLES = 0.05, 2001
"""m, and samples of one period."""
START = read(Path(__file__).with_name("start.toml")).preset


def check(state: State) -> Outcome:
    """The metric is the position error of one window (m)."""
    p = state.preset
    if not p.path.period:
        return Outcome(math.nan, False, "This path does not close. Choose “waypoints” in “path made of”.")
    missed = _missed(p)
    if missed > NEAR:
        return Outcome(math.nan, False, f"Seen from above, the path misses a point by {short(missed, 'm')}.")
    rank, sigma, thrust = measures.rank(p), measures.sigma(p), measures.limits(p).thrust_to_weight
    other = measures.changed(p, START, "world", "sensors", "requirement", "duration")
    if other:
        return Outcome(sigma, False, other)
    if rank < STATES:
        return Outcome(math.nan, False, f"The path determines {rank} of {STATES} quantities: it lies in a plane.")
    if sigma >= SIGMA:
        return Outcome(sigma, False, f"One window predicts the position to {short(sigma, 'm')}: change more heights.")
    if thrust >= THRUST:
        return Outcome(sigma, False, f"The thrust is {short(thrust)} times the weight: change the heights less.")
    return Outcome(sigma, True, f"One window predicts the position to {short(sigma, 'm')}.")


def _missed(preset: Preset) -> float:
    """The largest distance of a point from the path (m), seen from above."""
    course = preset.path(np.linspace(0, preset.path.period or 0.0, SAMPLES))[:, :2]
    return float(np.linalg.norm(course - np.array(POINTS)[:, None], axis=-1).min(axis=1).max())
