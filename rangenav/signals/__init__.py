"""Signals in R³ whose every derivative comes from one call, `signal(t, order)`: families, and edits of them.

A signal is a value (frozen, hashable, a tagged table in a file) that the library asks six things:
    signal(t, order)     the derivative at times t, exact and not differenced
    signal.bandwidth     rad/s, for the panels of a quadrature; `bandwidth_until` where a formula has none for all time
    signal.bound(order)  a bound of the derivative's norm at every t ≥ 0, no sample; infinite if none is known
    signal.period        s after which all that bends repeats; 0 if nothing bends, None if it does not repeat
    bent(signal)         the signal without its straight part
    jet(signal, t, k)    the derivatives 0 to k in one pass
"""

from rangenav.signals.checks import operations, refuse_fallen, refuse_wild, refuse_work
from rangenav.signals.edits import (
    bent,
    centred,
    mapped,
    mirrored,
    moved,
    rotated,
    scaled,
    slowed,
    started_at,
)
from rangenav.signals.families import Family, Signal, Sum, bandwidth_until
from rangenav.signals.formula import Formula
from rangenav.signals.jets import jet
from rangenav.signals.multirotor import Attitude, Flown
from rangenav.signals.multisine import AXES, Multisine, Tone
from rangenav.signals.polynomials import Piece, Polynomials
from rangenav.signals.waypoints import MinimumSnap, Waypoint, Waypoints

Turning = Signal | Flown
"""What an angular velocity may be: a signal of its own, or what flying the path takes."""

__all__ = [
    "AXES",
    "Attitude",
    "Family",
    "Flown",
    "Formula",
    "MinimumSnap",
    "Multisine",
    "Piece",
    "Polynomials",
    "Signal",
    "Sum",
    "Tone",
    "Turning",
    "Waypoint",
    "Waypoints",
    "bandwidth_until",
    "bent",
    "centred",
    "jet",
    "mapped",
    "mirrored",
    "moved",
    "operations",
    "refuse_fallen",
    "refuse_wild",
    "refuse_work",
    "rotated",
    "scaled",
    "slowed",
    "started_at",
]
