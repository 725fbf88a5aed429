"""Passed when five runs with other noise all end with a steady error below 0.2 m."""

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from rangenav import preset

STEADY = 0.2
"""m"""
PRESET, DURATION = "paper-slow", 30.0


def check(state: State) -> Outcome:
    """The metric is the largest steady error of five runs (m)."""
    p, before = state.preset, preset.load(PRESET)
    steady, peak = measures.worst_of_seeds(p)
    if (p.path, p.sensors, p.guess, p.duration) != (before.path, before.sensors, before.guess, DURATION):
        return Outcome(steady, False, "Only gains may change: path, sensors, start and duration are part of the task.")
    if steady >= STEADY:
        return Outcome(steady, False, f"The worst of five runs keeps an error of {short(steady, 'm')}.")
    return Outcome(
        steady, True, f"The worst of five runs keeps {short(steady, 'm')}, after a peak of {short(peak, 'm')}."
    )
