"""A signal together with its derivatives, in one pass: what the derivatives of one signal share is found once.

tones      A wᵏ sin(w t + phase + kπ/2): one sine and one cosine for all k
pieces     one search for the piece, and each polynomial developed anew about each time
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import knots, piecewise
from rangenav.signals.families import Signal, Sum
from rangenav.signals.multisine import AXES, Multisine
from rangenav.signals.polynomials import Polynomials
from rangenav.signals.waypoints import MinimumSnap, Waypoints


def jet(signal: Signal, t: Float[Array, "n"], highest: int) -> Float[Array, "o n 3"]:
    """The signal and its derivatives up to the highest order (1 at least) at times t (s)."""
    match signal:
        case Multisine():
            return _tones(signal, t, highest)
        case Waypoints() | MinimumSnap() | Polynomials():
            (found,) = knots.pieces(signal)
            return piecewise.jet(found, t, highest)
        case Sum():
            every = jet(signal.base, t, highest) + jet(signal.wiggle, t, highest)
            _add_line(every, t, signal)
            return every
        case _:
            return np.stack([signal(t, order) for order in range(highest + 1)])


def _tones(signal: Multisine, t: Array, highest: int) -> Array:
    every = np.zeros((highest + 1, len(t), 3))
    _add_line(every, t, signal)
    for tone in signal.tones:
        angle = tone.frequency * t + tone.phase
        waves = np.sin(angle), np.cos(angle)
        for order in range(highest + 1):
            sign = -1.0 if order % 4 > 1 else 1.0  # sin, cos, −sin, −cos, and round again
            every[order, :, AXES[tone.axis]] += sign * tone.amplitude * tone.frequency**order * waves[order % 2]
    return every


def _add_line(every: Array, t: Array, signal: Multisine | Sum) -> None:
    """The straight part, which orders from 2 on do not have."""
    every[0] += np.asarray(signal.offset) + t[:, None] * np.asarray(signal.drift)
    every[1] += np.asarray(signal.drift)
