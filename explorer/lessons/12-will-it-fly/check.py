"""Passed when the vehicle can fly the path, a window is accurate, and the exported file is as exciting as the path."""

from pathlib import Path

from explorer.lessons import Outcome, State, measures
from explorer.lessons.figures import short
from explorer.lessons.state import read

SIGMA, CHANGE = 0.15, 0.05
"""m, and the share by which the excitation of the file may differ."""
START = read(Path(__file__).with_name("start.toml")).preset


def check(state: State) -> Outcome:
    """The metric is the largest thrust over the weight."""
    p = state.preset
    thrust, sigma, mu = measures.limits(p).thrust_to_weight, measures.sigma(p), measures.mu(p)
    other = measures.changed(p, START, "world", "sensors", "requirement", "vehicle")
    if other:
        return Outcome(thrust, False, other)
    broken = measures.broken(p)
    if broken:
        return Outcome(thrust, False, f"The vehicle cannot fly it: {broken[0].summary}.")
    if not sigma < SIGMA:
        return Outcome(thrust, False, f"One window predicts the position to {short(sigma, 'm')} only: fly faster.")
    file_mu = measures.file_mu(state)
    if file_mu is None:
        return Outcome(thrust, False, "Now export it as polynomials.")
    if not abs(file_mu - mu) <= CHANGE * mu:
        return Outcome(
            thrust, False, f"The file has {short(file_mu, 'm²/s⁷')}, the path {short(mu, 'm²/s⁷')}: export again."
        )
    return Outcome(thrust, True, f"It flies, and its file has {short(file_mu, 'm²/s⁷')}.")
