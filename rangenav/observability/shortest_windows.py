"""How long must a window be, so that the ranges it really holds determine the position to a required accuracy?

σ(L), the largest predicted σ over every window of length L, does not rise with L: a longer window holds a shorter one
with the same end, and so no less information on the position there. Bisection therefore finds the shortest L. The
window from the start has another end for each length, and may get worse again: its L is that from which on it holds.
"""

import math
from collections.abc import Callable

import numpy as np

from rangenav.inputs import require
from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import accuracy, every_range_window
from rangenav.results import result
from rangenav.signals import Signal

LENGTHS = 40
"""Lengths, in equal ratios, at which the window from the start is tried."""
PRECISION = 1.01
"""The ratio of a length that suffices to one that does not."""
ROUNDING = 1e-9
"""Of a number of ranges."""


@result
class ShortestWindows:
    """The shortest windows (s) whose predicted 1-σ position at the end is within a requirement."""

    from_start: float | None
    """Windows from time 0 that are no shorter hold it, up to the whole flight; None if the whole flight does not."""
    every: float | None
    """Every window of this length, wherever it starts in the flight, holds it."""


def shortest_windows(
    path: Signal,
    world: World,
    duration: float,
    *,
    sigma: float,
    rate: float,
    position_sigma: float,
    share: float = 1.0,
) -> ShortestWindows:
    """The shortest windows of a flight (s) with ranges of noise sigma (m) at k/rate (Hz) for a required σ (m).

    `share` is the share of the ranges that arrive. Raises ValueError for a rate that is not positive.
    """
    require(rate > 0, f"rate must be positive, got {rate:g} Hz")

    def first_holds(length: float) -> bool:
        last = math.floor(length * rate + ROUNDING)
        if last + 1 < STATES:
            return False
        of = accuracy.of_held(path, world, 0.0, length, first=0, last=last, rate=rate, sigma=sigma, share=share)
        return of.lifted_end.position <= position_sigma

    def every_holds(length: float) -> bool:
        found = every_range_window.worst(path, world, duration, length, sigma=sigma, rate=rate, share=share)
        return found.bound <= position_sigma

    least = min(first_length(rate), duration)
    if not every_holds(duration):
        return ShortestWindows(from_start=None, every=None)
    every = _bisected(every_holds, least, duration)
    lengths = np.geomspace(least, every, LENGTHS).tolist()
    fails = next((length for length in reversed(lengths) if not first_holds(length)), None)
    if fails is None:
        return ShortestWindows(from_start=lengths[0], every=every)
    works = next((length for length in lengths if length > fails), every)
    return ShortestWindows(from_start=_bisected(first_holds, fails, works), every=every)


def first_length(rate: float) -> float:
    """The length (s) of the first window that holds 13 ranges, if these come at k/rate (Hz) from its start."""
    return (STATES - 1) / rate


def every_length(rate: float) -> float:
    """The length (s) from which on every window holds 13 ranges."""
    return STATES / rate


def _bisected(holds: Callable[[float], bool], fails: float, works: float) -> float:
    """A length that suffices, no more than PRECISION times one that does not; `fails` is not tried."""
    while works > PRECISION * fails:
        middle = math.sqrt(fails * works)
        fails, works = (fails, middle) if holds(middle) else (middle, works)
    return works
