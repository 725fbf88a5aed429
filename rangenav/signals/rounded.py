"""Numbers with a bound of their rounding: what an expression computes in double precision is that near to its value.

Each operation adds what its arguments' errors become and its own rounding, ε of the result at most:
    a + b: e_a + e_b      a b: |a| e_b + |b| e_a + e_a e_b      f(a): max|f′| e_a      each + ε |result|
The values are intervals, so the bound holds over stretches of time and not at samples.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals.intervals import PADDING, TINIEST, Interval

EPSILON = float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class Rounded:
    """An enclosure of a value over stretches of time, and a bound of the error of the computed value."""

    value: Interval
    error: Float[Array, "*n"]

    __array_ufunc__ = None
    """numpy leaves `array × rounded` to the rounded number."""

    def __add__(self, other: Any) -> "Rounded":
        other = of(other)
        return _with(self.value + other.value, self.error + other.error)

    def __neg__(self) -> "Rounded":
        return Rounded(-self.value, self.error)

    def __sub__(self, other: Any) -> "Rounded":
        return self + (-of(other))

    def __rsub__(self, other: Any) -> "Rounded":
        return of(other) + (-self)

    def __mul__(self, other: Any) -> "Rounded":
        other = of(other)
        error = size(self.value) * other.error + size(other.value) * self.error + self.error * other.error
        return _with(self.value * other.value, np.where(np.isnan(error), np.inf, error))

    def __truediv__(self, other: Any) -> "Rounded":
        other = of(other)
        quotient = self.value / other.value
        least = np.maximum(other.value.low, -other.value.high) - other.error
        apart = least > 0
        error = (self.error + size(quotient) * other.error) / np.where(apart, least, 1.0)
        return _with(quotient, np.where(apart & ~np.isnan(error), error, np.inf))

    def __rtruediv__(self, other: Any) -> "Rounded":
        return of(other) / self

    __radd__ = __add__
    __rmul__ = __mul__

    def mapped(self, value: Interval, slope: Interval) -> "Rounded":
        """f(a), from its enclosure and that of f′ on `widened`."""
        error = size(slope) * self.error
        error = np.where(np.isnan(error), np.where(self.error == 0, 0.0, np.inf), error)
        return _with(value, error, PADDING)

    @property
    def widened(self) -> Interval:
        """All that the computed value may be."""
        return Interval(self.value.low - self.error, self.value.high + self.error)


def size(value: Interval) -> Float[Array, "*n"]:
    """The largest absolute value on each stretch; infinite if it is not known."""
    largest = np.maximum(np.abs(value.low), np.abs(value.high))
    return np.where(np.isnan(largest), np.inf, largest)


def of(value: Any) -> Rounded:
    """A number without an error, or what is rounded already."""
    if isinstance(value, Rounded):
        return value
    point = np.atleast_1d(np.asarray(value, dtype=float))
    return Rounded(Interval(point, point), np.zeros_like(point))


def _with(value: Interval, error: Array, own: float = EPSILON) -> Rounded:
    """The value with the error that its arguments leave, and its own rounding."""
    return Rounded(value, (error + own * (size(value) + error)) * (1 + 8 * EPSILON) + TINIEST)
