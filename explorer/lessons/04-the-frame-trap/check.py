"""Passed when the printed condition certifies a motion without any excitation."""

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short

PRINTED, NOTHING = 500.0, 1e-6
"""m²/s⁷"""


def check(state: State) -> Outcome:
    """The metric is the excitation as printed (m²/s⁷)."""
    printed, derived = measures.mu_printed(state.preset), measures.mu(state.preset)
    if derived >= NOTHING:
        return Outcome(printed, False, f"The path itself excites: {short(derived, 'm²/s⁷')}. Put the circle back.")
    if printed <= PRINTED:
        return Outcome(printed, False, f"The printed condition reads {short(printed, 'm²/s⁷')}: tumble more.")
    return Outcome(printed, True, f"The printed condition reads {short(printed, 'm²/s⁷')} for a motion that is blind.")
