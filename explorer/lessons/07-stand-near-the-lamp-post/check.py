"""Passed when the anchor alone has brought the position error of one window below 0.2 m."""

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from rangenav import preset

SIGMA, CLEARANCE = 0.2, 0.3
"""m"""
PRESET = "soft"


def check(state: State) -> Outcome:
    """The metric is the position error of one window (m)."""
    p, before = state.preset, preset.load(PRESET)
    sigma, clearance = measures.sigma(p), measures.anchor_distance(p)
    if (p.path, p.duration) != (before.path, before.duration):
        return Outcome(sigma, False, "The path has changed. Only the anchor may move.")
    if p.sensors != before.sensors or p.requirement.window != before.requirement.window:
        return Outcome(sigma, False, "The sensors or the window have changed. Only the anchor may move.")
    if clearance < CLEARANCE:
        return Outcome(sigma, False, f"The path passes the anchor at {short(clearance, 'm')}: 0.3 m is the least.")
    if sigma >= SIGMA:
        return Outcome(sigma, False, f"One window predicts the position to {short(sigma, 'm')}: move nearer.")
    return Outcome(sigma, True, f"One window predicts the position to {short(sigma, 'm')}, and μ is what it was.")
