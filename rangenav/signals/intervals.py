"""Interval arithmetic, rounded outwards: it encloses every value that an expression takes over a stretch of time.

It makes "for all t" a statement instead of a sample. What cannot be enclosed (a division by an interval around zero, a
logarithm of what may be negative) becomes [−∞, ∞]: no bound is known, and nothing false is said.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

PADDING = 4 * np.finfo(float).eps
"""Relative error assumed of an elementary function; those of numpy stay within four units of the last place."""
TINIEST = 1e-300
"""Absolute padding, for values that underflow."""


@dataclass(frozen=True, eq=False)
class Interval:
    """[low, high], elementwise over stretches of time."""

    low: Float[Array, "*n"]
    high: Float[Array, "*n"]

    __array_ufunc__ = None
    """numpy leaves `array × interval` to the interval."""

    def __add__(self, other: Any) -> "Interval":
        other = _interval(other)
        return _outward(self.low + other.low, self.high + other.high)

    def __neg__(self) -> "Interval":
        return Interval(-self.high, -self.low)

    def __sub__(self, other: Any) -> "Interval":
        return self + (-_interval(other))

    def __rsub__(self, other: Any) -> "Interval":
        return _interval(other) + (-self)

    def __mul__(self, other: Any) -> "Interval":
        other = _interval(other)
        corners = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        corners = [np.where(np.isnan(c), 0.0, c) for c in corners]  # 0 × ∞: no interval holds ∞ itself
        return _outward(np.minimum.reduce(corners), np.maximum.reduce(corners))

    def __truediv__(self, other: Any) -> "Interval":
        other = _interval(other)
        apart = (other.low > 0) | (other.high < 0)
        inverse = _outward(1 / np.where(apart, other.high, 1.0), 1 / np.where(apart, other.low, 1.0))
        return self * _unless(apart, inverse)

    def __rtruediv__(self, other: Any) -> "Interval":
        return _interval(other) / self

    __radd__ = __add__
    __rmul__ = __mul__

    def magnitude(self) -> float:
        """The largest absolute value; infinite if it is not known."""
        largest = float(np.max(np.maximum(np.abs(self.low), np.abs(self.high))))
        return np.inf if np.isnan(largest) else largest


def _interval(value: Any) -> Interval:
    if isinstance(value, Interval):
        return value
    point = np.atleast_1d(np.asarray(value, dtype=float))
    return Interval(point, point)


def _outward(low: Any, high: Any) -> Interval:
    """The interval, wider by one unit of the last place on both sides; NaN becomes an infinite bound."""
    low, high = np.nextafter(low, -np.inf), np.nextafter(high, np.inf)
    unknown = np.isnan(low) | np.isnan(high)
    return Interval(np.where(unknown, -np.inf, low), np.where(unknown, np.inf, high))


def _unless(known: Array, enclosure: Interval) -> Interval:
    """`enclosure` where `known` is true, else [−∞, ∞]."""
    return Interval(np.where(known, enclosure.low, -np.inf), np.where(known, enclosure.high, np.inf))


def _padded(low: Any, high: Any) -> Interval:
    return _outward(low - PADDING * np.abs(low) - TINIEST, high + PADDING * np.abs(high) + TINIEST)


def _rising(function: Callable[[Array], Array], lowest: float = -np.inf, highest: float = np.inf) -> Any:
    """The enclosure of a rising function defined between lowest and highest."""

    def enclosure(u: Interval) -> Interval:
        inside = (u.low >= lowest) & (u.high <= highest)
        low, high = (np.where(inside, end, max(0.5, lowest)) for end in (u.low, u.high))
        return _unless(inside, _padded(function(low), function(high)))

    return enclosure


def _turning(function: Callable[[Array], Array]) -> Any:
    """Sine or cosine: |sin x − sin m| ≤ |x − m| about the middle m; the bound is sharp on short stretches."""

    def enclosure(u: Interval) -> Interval:
        middle = np.where(np.isfinite(u.high - u.low), (u.low + u.high) / 2, 0.0)
        reach = np.maximum(u.high - middle, middle - u.low) + PADDING * (1 + np.abs(middle))
        value = function(middle)
        return Interval(np.maximum(value - reach, -1.0), np.minimum(value + reach, 1.0))

    return enclosure


def _cosh(u: Interval) -> Interval:
    largest = np.maximum(np.abs(u.low), np.abs(u.high))
    smallest = np.where((u.low <= 0) & (u.high >= 0), 0.0, np.minimum(np.abs(u.low), np.abs(u.high)))
    return _padded(np.cosh(smallest), np.cosh(largest))


def _tan(u: Interval) -> Interval:
    """The tangent rises between two poles; a stretch that may contain a pole has no finite enclosure."""
    finite = np.isfinite(u.low) & np.isfinite(u.high)
    low, high = np.where(finite, u.low, 0.0), np.where(finite, u.high, 0.0)
    slack = PADDING * (1 + np.abs(low) + np.abs(high))
    same = np.floor((low - slack) / np.pi + 0.5) == np.floor((high + slack) / np.pi + 0.5)
    return _unless(finite & same, _padded(np.tan(low), np.tan(high)))


def _pow(u: Interval, exponent: float) -> Interval:
    """uᵖ on u > 0 rises or falls with the sign of p."""
    inside = u.low > 0
    ends = [np.power(np.where(inside, end, 1.0), exponent) for end in (u.low, u.high)]
    return _unless(inside, _padded(np.minimum(*ends), np.maximum(*ends)))


def _acos(u: Interval) -> Interval:
    return -_rising(lambda x: -np.arccos(x), -1.0, 1.0)(u)


ELEMENTARY: dict[str, Callable[..., Interval]] = {
    "sin": _turning(np.sin),
    "cos": _turning(np.cos),
    "tan": _tan,
    "exp": _rising(np.exp),
    "log": _rising(np.log, lowest=TINIEST),
    "sinh": _rising(np.sinh),
    "cosh": _cosh,
    "tanh": _rising(np.tanh),
    "asin": _rising(np.arcsin, -1.0, 1.0),
    "acos": _acos,
    "atan": _rising(np.arctan),
    "asinh": _rising(np.arcsinh),
    "acosh": _rising(np.arccosh, lowest=1.0),
    "atanh": _rising(np.arctanh, -1.0, 1.0),
    "pow": _pow,
}
"""Enclosures of the elementary functions, by name."""
