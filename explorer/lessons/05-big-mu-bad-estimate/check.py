"""Passed when A has a thousand times the excitation of B and five times its position error."""

import math

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from explorer.model.settings import effective

EXCITATION, ERROR = 1000.0, 5.0
"""How many times larger those of A must be."""


def check(state: State) -> Outcome:
    """The metric is the excitation of A over that of B."""
    if state.pinned is None:
        return Outcome(math.nan, False, "Pin the shaking motion as A again: start the lesson anew.")
    a, b = effective(state.pinned), state.preset
    if a.requirement.window != b.requirement.window:
        return Outcome(math.nan, False, "A and B must be judged over the same time window: put it back.")
    if not measures.mu(b):
        return Outcome(math.inf, False, "B excites nothing at all: it must be observable.")
    excitation, error = measures.mu(a) / measures.mu(b), measures.sigma(a) / measures.sigma(b)
    if not excitation > EXCITATION:
        return Outcome(
            excitation,
            False,
            f"A has {short(excitation)} times the excitation of B, and {short(error)} times its error: slow B down.",
        )
    if not error > ERROR:
        return Outcome(excitation, False, f"A's error is {short(error)} times that of B: B is too slow now.")
    return Outcome(
        excitation, True, f"A has {short(excitation)} times the excitation, and {short(error)} times the error."
    )
