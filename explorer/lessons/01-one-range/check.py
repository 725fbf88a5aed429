"""Passed when the twin stays more than a metre away, and its range agrees within two centimetres."""

import math

from explorer.lessons import Outcome, State
from explorer.lessons.figures import short
from explorer.model import details
from rangenav.twin import Twin

APART, AGREES = 1.0, 0.02
"""m"""


def check(state: State) -> Outcome:
    """The metric is the least distance of the twin (m)."""
    twin = details.details(state.preset, turn=state.settings.twin_turn).twin
    if not isinstance(twin, Twin):
        return Outcome(math.nan, False, "This motion has no twin: hover, as at the start of the lesson.")
    if twin.mismatch > AGREES:
        return Outcome(twin.nearest, False, f"The two ranges differ by {short(twin.mismatch, 'm')}, more than 2 cm.")
    if twin.nearest <= APART:
        return Outcome(twin.nearest, False, f"The twin is {short(twin.nearest, 'm')} away: turn it farther.")
    return Outcome(twin.nearest, True, f"The twin is {short(twin.nearest, 'm')} away and has the same range.")
