"""Whether functions that do not count are dependent, or only below rounding: rank by analytic continuation.

Between knots a path is analytic, and so are its 13 functions. A relation among them that holds on one interval holds as
far as the next knot, and another start only mixes the functions. So the rank is the same on every window of a piece,
and that of a window is at least that of each piece in it. A computed rank counts no rounding: it is never too large.
"""

from dataclasses import replace

import numpy as np

from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.observability import spectrum
from rangenav.results import result
from rangenav.signals import Signal, knots

DOUBLINGS = 12
"""Of the window's length, at most."""
MOST_KNOTS, MOST_PIECES = 1000, 8
"""Of a flight whose pieces are looked at, and of a window."""


@result
class Continued:
    """The largest rank that is known of a window's 13 functions."""

    rank: int
    window: float
    """s, the length from the window's start on which the functions were compared: the relations found there hold on
    the window, too. The window's own where no longer one has a larger rank."""
    resolved: bool
    """Whether a longer stretch of the same piece has shown the rank, or it is 13. Of a window with a knot inside, and
    of a path that is too much work, a lower rank may be rounding."""


def continued(path: Signal, gravity: Vec3, start: float, window: float, until: float, rank: int) -> Continued:
    """The largest rank of a window (s) that is known from the pieces it lies in, as far as a time (s).

    rank: of the window itself, as computed.
    """
    until = max(until, start + window)
    best = Continued(rank=rank, window=window, resolved=rank == STATES)
    if rank == STATES or knots.most(path, until) > MOST_KNOTS:
        return best
    edges = np.concatenate([[0.0], knots.knots(path, 0.0, until), [until]])
    first = max(0, int(np.searchsorted(edges, start, side="right")) - 1)
    if start + window <= edges[first + 1] + knots.SAME:  # in one piece; without knots it goes on for ever
        end = start + until if len(edges) == 2 else float(edges[first + 1])
        for length in _lengths(window, end - start):
            longer = _rank(path, gravity, start, length)
            if longer > best.rank:
                best = Continued(rank=longer, window=length, resolved=True)
            elif longer > 0:
                best = replace(best, resolved=True)
            if best.rank == STATES:
                return best
    last = int(np.searchsorted(edges, start + window - knots.SAME))
    for begin, end in zip(edges[first:last][:MOST_PIECES], edges[first + 1 : last + 1][:MOST_PIECES], strict=True):
        if _rank(path, gravity, float(begin), float(end - begin)) == STATES:
            return Continued(rank=STATES, window=window, resolved=True)
    return best


def _lengths(window: float, longest: float) -> list[float]:
    """Doubled lengths, and the longest one."""
    doubled = [window * 2.0**k for k in range(1, DOUBLINGS + 1)]
    return [*(length for length in doubled if length < longest), longest]


def _rank(path: Signal, gravity: Vec3, start: float, window: float) -> int:
    """0 where it is too much work, or where a formula has no value."""
    try:
        return int(spectrum.window_spectra(path, gravity, np.array([start]), window).rank[0])
    except ValueError:
        return 0
