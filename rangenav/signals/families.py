"""The families of signals, and the Sum of two of them: a base path and a wiggle on it."""

import math

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3, require_within
from rangenav.signals.base import SignalBase, add_line, divided, vector
from rangenav.signals.formula import Formula
from rangenav.signals.multisine import MAX_DRIFT, MAX_OFFSET, Multisine, common_period
from rangenav.signals.polynomials import Polynomials
from rangenav.signals.waypoints import MinimumSnap, Waypoints

Family = Multisine | Formula | Waypoints | MinimumSnap | Polynomials
"""Signals that are not sums: a new family is one more here. Angular velocities may be of any family, too."""


class Sum(SignalBase, frozen=True, kw_only=True, tag="sum", tag_field="kind", omit_defaults=True, cache_hash=True):
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
        return self.base.bound(order) + self.wiggle.bound(order) + math.hypot(*straight)

    @property
    def period(self) -> float | None:
        """The common period (s) of both parts, 0 if nothing bends, None if there is none."""
        periods = self.base.period, self.wiggle.period
        if None in periods:
            return None
        return common_period([2 * math.pi / period for period in periods if period])

    def parts(self) -> tuple[Family, ...]:
        """The base and the wiggle."""
        return self.base, self.wiggle

    @property
    def bound_stretches(self) -> int:
        """As many as the part that wants more."""
        return max(part.bound_stretches for part in self.parts())

    def bandwidth_until(self, time: float) -> float:
        """The higher one of both parts (rad/s)."""
        return max(part.bandwidth_until(time) for part in self.parts())

    def derivative_bounds(self, edges: Float[Array, "k"], orders: range) -> Float[Array, "o m"]:
        """The sum of both parts' bounds."""
        return self.base.derivative_bounds(edges, orders) + self.wiggle.derivative_bounds(edges, orders)

    def rounding_bound(self, edges: Float[Array, "k"]) -> float:
        """Of both parts, and of adding them and the straight line."""
        latest = float(np.abs(edges[[0, -1]]).max())
        straight = math.hypot(*self.offset) + latest * math.hypot(*self.drift)
        largest = float(self.derivative_bounds(edges, range(1)).max())
        return sum(part.rounding_bound(edges) for part in self.parts()) + largest + 2 * straight

    def jet(self, t: Float[Array, "n"], highest: int) -> Float[Array, "o n 3"]:
        """The signal and its derivatives up to the highest order (1 at least) at times t (s)."""
        every = self.base.jet(t, highest) + self.wiggle.jet(t, highest)
        add_line(every, t, offset=self.offset, drift=self.drift)
        return every

    def operations(self) -> int:
        """The operations of both parts."""
        return sum(part.operations() for part in self.parts())

    def slowed(self, factor: float) -> "Sum":
        """The signal s(t / factor)."""
        base, wiggle = self.base.slowed(factor), self.wiggle.slowed(factor)
        return msgspec.structs.replace(self, base=base, wiggle=wiggle, drift=divided(self.drift, factor))

    def mapped(self, matrix: Float[Array, "3 3"], shift: Float[Array, "3"]) -> "Sum":
        """matrix · signal + shift."""
        base, wiggle = self.base.mapped(matrix, np.zeros(3)), self.wiggle.mapped(matrix, np.zeros(3))
        offset, drift = vector(matrix @ self.offset + shift), vector(matrix @ self.drift)
        return msgspec.structs.replace(self, base=base, wiggle=wiggle, offset=offset, drift=drift)

    def curved_part(self) -> "Sum":
        """The sum of both parts without their straight parts."""
        return Sum(base=self.base.curved_part(), wiggle=self.wiggle.curved_part())


Signal = Family | Sum
"""Every family of signals in R³: a tagged union, distinguished in a file by `kind`."""
