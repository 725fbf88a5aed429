"""Passed when five runs with other noise all end with a steady error below 0.2 m."""

import math
from pathlib import Path

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from explorer.lessons.state import read

STEADY = 0.2
"""m"""
START = read(Path(__file__).with_name("start.toml")).preset


def check(state: State) -> Outcome:
    """The metric is the largest steady error of five runs (m)."""
    p = state.preset
    other = measures.changed(p, START, "path", "duration", "world", "sensors", "guess")
    if other:
        return Outcome(math.nan, False, other)
    steady, peak = measures.worst_of_seeds(p)
    if steady >= STEADY:
        keeps = f"The worst of five runs keeps an error of {short(steady, 'm')}"
        return Outcome(steady, False, f"{keeps}, after a peak of {short(peak, 'm')}.")
    return Outcome(
        steady, True, f"The worst of five runs keeps {short(steady, 'm')}, after a peak of {short(peak, 'm')}."
    )
