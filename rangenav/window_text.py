"""How sentences name windows: all of which something is said, and the one that is the worst.

A path that repeats may be judged at every t ≥ 0, and its worst window then lies in a round that is not flown.
"""

from rangenav.number_format import quantity
from rangenav.observability.worst_excitation import EVERY, Starts

LATE = 1e-9
"""Relative: a start that is so little past the last one is the last one."""


def of_flight(window: float, duration: float) -> str:
    """6 s of this 20 s flight."""
    return f"{quantity(window, 's')} of this {quantity(duration, 's')} flight"


def every(window: float, duration: float, starts: Starts) -> str:
    """All windows of a length (s) that start as `starts` says, in a flight (s)."""
    if starts == EVERY:
        return f"every window of {quantity(window, 's')} at every t ≥ 0"
    return f"every window of {of_flight(window, duration)}"


def none(window: float, duration: float, starts: Starts) -> str:
    """The same, of what no window is or has."""
    if starts == EVERY:
        return f"no window of {quantity(window, 's')} at any t ≥ 0"
    return f"no window of {of_flight(window, duration)}"


def later_round(start: float, window: float, duration: float) -> str:
    """A clause on a window (s) that the flight (s) does not have; empty for one that it has."""
    beyond = start > (duration - window) + LATE * duration
    return ", in a later round than this flight's" if beyond else ""


def one(start: float, window: float, duration: float) -> str:
    """The 6 s from t = 0.84 s; with the clause where the flight has no such window."""
    return f"the {quantity(window, 's')} from t = {start:.4g} s{later_round(start, window, duration)}"
