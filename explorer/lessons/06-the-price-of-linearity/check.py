"""Passed when the linear model predicts the position to half a metre, with at most ten centimetres of height."""

import math
from pathlib import Path

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from explorer.lessons.state import read

SIGMA, TRUE_SIGMA, SWING = 0.5, 0.2, 0.1
"""m"""
ROUNDING = 1e-6
"""m: the height is computed from samples."""
START = read(Path(__file__).with_name("start.toml")).preset


def check(state: State) -> Outcome:
    """The metric is the position error of one window (m), linear model."""
    p = state.preset
    sigma, true_sigma, swing = measures.sigma(p), measures.sigma_nonlinear(p), measures.swing(p)
    other = measures.changed(p, START, "world", "sensors", "requirement", "duration")
    if other:
        return Outcome(sigma, False, other)
    if not math.isfinite(sigma):
        return Outcome(math.nan, False, f"The linear model is blind: {measures.rank(p)} of 13 quantities.")
    if swing > SWING + ROUNDING:
        return Outcome(sigma, False, f"The height swings by {short(swing, 'm')} to each side: 0.1 m is the most.")
    if not true_sigma < TRUE_SIGMA:
        return Outcome(sigma, False, "The true model must predict the position to 0.2 m: stay near the anchor.")
    if not sigma < SIGMA:
        return Outcome(sigma, False, f"The linear model predicts the position to {short(sigma, 'm')}.")
    return Outcome(
        sigma, True, f"{short(sigma, 'm')} with the linear model, {short(true_sigma, 'm')} with the true one."
    )
