"""Passed when the flight meets its requirement on every window, the vehicle can fly it, and its file is exported."""

from pathlib import Path

from explorer.lessons import Outcome, State, measures
from explorer.lessons.state import read

CHANGE = 0.05
"""The share by which the excitation of the file may differ from that of the flight."""
START = read(Path(__file__).with_name("start.toml")).preset


def check(state: State) -> Outcome:
    """The metric is how many of the three steps are done."""
    p = state.preset
    other = measures.changed(p, START, "world", "sensors", "vehicle")
    if other:
        return Outcome(0, False, other)
    missed, broken, mu = measures.misses(p), measures.broken(p), measures.mu(p)
    file_mu = measures.file_mu(state)
    exported = bool(mu) and file_mu is not None and abs(file_mu - mu) <= CHANGE * mu
    done = (not missed) + (not broken) + exported
    missing = [name for name in missed if name != "vehicle"]  # which limit it is, the next sentence says
    steps = {"certified": not missed, "flyable": not broken, "exported": exported}
    marks = ", ".join(f"{'✓' if is_done else '✗'} {step}" for step, is_done in steps.items())
    if missing:
        return Outcome(done, False, f"{marks}. What a certificate lacks: {', '.join(missing)}.")
    if broken:
        return Outcome(done, False, f"{marks}. The vehicle cannot fly it: {broken[0].summary}.")
    if not exported:
        return Outcome(done, False, f"{marks}. Now export this flight as polynomials.")
    return Outcome(done, True, "Certified, flyable, and exported.")
