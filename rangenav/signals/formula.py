"""A Formula: one expression in t for each axis, with derivatives of any order by power series and bounds by intervals.

    offset + drift t + mix · (x(t/slower), y(t/slower), z(t/slower))
The expressions stay as they were typed. An edit that moves, turns or slows a path changes the other fields only.
"""

import math
from functools import lru_cache
from typing import cast

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3, require_within
from rangenav.signals import expressions, rounded
from rangenav.signals.base import ROUNDING_MARGIN, SignalBase, divided, vector
from rangenav.signals.expressions import Node
from rangenav.signals.intervals import Interval
from rangenav.signals.multisine import AXES, MAX_DRIFT, MAX_OFFSET, common_period
from rangenav.signals.periodicity import frequencies
from rangenav.signals.rounded import Rounded
from rangenav.signals.series import Series, variable

Rows = tuple[Vec3, Vec3, Vec3]
IDENTITY: Rows = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
MAX_MIX = 1e4
MIN_SLOWER, MAX_SLOWER = 1e-4, 1e4
MAX_VALUE, MAX_DERIVATIVE = 1e7, 1e30
"""A larger value counts as not finite: no vehicle flies there, and its fourth power would overflow."""
CHUNK = 8192
"""Times evaluated at once: some thousand numbers per coefficient stay in the cache."""
BANDWIDTH_ORDERS = range(5, 11)
BANDWIDTH_TIMES = 512
BOUND_BOXES = 128
"""Stretches of a period over which intervals are taken; on a whole turn at once they would be far too wide."""
STRETCHES = 256
"""Stretches of a flight on each of which a formula is enclosed."""
MAX_BOUNDED = 120
"""Most operations of one axis; intervals for more take longer than a person who is typing wants to wait."""
CACHED = 64


