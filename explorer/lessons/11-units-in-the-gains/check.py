"""Passed when the attitude settles within 7 s, at the rate of the start, with a filter that is not stiff."""

import math
from pathlib import Path

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from explorer.lessons.state import read

SETTLED, STIFFNESS = 7.0, 1.0
"""s, rate × step"""
START = read(Path(__file__).with_name("start.toml")).preset


def check(state: State) -> Outcome:
    """The metric is the settling time of the attitude (s)."""
    settled, stiffness = measures.picture(state).summary.settle_attitude_s, measures.stiffness(state)
    metric = math.inf if settled is None else settled
    other = measures.changed(state.preset, START, "path", "duration", "world", "sensors", "guess")
    if other:
        return Outcome(metric, False, other)
    if stiffness > STIFFNESS:
        return Outcome(metric, False, f"The fastest rate times the step is {short(stiffness)}: 1 is the most.")
    if metric > SETTLED:
        return Outcome(
            metric, False, f"The attitude settles {'never' if settled is None else f'after {settled:.1f} s'}."
        )
    return Outcome(metric, True, f"The attitude settles after {short(metric, 's')}.")
