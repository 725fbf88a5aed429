"""Why the ranges of a window leave the position undetermined, although the 13 functions of its path are independent.

Ranges are at k/f. Fewer than 13 leave an unknown open. So do those on three places of the path or fewer, which lie in a
plane: with its normal n, n·D is 1, τ, τ² alone. Two reasons are left: between its ranges the path moves in a way that
they do not show (aliasing), or double precision is too coarse. Ranges of a sum of tones satisfy a linear recurrence, so
a relation among as many successive ranges as its order holds among all ranges: a longer window has it, too. Where the
ranges of a longer window determine the position, no such relation exists, and rounding remains.
"""

import math
from typing import Literal

from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import accuracy
from rangenav.signals import Signal, knots

Cause = Literal["too few", "same places", "alias", "rounding"]
"""too few: fewer than 13 ranges; same places: on fewer than four places of a path that repeats; alias: nor do the
ranges of longer windows determine the position; rounding: those do, or it is not known whether they do."""
PROVEN: tuple[Cause, ...] = ("too few", "same places")
"""Counted, not computed: these hold in exact arithmetic."""
LEAST_PLACES = 4
"""Three lie in a plane."""
SAME_PLACE = 11
"""Decimals of a round, to which two places of the path are compared; k/(f · period) is rounded to about 12."""
MOST_RANGES = 20_000
"""In the longest window that is looked at."""


def cause(
    path: Signal, world: World, *, window: float, first: int, last: int, rate: float, noise: float = 1.0
) -> Cause:
    """Why the ranges at first/rate to last/rate (Hz) in a window (s) do not determine the position of a path whose 13
    functions are independent on that window. noise: of a range, m.

    Of a path with knots a longer window has other pieces, and shows nothing of the ranges in the window.
    """
    count = last - first + 1
    if count < STATES:
        return "too few"
    if places(count, rate, path.period) < LEAST_PLACES:
        return "same places"
    if knots.has_pieces(path):
        return "rounding"
    length = 2 * window
    while length * rate <= MOST_RANGES:
        if _determined(path, world, first / rate, length, rate=rate, noise=noise):
            return "rounding"
        length *= 2
    return "alias"


def places(count: int, rate: float, period: float | None) -> int:
    """On how many places of a path so many successive ranges (Hz) fall; period: of the path, s, None if it has none."""
    if not period:
        return count
    return len({round(k / (rate * period) % 1.0, SAME_PLACE) % 1.0 for k in range(count)})


def _determined(path: Signal, world: World, start: float, window: float, *, rate: float, noise: float) -> bool:
    """True, too, where a formula has no value, so that nothing is known."""
    try:
        of = accuracy.predict(path, world, start, window, sigma=noise, rate=rate, kind="lifted", at="end")
    except ValueError:
        return True
    return not math.isnan(of.position)