class Formula(
    SignalBase, frozen=True, kw_only=True, tag="formula", tag_field="kind", omit_defaults=True, cache_hash=True
):
    """One expression in t (s) per axis: + − * / **, pi, e, sin, cos, tan, exp, log, sqrt, tanh and their relatives."""

    x: str = "0"
    """In the signal's unit, as y and z."""
    y: str = "0"
    z: str = "0"
    slower: float = 1.0
    """The expressions are run this many times slower: t stands for t / slower."""
    mix: Rows = IDENTITY
    """Rows of the matrix that turns, mirrors or scales (x, y, z)."""
    offset: Vec3 = (0.0, 0.0, 0.0)
    """In the signal's unit."""
    drift: Vec3 = (0.0, 0.0, 0.0)
    """The signal's unit per second."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("slower", self.slower, MIN_SLOWER, MAX_SLOWER)
        for name, limit in (("offset", MAX_OFFSET), ("drift", MAX_DRIFT)):
            for value in getattr(self, name):
                require_within(name, value, -limit, limit)
        for row in self.mix:
            for value in row:
                require_within("mix", value, -MAX_MIX, MAX_MIX)
        for axis in AXES:
            try:
                expressions.parse(getattr(self, axis))
            except ValueError as error:
                raise ValueError(f"{axis}: {error}") from None

    def __call__(self, t: Float[Array, "*n"], order: int = 0) -> Float[Array, "*n 3"]:
        """The derivative of the given order at times t (s). Raises ValueError where it is not finite."""
        t = np.asarray(t, dtype=float)
        flat = t.ravel()
        value = np.empty((len(flat), 3))
        for first in range(0, len(flat), CHUNK):
            inside = slice(first, first + CHUNK)
            for axis, k in AXES.items():
                value[inside, k] = self._derivative(axis, flat[inside], order)
        if self.mix != IDENTITY:
            value = value @ np.asarray(self.mix).T
        if order == 0:
            value += np.asarray(self.offset) + flat[:, None] * np.asarray(self.drift)
        elif order == 1:
            value += np.asarray(self.drift)
        return value.reshape(*t.shape, 3)

    def _derivative(self, axis: str, t: Array, order: int) -> Array | float:
        series = _series(expressions.parse(getattr(self, axis)), t / self.slower, order)
        if len(series) <= order:
            return 0.0
        with np.errstate(all="ignore"):
            value = np.broadcast_to(series[order] * (math.factorial(order) / self.slower**order), t.shape)
        limit = MAX_VALUE if order == 0 else MAX_DERIVATIVE
        wild = ~(np.abs(value) <= limit)
        if wild.any():
            what = "value" if order == 0 else f"derivative of order {order}"
            k, text = int(np.argmax(wild)), shortened(getattr(self, axis))
            finite = math.isfinite(value[k])
            message = f"the {what} of {text} exceeds {limit:g}" if finite else f"{text} has no finite {what}"
            raise ValueError(f"{axis}: {message} at t = {t[k]:g} s")
        return value

    @property
    def bandwidth(self) -> float:
        """The highest frequency present (rad/s) at any time; infinite without a period, see `bandwidth_until`."""
        period = self.period
        return math.inf if period is None else self.bandwidth_until(period)

    def bandwidth_until(self, time: float) -> float:
        """The highest frequency present (rad/s) from 0 to a time, as `_bandwidth` defines it."""
        return max(_bandwidth(getattr(self, axis), time / self.slower) for axis in AXES) / self.slower

    def bound(self, order: int) -> float:
        """A bound on |signal(t, order)| for every t ≥ 0, by interval arithmetic; infinite if none is known."""
        sizes = np.array([_bound(getattr(self, axis), order) for axis in AXES]) / self.slower**order
        mixed = [sum(abs(m) * size for m, size in zip(row, sizes, strict=True) if m != 0) for row in self.mix]
        if order == 0 and any(self.drift):
            return math.inf
        straight = np.abs(self.offset if order == 0 else self.drift) if order < 2 else np.zeros(3)
        return math.hypot(*(np.asarray(mixed) + straight))  # whose squares do not underflow to a bound of 0

    @property
    def period(self) -> float | None:
        """The common period (s) of all that bends, 0 if nothing does, None if something does not repeat."""
        repeating: set[float] = set()
        for axis in AXES:
            part = frequencies(expressions.parse(getattr(self, axis)))
            if part is None:
                return None
            repeating |= part
        common = common_period(sorted(repeating))
        return None if common is None else common * self.slower

    @property
    def bound_stretches(self) -> int:
        """Intervals over a whole flight at once would be far too wide."""
        return STRETCHES

    def derivative_bounds(self, edges: Float[Array, "k"], orders: range) -> Float[Array, "o m"]:
        """Each axis enclosed as a power series over intervals of t / slower; the mix adds their sizes."""
        time = Interval(edges[:-1], edges[1:]) / self.slower
        sizes = np.zeros((len(orders), 3, len(edges) - 1))
        for axis, k in AXES.items():
            with np.errstate(all="ignore"):
                series = expressions.evaluate(expressions.parse(getattr(self, axis)), variable(time), max(orders))
                for row, order in enumerate(orders):
                    if order < len(series):
                        sizes[row, k] = _size(series[order]) * (math.factorial(order) / self.slower**order)
        mix = np.abs(np.asarray(self.mix))
        with np.errstate(invalid="ignore", over="ignore"):  # what overflows is infinite: no bound is known
            mixed = np.where(mix[:, :, None] > 0, mix[:, :, None] * sizes[:, None], 0.0).sum(axis=2)
            return np.hypot(np.hypot(mixed[:, 0], mixed[:, 1]), mixed[:, 2]) * ROUNDING_MARGIN

    def rounding_bound(self, edges: Float[Array, "k"]) -> float:
        """Each expression with the rounding of all its operations, over intervals of t / slower."""
        time = Rounded(Interval(edges[:-1], edges[1:]), np.zeros(len(edges) - 1)) / self.slower
        error, value = np.zeros((3, len(edges) - 1)), np.zeros((3, len(edges) - 1))
        for axis, k in AXES.items():
            with np.errstate(all="ignore"):
                (first, *_) = expressions.evaluate(expressions.parse(getattr(self, axis)), (time,), 0)
            first = rounded.of(first)
            error[k], value[k] = first.error / rounded.EPSILON, rounded.size(first.value)
        mix = np.abs(np.asarray(self.mix))
        with np.errstate(invalid="ignore"):
            each = np.where(mix[:, :, None] > 0, mix[:, :, None] * (error + 3 * value), 0.0).sum(axis=1)
        latest = float(np.abs(edges[[0, -1]]).max())
        straight = 2 * (math.hypot(*self.offset) + latest * math.hypot(*self.drift))
        total = float(np.sqrt(np.sum(each**2, axis=0)).max())
        return total + straight if math.isfinite(total) else math.inf

    def jet(self, t: Float[Array, "n"], highest: int) -> Float[Array, "o n 3"]:
        """The signal and its derivatives up to the highest order, one after the other."""
        return np.stack([self(t, order) for order in range(highest + 1)])

    def operations(self) -> int:
        """How many operations the three expressions have."""
        return sum(expressions.size(expressions.parse(getattr(self, axis))) for axis in AXES)

    def piecewise(self) -> None:
        """An expression is taken for no polynomial."""
        return

    def slowed(self, factor: float) -> "Formula":
        """The signal s(t / factor); the expressions keep their text."""
        return msgspec.structs.replace(self, slower=self.slower * factor, drift=divided(self.drift, factor))

    def mapped(self, matrix: Float[Array, "3 3"], shift: Float[Array, "3"]) -> "Formula":
        """matrix · signal + shift; the expressions keep their text."""
        x, y, z = (vector(row) for row in matrix @ np.asarray(self.mix))
        mix: Rows = (x, y, z)
        offset, drift = vector(matrix @ self.offset + shift), vector(matrix @ self.drift)
        return msgspec.structs.replace(self, mix=mix, offset=offset, drift=drift)

    def curved_part(self) -> "Formula":
        """The expressions alone."""
        return msgspec.structs.replace(self, offset=(0.0, 0.0, 0.0), drift=(0.0, 0.0, 0.0))


def derivatives(text: str, t: Float[Array, "*n"], highest: int) -> Float[Array, "order *n"]:
    """A scalar formula and its derivatives up to the highest order, at times t (s). Raises ValueError if not finite."""
    series = _series(expressions.parse(text), t, highest)
    values = np.zeros((highest + 1, *t.shape))
    for k, coefficient in enumerate(series):
        values[k] = coefficient * math.factorial(k)
    wild = ~(np.abs(values) <= MAX_DERIVATIVE).all(axis=0)
    if wild.any():
        raise ValueError(f"{shortened(text)} is not finite at t = {float(t[wild][0]):g} s")
    return values


def _size(coefficient: object) -> Array | float:
    """The largest absolute value of an enclosure on each stretch; infinite if it is not known."""
    if not isinstance(coefficient, Interval):
        return abs(float(cast(float, coefficient)))
    largest = np.maximum(np.abs(coefficient.low), np.abs(coefficient.high))
    return np.where(np.isnan(largest), np.inf, largest)


def shortened(text: str) -> str:
    """At most 40 characters of a formula, for a sentence."""
    return text if len(text) <= 40 else text[:39] + "…"


def _series(node: Node, t: Array | Interval, order: int) -> Series:
    with np.errstate(all="ignore"):
        return expressions.evaluate(node, variable(t), order)


@lru_cache(maxsize=CACHED)
def _bandwidth(text: str, time: float) -> float:
    """The highest frequency (rad/s) up to a time: the largest of (sup|u⁽ᵏ⁺²⁾| / sup|ü|)^{1/k} on a grid.

    w for a sine; c/ρ for what has a singularity ρ seconds off the time axis, which needs as many quadrature nodes.
    """
    node = expressions.parse(text)
    grid = np.linspace(0, time, BANDWIDTH_TIMES)
    series = _series(node, grid, max(BANDWIDTH_ORDERS))
    sizes = [float(np.max(np.abs(series[k]))) * math.factorial(k) if k < len(series) else 0.0 for k in range(11)]
    if not 0 < sizes[2] < math.inf:
        return 0.0 if sizes[2] == 0 else math.inf
    highest = max((sizes[k] / sizes[2]) ** (1 / (k - 2)) for k in BANDWIDTH_ORDERS)
    return highest if math.isfinite(highest) else math.inf


@lru_cache(maxsize=CACHED)
def _bound(text: str, order: int) -> float:
    node = expressions.parse(text)
    if expressions.size(node) > MAX_BOUNDED:
        return math.inf
    repeats = frequencies(node)
    period = common_period(sorted(repeats)) if repeats is not None else None
    if period and order > 1:  # below order 2 a straight line may be added to what repeats
        edges = np.linspace(0, period * (1 + 1e-12), BOUND_BOXES + 1)
        time = Interval(edges[:-1], edges[1:])
    else:
        time = Interval(np.zeros(1), np.full(1, np.inf))
    series = _series(node, time, order)
    if order >= len(series):
        return 0.0
    with np.errstate(all="ignore"):
        enclosure = series[order] * float(math.factorial(order))
    return enclosure.magnitude() if isinstance(enclosure, Interval) else abs(float(enclosure))
