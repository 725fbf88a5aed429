"""Passed when the fault of each record is named."""

from explorer.lessons import Outcome, State

FAULTS = {"record_1": "a gyro bias", "record_2": "the printed model", "record_3": "a range bias"}


def check(state: State) -> Outcome:
    """The metric is how many faults are named."""
    named = sum(state.answers.get(record) == fault for record, fault in FAULTS.items())
    if len(state.answers) < len(FAULTS):
        return Outcome(named, False, "Name the fault of every record.")
    if named < len(FAULTS):
        return Outcome(named, False, f"{named} of {len(FAULTS)} are right.")
    return Outcome(named, True, "All three faults are named.")
