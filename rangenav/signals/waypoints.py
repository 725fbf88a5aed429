"""Timed points and the smooth curves through them: Waypoints (C⁸, least ∫|p⁽⁵⁾|²) and MinimumSnap (C⁶, least ∫|p⁗|²).

Among all curves through timed points the one of least ∫|p⁽ᵐ⁾|² is the spline of degree 2m − 1: one banded solve, exact.
Waypoints (degree 9) start and end at rest with no snap, so they can hold still there and stay C⁴; minimum-snap curves
(degree 7) are what flight planners make, start and end at rest, and their snap jumps there. With a period both close.
With free ends ∫|p⁽ᵐ⁾|² is least among all curves through the points, whatever their motion at the ends: the derivatives
m to 2m − 2 are zero there (the natural spline). A record that begins or ends in motion is such a curve.
python-control's flatsys is not used: it plans between two complete states, snap included, and knows no points to pass
at given times. Chained through 12 points whose derivatives were already known it took 45 ms, the spline 0.4 ms.
"""

import math
from functools import lru_cache
from typing import ClassVar, TypeVar

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Input, Vec3, require, require_within
from rangenav.signals import piecewise, spline_through
from rangenav.signals.base import vector
from rangenav.signals.multisine import MAX_OFFSET
from rangenav.signals.piecewise import Pieces
from rangenav.signals.piecewise_family import PiecewiseFamily

MAX_POINTS = 2000
MAX_TIME = 1e4
"""s; more than ten minutes of flight, slowed ten times."""
MIN_GAP = 1e-3
"""s between neighbours; a curve of degree 9 through nearer points amplifies rounding to snap."""
MAX_REACH = 1e7
CACHED = 16


