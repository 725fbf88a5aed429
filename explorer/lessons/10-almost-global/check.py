"""Passed when the slowest of three starts near a half turn settles within 8 s."""

import math
from pathlib import Path

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from explorer.lessons.state import read

SETTLED = 8.0
"""s"""
START = read(Path(__file__).with_name("start.toml")).preset


def check(state: State) -> Outcome:
    """The metric is the settling time of the slowest start (s)."""
    other = measures.changed(state.preset, START, "path", "duration", "world", "sensors")
    if other:
        return Outcome(math.nan, False, other)
    slowest = measures.slowest_start(state.preset)
    if not math.isfinite(slowest):
        return Outcome(slowest, False, "One of the three starts does not come below 5° in this flight.")
    if slowest > SETTLED:
        return Outcome(slowest, False, f"The slowest start takes {short(slowest, 's')}.")
    return Outcome(slowest, True, f"Even the slowest start takes {short(slowest, 's')} only.")
