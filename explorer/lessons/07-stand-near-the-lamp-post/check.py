"""Passed when the anchor alone has brought the position error of one window below 0.2 m."""

from pathlib import Path

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from explorer.lessons.state import read

SIGMA, CLEARANCE = 0.2, 0.3
"""m"""
START = read(Path(__file__).with_name("start.toml")).preset


def check(state: State) -> Outcome:
    """The metric is the position error of one window (m)."""
    p = state.preset
    sigma, clearance = measures.sigma(p), measures.anchor_distance(p)
    other = measures.changed(p, START, "path", "duration", "sensors", "requirement")
    if other:
        return Outcome(sigma, False, other)
    if clearance < CLEARANCE:
        return Outcome(sigma, False, f"The path passes the anchor at {short(clearance, 'm')}: 0.3 m is the least.")
    if sigma >= SIGMA:
        return Outcome(sigma, False, f"One window predicts the position to {short(sigma, 'm')}: move nearer.")
    return Outcome(sigma, True, f"One window predicts the position to {short(sigma, 'm')}, and μ is what it was.")
