"""Passed with an excitation of 100 m²/s⁷ over 6 s, below 2.5 m/s and below the acceleration of free fall."""

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short

WINDOW, MU = 6.0, 100.0
"""s, m²/s⁷"""
SPEED, ACCELERATION = 2.5, 9.81
"""m/s, m/s²"""


def check(state: State) -> Outcome:
    """The metric is the excitation (m²/s⁷)."""
    p = state.preset
    mu, limits = measures.mu(p), measures.limits(p)
    if p.requirement.window != WINDOW:
        return Outcome(mu, False, f"The window must be {WINDOW:g} s long, as at the start of the lesson.")
    if mu < MU:
        return Outcome(mu, False, f"The excitation is {short(mu, 'm²/s⁷')}: some direction has too little snap.")
    if limits.speed >= SPEED:
        return Outcome(mu, False, f"The drone is too fast: {short(limits.speed, 'm/s')}. Move less far or more slowly.")
    if limits.acceleration >= ACCELERATION:
        return Outcome(mu, False, f"The acceleration is too large: {short(limits.acceleration, 'm/s²')}.")
    return Outcome(mu, True, f"The excitation is {short(mu, 'm²/s⁷')} at {short(limits.speed, 'm/s')}.")