class Waypoint(Input, frozen=True, kw_only=True):
    """A point and the time at which the curve passes it."""

    time: float
    """s"""
    value: Vec3
    """In the signal's unit (m for a path, rad/s for an angular velocity)."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("time", self.time, 0.0, MAX_TIME, "s")
        for value in self.value:
            require_within("value", value, -MAX_OFFSET, MAX_OFFSET)


AnyTimed = TypeVar("AnyTimed", bound="Timed")


class Timed(PiecewiseFamily, frozen=True, kw_only=True, omit_defaults=True):
    """Base of the curves through timed points; neighbours may coincide in place, never in time."""

    points: tuple[Waypoint, ...]
    """At least two, at strictly increasing times."""
    period: float | None = None  # pyright: ignore[reportIncompatibleMethodOverride]
    """s, from the first point until it is reached again; None for a path that ends; it holds still before and after."""
    free_ends: bool = False
    """Whether the curve may be in motion at its first and last point; without this it is at rest there."""
    degree: ClassVar[int]

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.points)
        require(2 <= count <= MAX_POINTS, f"2 to {MAX_POINTS} waypoints make a path, got {count}")
        for k in range(1, count):
            before, time = self.points[k - 1].time, self.points[k].time
            rule = f"waypoint {k + 1} at {time:g} s must come at least {MIN_GAP:g} s after waypoint {k} at {before:g} s"
            require(time - before >= MIN_GAP, rule)
        require(self.period is None or not self.free_ends, "a curve with a period has no free ends")
        if self.period is not None:
            length = self.points[-1].time - self.points[0].time
            require_within("period", self.period, 0.0, MAX_TIME, "s")
            rule = f"period must exceed the {length:g} s from the first waypoint to the last, got {self.period:g} s"
            require(self.period - length >= MIN_GAP, rule)
        reach = piecewise.hull(_pieces(self), 0)
        require(
            reach <= MAX_REACH, f"the curve swings out to {reach:.2g} between its waypoints: their times are too uneven"
        )

    def piecewise(self) -> Pieces:
        """The polynomials of degree 9 or 7 that the curve is made of."""
        return _pieces(self)

    @property
    def bandwidth(self) -> float:
        """Half a turn between the two waypoints that follow each other fastest (rad/s)."""
        return math.pi / float(np.diff(_pieces(self).knots).min())

    def bound(self, order: int) -> float:
        """A bound on |signal(t, order)| for every t, from Bernstein coefficients; infinite if a lower one jumps."""
        return _bound(self, order)

    def slowed(self: AnyTimed, factor: float) -> AnyTimed:
        """The same curve run `factor` times slower."""
        points = tuple(msgspec.structs.replace(point, time=point.time * factor) for point in self.points)
        return msgspec.structs.replace(
            self, points=points, period=None if self.period is None else self.period * factor
        )

    def mapped(self: AnyTimed, matrix: Float[Array, "3 3"], shift: Float[Array, "3"]) -> AnyTimed:
        """The curve through matrix · point + shift, which is matrix · curve + shift."""
        values = [vector(matrix @ point.value + shift) for point in self.points]
        points = zip(self.points, values, strict=True)
        return msgspec.structs.replace(
            self, points=tuple(msgspec.structs.replace(point, value=value) for point, value in points)
        )


class Waypoints(
    Timed, frozen=True, kw_only=True, tag="waypoints", tag_field="kind", omit_defaults=True, cache_hash=True
):
    """The C⁸ spline of degree 9; at its ends at rest up to snap, so that holding still there is C⁴."""

    degree: ClassVar[int] = 9


class MinimumSnap(
    Timed, frozen=True, kw_only=True, tag="minimum-snap", tag_field="kind", omit_defaults=True, cache_hash=True
):
    """The curve of least ∫|p⁗|² through its points: C⁶ inside, at its ends at rest up to jerk."""

    degree: ClassVar[int] = 7


TimedFamily = TypeVar("TimedFamily", bound=Waypoints | MinimumSnap)


def move(curve: TimedFamily, index: int, value: Vec3) -> TimedFamily:
    """The curve with one waypoint (from 0) elsewhere."""
    return _with(curve, index, msgspec.structs.replace(curve.points[index], value=value))


def retime(curve: TimedFamily, index: int, time: float) -> TimedFamily:
    """The curve with one waypoint at another time (s), still after the one before and before the next."""
    return _with(curve, index, msgspec.structs.replace(curve.points[index], time=time))


def add(curve: TimedFamily, waypoint: Waypoint) -> TimedFamily:
    """The curve with one more waypoint, put in the order of time."""
    points = sorted((*curve.points, waypoint), key=lambda point: point.time)
    return msgspec.structs.replace(curve, points=tuple(points))


def insert(curve: TimedFamily, index: int) -> TimedFamily:
    """The curve with a waypoint halfway in time between waypoint `index` and the next, where the curve passes there.

    After the last one it comes halfway to the first one's return; on a path that ends, as long after as the last gap.
    """
    times = [point.time for point in curve.points]
    if index + 1 < len(times):
        time = (times[index] + times[index + 1]) / 2
    elif curve.period is not None:
        time = (times[-1] + times[0] + curve.period) / 2
    else:
        time = 2 * times[-1] - times[-2]
    x, y, z = (float(value) for value in curve(np.array(time)))
    return add(curve, Waypoint(time=time, value=(x, y, z)))


def delete(curve: TimedFamily, index: int) -> TimedFamily:
    """The curve without one waypoint (from 0)."""
    return msgspec.structs.replace(curve, points=(*curve.points[:index], *curve.points[index + 1 :]))


def _with(curve: TimedFamily, index: int, waypoint: Waypoint) -> TimedFamily:
    points = list(curve.points)
    points[index] = waypoint
    return msgspec.structs.replace(curve, points=tuple(points))


@lru_cache(maxsize=CACHED)
def _pieces(curve: Timed) -> Pieces:
    time = np.array([point.time for point in curve.points])
    value = np.array([point.value for point in curve.points])
    if curve.period is not None:
        time, value = np.append(time, time[0] + curve.period), np.vstack([value, value[:1]])
    ends = "closed" if curve.period is not None else "free" if curve.free_ends else "rest"
    return spline_through.fitted(time, value, degree=curve.degree, ends=ends)


@lru_cache(maxsize=4 * CACHED)
def _bound(curve: Timed, order: int) -> float:
    return piecewise.bound(_pieces(curve), order)
