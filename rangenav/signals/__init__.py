"""Signals in R³ whose every derivative comes from one call, `signal(t, order)`: families, and edits of them.

A signal is a value: frozen, hashable, a tagged table in a file. `base.SignalBase` says what the library asks of it:
    signal(t, order)         the derivative at times t, exact and not differenced
    signal.jet(t, k)         the derivatives 0 to k in one pass
    signal.bandwidth         rad/s, for the panels of a quadrature; `bandwidth_until` where there is none for all time
    signal.bound(order)      a bound of the derivative's norm at every t ≥ 0, no sample; infinite if none is known
    signal.period            s after which all but a straight line repeats; 0 if there is only a line, None if never
    curved_part(signal)      the signal without its straight part
"""

from rangenav.signals.checks import refuse_fallen, refuse_wild, refuse_work
from rangenav.signals.edits import (
    centred,
    curved_part,
    mirrored,
    moved,
    rotated,
    scaled,
    slowed,
    with_start,
)
from rangenav.signals.families import Family, Signal, Sum
from rangenav.signals.formula import Formula
from rangenav.signals.multirotor import Attitude, Flown
from rangenav.signals.multisine import AXES, Multisine, Tone
from rangenav.signals.polynomials import Piece, Polynomials
from rangenav.signals.waypoints import MinimumSnap, Waypoint, Waypoints

AngularVelocity = Signal | Flown
"""What an angular velocity may be: a signal of its own, or what flying the path takes."""

__all__ = [
    "AXES",
    "AngularVelocity",
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
    "Waypoint",
    "Waypoints",
    "centred",
    "curved_part",
    "mirrored",
    "moved",
    "refuse_fallen",
    "refuse_wild",
    "refuse_work",
    "rotated",
    "scaled",
    "slowed",
    "with_start",
]
