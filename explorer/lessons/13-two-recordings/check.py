"""Passed when the recording that converges is named, and the number that decides it."""

from explorer.lessons import Outcome, State

RIGHT = {"converges": "recording 2", "number": "the excitation μ"}


def check(state: State) -> Outcome:
    """The metric is how many answers are right."""
    right = sum(state.answers.get(name) == answer for name, answer in RIGHT.items())
    if len(state.answers) < len(RIGHT):
        return Outcome(right, False, "Answer both questions.")
    if right < len(RIGHT):
        return Outcome(right, False, f"{right} of {len(RIGHT)} are right.")
    return Outcome(right, True, "Both are right.")
