"""How large a path's derivatives can be on stretches of time, between its knots: bounds, not samples.

`signal.bound(order)` speaks of all t at once, and is infinite where a lower derivative jumps. Here the time axis is cut
at every knot, so that on each open stretch the signal is smooth and `signal.derivative_bounds` bounds |signal⁽ᵏ⁾|:
    Multisine                       Σ|A|wᵏ per axis, whatever the stretch
    Waypoints, MinimumSnap,
    Polynomials                     the hull of the Bernstein coefficients of the piece that the stretch lies in
    Formula                         interval arithmetic on the stretch, also where nothing is known for all time
    Sum                             the sum of both
What jumps at a knot (the snap of a minimum-snap curve does, at its ends) is no part of any stretch.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import Signal, knots

MAX_KNOTS = 20_000
"""Most knots, with repetitions, over which a bound is computed; a minute of the shortest allowed pieces has more."""


class UnboundedDerivativeError(ValueError):
    """The derivatives have no known bound; the message says why."""


def knots_until(signal: Signal, until: float) -> Float[Array, "k"]:
    """Every time between 0 and until (s) at which a derivative may jump. Raises
    UnboundedDerivativeError if there are too many.
    """
    if knots.most(signal, until) > MAX_KNOTS:
        raise UnboundedDerivativeError(f"more than {MAX_KNOTS} knots in {until:.4g} s")
    return knots.knots(signal, 0.0, until)


def stretches(signal: Signal, until: float) -> Float[Array, "k"]:
    """Edges of intervals of [0, until] (s), short enough that one number bounds a derivative well on each."""
    equal = np.linspace(0, until, signal.bound_stretches + 1)
    return np.union1d(knots_until(signal, until), equal)
