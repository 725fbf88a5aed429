"""The families of signals, and the Sum of two of them: a base path and a wiggle on it."""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Input, Vec3, require_within
from rangenav.signals.formula import Formula
from rangenav.signals.multisine import MAX_DRIFT, MAX_OFFSET, Multisine, common_period
from rangenav.signals.polynomials import Polynomials
from rangenav.signals.waypoints import MinimumSnap, Waypoints

Family = Multisine | Formula | Waypoints | MinimumSnap | Polynomials
"""Signals that are not sums; angular velocities may be of any family, a constant one is a Multisine's offset."""


class Sum(Input, frozen=True, kw_only=True, tag="sum", tag_field="kind", omit_defaults=True, cache_hash=True):
    """base + wiggle + offset + drift t."""

    base: Family
    wiggle: Family
    offset: Vec3 = (0.0, 0.0, 0.0)
    """In the signal's unit."""
    drift: Vec3 = (0.0, 0.0, 0.0)
    """The signal's unit per second."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, limit in (("offset", MAX_OFFSET), ("drift", MAX_DRIFT)):
            for value in getattr(self, name):
                require_within(name, value, -limit, limit)

    def __call__(self, t: Float[Array, "*n"], order: int = 0) -> Float[Array, "*n 3"]:
        """The derivative of the given order at times t (s)."""
        t = np.asarray(t, dtype=float)
        value = self.base(t, order) + self.wiggle(t, order)
        if order == 0:
            value += np.asarray(self.offset) + t[..., None] * np.asarray(self.drift)
        elif order == 1:
            value += np.asarray(self.drift)
        return value

    @property
    def bandwidth(self) -> float:
        """The higher one of both parts (rad/s)."""
        return max(self.base.bandwidth, self.wiggle.bandwidth)

    def bound(self, order: int) -> float:
        """The sum of both parts' bounds."""
        if order == 0 and any(self.drift):
            return math.inf
        straight = {0: self.offset, 1: self.drift}.get(order, (0.0, 0.0, 0.0))
        return self.base.bound(order) + self.wiggle.bound(order) + float(np.linalg.norm(straight))

    @property
    def period(self) -> float | None:
        """The common period (s) of both parts, 0 if nothing bends, None if there is none."""
        periods = self.base.period, self.wiggle.period
        if None in periods:
            return None
        return common_period([2 * math.pi / period for period in periods if period])


Signal = Family | Sum
"""Every family of signals in R³: a tagged union, told apart in a file by `kind`."""


def bandwidth_until(signal: Signal, time: float) -> float:
    """The highest frequency present (rad/s) from 0 to a time (s): finite even for a chirp, which has none for all t."""
    match signal:
        case Formula():
            return signal.bandwidth_until(time)
        case Sum():
            return max(bandwidth_until(signal.base, time), bandwidth_until(signal.wiggle, time))
        case _:
            return signal.bandwidth
