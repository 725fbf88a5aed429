"""Knots: the times at which a derivative of a signal may jump, and what the signal is between them.

Waypoints, minimum-snap curves and polynomials are one polynomial between neighbouring knots. Tones and formulas have no
knots. A Sum has the knots of both parts.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import piecewise
from rangenav.signals.families import Signal
from rangenav.signals.piecewise import Pieces

SAME = 1e-11
"""s: knots nearer than this are the same knot, apart by rounding; both parts of a sum may have it."""


def pieces(signal: Signal) -> Iterator[Pieces]:
    """The piecewise polynomials that a signal is made of: none, one, or in a Sum two."""
    return (polynomials for polynomials in (part.piecewise() for part in signal.parts()) if polynomials is not None)


def has_pieces(signal: Signal) -> bool:
    """Whether any part is made of pieces."""
    return any(True for _ in pieces(signal))


def knots(signal: Signal, first: float, last: float) -> Float[Array, "k"]:
    """All knots strictly between two times (s), repetitions included, in increasing order."""
    times = np.sort(np.concatenate([np.zeros(0), *(piecewise.knots_between(p, first, last) for p in pieces(signal))]))
    return times[np.diff(times, prepend=-np.inf) > SAME]


def most(signal: Signal, length: float) -> float:
    """An upper bound on the number of knots in a stretch of `length` seconds, known before they are computed."""
    return sum(piecewise.most_knots_between(p, length) for p in pieces(signal))


def degree(signal: Signal) -> int:
    """The degree of the polynomials between knots; 0 if there are none."""
    return max((len(p.tables) - 1 for p in pieces(signal)), default=0)


def smooth_bandwidth(signal: Signal, time: float) -> float:
    """The highest frequency (rad/s), from 0 to a time (s), of the parts that are smooth; 0 if all parts have knots."""
    return max((part.bandwidth_until(time) for part in signal.parts() if part.piecewise() is None), default=0.0)


def bounds_between(signal: Signal, order: int, time: Float[Array, "n"]) -> Float[Array, "n"]:
    """Bounds on a derivative's norm (order 2 or more) from each time (s) to the knots before and after it."""
    bounds = np.zeros(len(time))
    for part in signal.parts():
        polynomials = part.piecewise()
        bounds += part.bound(order) if polynomials is None else piecewise.hulls(polynomials, order, time)
    return bounds
