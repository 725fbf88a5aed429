"""Edits of a whole signal: slowed, given another start, moved, scaled, rotated, mirrored, centred.

Pure functions signal → signal. The families of this package stay what they are: a rotated Multisine is a Multisine, a
mirrored path of waypoints keeps its waypoints, and a formula keeps its text. Only a start with another velocity makes a
Sum of a signal that has no drift of its own. A family that leaves an edit to its equivalent signal becomes that.
"""

import math
from functools import lru_cache

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3, require
from rangenav.signals.base import vector
from rangenav.signals.families import Signal, Sum
from rangenav.signals.formula import Formula
from rangenav.signals.multisine import Multisine

BOX_SAMPLES = 2001


def slowed(signal: Signal, factor: float) -> Signal:
    """The same geometry run `factor` times slower: s(t / factor). Its snap falls by factor⁻⁴, μ over a period by ⁻⁷."""
    require(math.isfinite(factor) and factor > 0, f"the time scale must be a positive number, got {factor}")
    return signal.slowed(factor)


def with_start(signal: Signal, *, position: Vec3, velocity: Vec3) -> Signal:
    """The signal plus the straight line that gives it this value and rate at t = 0; higher derivatives are kept."""
    if not isinstance(signal, Multisine | Formula | Sum):  # the others have no offset and drift of their own
        signal = Sum(base=signal, wiggle=Multisine())
    zero = np.zeros(())
    offset = np.asarray(signal.offset) + np.asarray(position) - signal(zero)
    drift = np.asarray(signal.drift) + np.asarray(velocity) - signal(zero, 1)
    return msgspec.structs.replace(signal, offset=vector(offset), drift=vector(drift))


@lru_cache(maxsize=64)
def curved_part(signal: Signal) -> Signal:
    """The signal without its straight part: all that second and higher derivatives know of it.

    A signal without offset and drift of its own is moved to begin at 0, so that far-off places cost no digits.
    """
    return signal.curved_part()


def moved(signal: Signal, shift: Vec3) -> Signal:
    """The signal plus a constant."""
    return signal.mapped(np.eye(3), np.asarray(shift))


def scaled(signal: Signal, factor: float, *, about: Vec3) -> Signal:
    """The path `factor` times as large; the point `about` stays where it is."""
    require(math.isfinite(factor) and factor != 0, f"the factor must be a number other than 0, got {factor}")
    return _about(signal, factor * np.eye(3), about)


def rotated(signal: Signal, rotation: Float[Array, "3 3"], *, about: Vec3) -> Signal:
    """The path rotated by a rotation matrix; the point `about` stays where it is."""
    return _about(signal, rotation, about)


def mirrored(signal: Signal, normal: Vec3, *, about: Vec3) -> Signal:
    """The path seen in a mirror with this normal, which contains the point `about`."""
    n = np.asarray(normal, dtype=float)
    require(bool(n @ n > 0), "a mirror's normal must not be zero")
    return _about(signal, np.eye(3) - 2 * np.outer(n, n) / (n @ n), about)


def centred(signal: Signal, point: Vec3, *, duration: float) -> Signal:
    """The path moved so that the middle of the box around it, from 0 to duration (s), lies at the point."""
    places = signal(np.linspace(0, duration, BOX_SAMPLES))
    return moved(signal, vector(np.asarray(point) - (places.min(axis=0) + places.max(axis=0)) / 2))


def _about(signal: Signal, matrix: Array, about: Vec3) -> Signal:
    return signal.mapped(matrix, np.asarray(about) - matrix @ np.asarray(about))
