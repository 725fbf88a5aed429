"""The window with the largest predicted σ of the position, among every window of a flight, and its accuracy.

Its ranges are those that the preset takes, at k/f from 0. A loop that is flown again and again has the same σ in each
round only if it holds a whole number of ranges; else the ranges of each round fall at other phases of the loop.
"""

import math
from functools import lru_cache

from rangenav.motion import World
from rangenav.observability import accuracy, every_range_window
from rangenav.observability.accuracy import FourAccuracies, HasAccuracies
from rangenav.observability.every_range_window import RangeWindows
from rangenav.observability.worst_excitation import EVERY, FLIGHT, Starts
from rangenav.results import result
from rangenav.signals import Signal

CACHED = 8
WHOLE = 1e-9
"""Relative; a loop's number of ranges that is so near a whole number is one, for the loop's length is rounded."""


@result
class WorstAccuracy(HasAccuracies):
    """The accuracy of the window whose lifted position σ at its end is the largest of all windows."""

    starts: Starts
    reason: str | None
    """Why not at every t ≥ 0; None if it is."""
    windows: RangeWindows
    accuracies: FourAccuracies


@lru_cache(maxsize=CACHED)
def worst_accuracy(
    path: Signal,
    world: World,
    duration: float,
    window: float,
    *,
    sigma: float,
    rate: float,
    share: float = 1.0,
    compiled: bool = False,
) -> WorstAccuracy:
    """The worst window of a flight (s), from ranges of noise sigma (m) at `rate` (Hz) of which a share arrives.

    compiled: see `joined_triangles`. Raises ValueError as `every_range_window.worst` does.
    """
    found = every_range_window.worst(
        path, world, duration, window, sigma=sigma, rate=rate, share=share, compiled=compiled
    )
    of = accuracy.of_held(
        path, world, found.at, window, first=found.first, last=found.last, rate=rate, sigma=sigma, share=share
    )
    starts, reason = _claimed(path, duration - window, rate)
    return WorstAccuracy(starts=starts, reason=reason, windows=found, accuracies=of)


def _claimed(path: Signal, last: float, rate: float) -> tuple[Starts, str | None]:
    """Whether every window of the flight is every window at all: the flight then has each phase of the loop."""
    period = path.period
    if period is None:
        return FLIGHT, "the path does not repeat"
    if not math.isfinite(path.bound(0)):
        return FLIGHT, "the path drifts, and with it the noise of its squared ranges changes"
    held = period * rate
    if period and abs(held - round(held)) > WHOLE * held:
        return FLIGHT, f"a loop of {period:.4g} s holds {held:.6g} ranges, so in later rounds they fall at other phases"
    if period > last:
        return FLIGHT, f"the flight has no window from each phase of its loop of {period:.4g} s"
    return EVERY, None
