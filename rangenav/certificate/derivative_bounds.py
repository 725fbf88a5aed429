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
from typing import cast

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import AXES, Formula, Multisine, Signal, Sum, expressions, knots, piecewise
from rangenav.signals.intervals import Interval
from rangenav.signals.series import variable

FORMULA_STRETCHES = 256
"""Stretches on which a formula is enclosed; intervals over a whole flight at once would say nothing."""
MAX_KNOTS = 20_000
"""Knots, repetitions included, that a statement is made over; a minute of pieces as short as they may be has more."""
ABOVE = 1 + 1e-12
"""What rounding in a bound's own arithmetic may take away is given back."""


class UnboundedDerivativeError(ValueError):
    """Nothing bounds the derivatives; the sentence says why."""


def knots_until(signal: Signal, until: float) -> Float[Array, "k"]:
    """Every time between 0 and until (s) at which a derivative may jump. Raises UnboundedError if they are too many."""
    if knots.most(signal, until) > MAX_KNOTS:
        raise UnboundedDerivativeError(f"more than {MAX_KNOTS} knots in {until:.4g} s")
    return knots.knots(signal, 0.0, until)


def stretches(signal: Signal, until: float) -> Float[Array, "k"]:
    """The edges of stretches of [0, until] on each of which one number bounds a derivative well."""
    edges = np.union1d(knots_until(signal, until), [0.0, until])
    if has_formula(signal):
        edges = np.union1d(edges, np.linspace(0, until, FORMULA_STRETCHES + 1))
    return edges


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
            (found,) = knots.pieces(signal)
            return np.stack([piecewise.hulls(found, order, (low + high) / 2) for order in orders]) * ABOVE


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
