"""Passed with an excitation of 100 m²/s⁷ over 6 s, below 2.5 m/s and below the acceleration of free fall."""

from pathlib import Path

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from explorer.lessons.state import read

MU = 100.0
"""m²/s⁷"""
SPEED, ACCELERATION = 2.5, 9.81
"""m/s, m/s²"""
START = read(Path(__file__).with_name("start.toml")).preset


def check(state: State) -> Outcome:
    """The metric is the excitation (m²/s⁷)."""
    p = state.preset
    mu, limits = measures.mu(p), measures.limits(p)
    other = measures.changed(p, START, "requirement")
    if other:
        return Outcome(mu, False, other)
    if mu < MU:
        return Outcome(mu, False, f"The excitation is {short(mu, 'm²/s⁷')}: some direction has too little snap.")
    if limits.speed >= SPEED:
        return Outcome(mu, False, f"The drone is too fast: {short(limits.speed, 'm/s')}. Move less far or more slowly.")
    if limits.acceleration >= ACCELERATION:
        return Outcome(mu, False, f"The acceleration is too large: {short(limits.acceleration, 'm/s²')}.")
    return Outcome(mu, True, f"The excitation is {short(mu, 'm²/s⁷')} at {short(limits.speed, 'm/s')}.")
