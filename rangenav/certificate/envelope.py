"""How large a path's derivatives can be on stretches of time, between its knots: bounds, not samples.

`signal.bound(order)` speaks of all t at once, and is infinite where a lower derivative jumps. Here the time axis is cut
at every knot, so that on each open stretch the signal is smooth and
    Multisine                       Σ|A|wᵏ per axis, whatever the stretch
    Waypoints, MinimumSnap,
    Polynomials                     the hull of the Bernstein coefficients of the piece that the stretch lies in
    Formula                         interval arithmetic on the stretch, also where nothing is known for all time
    Sum                             the sum of both
bounds |signal⁽ᵏ⁾|. What jumps at a knot (the snap of a minimum-snap curve does, at its ends) is no part of any stretch.
"""

import math
from functools import lru_cache
from typing import cast

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import (
    AXES,
    Formula,
    Multisine,
    Polynomials,
    Signal,
    Sum,
    bandwidth_until,
    expressions,
    piecewise,
    waypoints,
)
from rangenav.signals.intervals import Interval
from rangenav.signals.piecewise import Pieces
from rangenav.signals.series import variable
from rangenav.signals.waypoints import Timed

FORMULA_STRETCHES = 256
"""Stretches on which a formula is enclosed; intervals over a whole flight at once would say nothing."""
MAX_KNOTS = 20_000
"""Knots, repetitions included, that a statement is made over; a minute of pieces as short as they may be has more."""
ABOVE = 1 + 1e-12
"""What rounding in a bound's own arithmetic may take away is given back."""


class UnboundedError(ValueError):
    """Nothing bounds the derivatives; the sentence says why."""


def pieces_of(signal: Signal) -> Pieces | None:
    """The polynomials that a signal is made of, None if it is not made of polynomials."""
    match signal:
        case Timed():
            return waypoints.pieces(signal)
        case Polynomials():
            return _assembled(signal)
        case _:
            return None


def knots(signal: Signal, until: float) -> Float[Array, "k"]:
    """Every time in [0, until] (s) at which a derivative may jump. Raises UnboundedError if they are too many."""
    if isinstance(signal, Sum):
        return np.union1d(knots(signal.base, until), knots(signal.wiggle, until))
    found = pieces_of(signal)
    if found is None:
        return np.zeros(0)
    once = found.knots
    if found.repeats:
        first, last = -math.ceil(once[0] / found.duration), math.ceil((until - once[0]) / found.duration)
        if (last - first + 1) * len(once) > MAX_KNOTS:
            raise UnboundedError(f"more than {MAX_KNOTS} knots in {until:.4g} s")
        once = (once[None] + found.duration * np.arange(first, last + 1)[:, None]).ravel()
    return np.unique(once[(once >= 0) & (once <= until)])


def stretches(signal: Signal, until: float) -> Float[Array, "k"]:
    """The edges of stretches of [0, until] on each of which one number bounds a derivative well."""
    edges = np.union1d(knots(signal, until), [0.0, until])
    if has_formula(signal):
        edges = np.union1d(edges, np.linspace(0, until, FORMULA_STRETCHES + 1))
    return edges


def turning(signal: Signal, until: float) -> float:
    """The highest frequency (rad/s) of all parts up to a time but the polynomial ones, whose cells are their pieces."""
    if isinstance(signal, Sum):
        return max(turning(signal.base, until), turning(signal.wiggle, until))
    return 0.0 if isinstance(signal, Timed | Polynomials) else bandwidth_until(signal, until)


def has_formula(signal: Signal) -> bool:
    """Whether any part is a formula."""
    if isinstance(signal, Sum):
        return has_formula(signal.base) or has_formula(signal.wiggle)
    return isinstance(signal, Formula)


def envelope(signal: Signal, edges: Float[Array, "k"], orders: range) -> Float[Array, "o m"]:
    """Bounds of |signal⁽ᵏ⁾| on the open stretches between neighbouring edges, for each order k ≥ 2 of the range.

    No knot may lie inside a stretch. Infinite where nothing is known.
    """
    low, high = edges[:-1], edges[1:]
    match signal:
        case Multisine():
            constant = np.array([signal.bound(order) for order in orders]) * ABOVE
            return np.repeat(constant[:, None], len(low), axis=1)
        case Formula():
            return _enclosed(signal, low, high, orders)
        case Sum():
            return envelope(signal.base, edges, orders) + envelope(signal.wiggle, edges, orders)
        case _:
            return _hulls(cast(Pieces, pieces_of(signal)), (low + high) / 2, orders)


def _hulls(found: Pieces, middle: Float[Array, "m"], orders: range) -> Float[Array, "o m"]:
    """A polynomial on its piece lies in the hull of its Bernstein coefficients; outside all pieces it stands still."""
    first, last = found.knots[0], found.knots[-1]
    time = first + np.mod(middle - first, last - first) if found.repeats else middle
    piece = np.clip(np.searchsorted(found.knots, time, side="right") - 1, 0, len(found.knots) - 2)
    still = (time < first) | (time > last)
    sizes = np.zeros((len(orders), len(middle)))
    for row, order in enumerate(orders):
        if order < len(found.tables):
            hull = np.linalg.norm(piecewise.bernstein(found.tables[order], np.diff(found.knots)), axis=-1).max(axis=0)
            sizes[row] = np.where(still, 0.0, hull[piece] * ABOVE)
    return sizes


def _enclosed(signal: Formula, low: Array, high: Array, orders: range) -> Float[Array, "o m"]:
    """Each axis enclosed as a power series over intervals of t / slower; the mix adds their sizes."""
    highest = max(orders)
    time = Interval(low, high) / signal.slower
    sizes = np.zeros((len(orders), 3, len(low)))
    for axis, k in AXES.items():
        with np.errstate(all="ignore"):
            series = expressions.evaluate(expressions.parse(getattr(signal, axis)), variable(time), highest)
            for row, order in enumerate(orders):
                if order < len(series):
                    sizes[row, k] = _size(series[order]) * (math.factorial(order) / signal.slower**order)
    mix = np.abs(np.asarray(signal.mix))
    with np.errstate(invalid="ignore"):
        mixed = np.where(mix[:, :, None] > 0, mix[:, :, None] * sizes[:, None], 0.0).sum(axis=2)
    return np.linalg.norm(mixed, axis=1) * ABOVE


def _size(coefficient: object) -> Array | float:
    """The largest absolute value of an enclosure on each stretch; infinite if it is not known."""
    if not isinstance(coefficient, Interval):
        return abs(float(cast(float, coefficient)))
    largest = np.maximum(np.abs(coefficient.low), np.abs(coefficient.high))
    return np.where(np.isnan(largest), np.inf, largest)


@lru_cache(maxsize=16)
def _assembled(signal: Polynomials) -> Pieces:
    table = np.array([[piece.x, piece.y, piece.z] for piece in signal.pieces])  # (m, 3, 8)
    ends = np.concatenate([[0.0], np.cumsum([piece.duration for piece in signal.pieces])])
    return piecewise.pieces(ends, table.transpose(2, 0, 1), repeats=signal.ends == "repeat")
