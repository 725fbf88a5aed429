"""Ramps from hover into a path and back to hover: the vehicle follows the path, and its own time speeds up and down.

    p(σ(t)),   σ' = 35u⁴ − 84u⁵ + 70u⁶ − 20u⁷,  u = t/ramp:  0 → 1 with three derivatives zero at either end
Position to snap start and end at rest, and pass smoothly into the steady part, where σ' = 1. The vehicle visits no
point that is not on the path. A ramp of r seconds covers the first r/2 of the path, so the file lasts r longer than the
path. Between the ramps lie the seconds r/2 to T − r/2 of the path; only there the excitation is that of the path.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import hermite
from rangenav.inputs import Vec3, require
from rangenav.number_format import significant, vector
from rangenav.results import result
from rangenav.signals import Flown, Polynomials, Signal, formula, multirotor
from rangenav.signals.multirotor import Attitude

RAMP = 2.0
"""s; a metre per second is reached with 1.1 m/s²."""
SHORTEST, LONGEST = 0.2, 20.0
"""s, of a ramp."""
CLOSED = {0: 1e-3, 1: 1e-2, 2: 0.1}
"""SI, by order: a path that misses its beginning by less closes. No vehicle follows a larger jump."""
AT_REST = 1e-6
"""The path itself hovers at an end where velocity, acceleration and jerk are below this (SI)."""
BLEND = np.polynomial.Polynomial([0, 0, 0, 0, 0, 7.0, -14.0, 10.0, -2.5])
"""σ/ramp over u; its value at 1 is ½."""
RESTING = 1e-3
"""SI: the same of a path that was printed and read."""
LIKE_A_RAMP, LIKE_SAMPLES, DEGREE, LIKE = (0.15, 0.4), 60, 7, 2e-4
"""Share of the ramp, samples there, degree of the polynomial in σ fitted to the velocity, and what it may miss: the
shipped presets' exports miss 6e-5 at most, minimum-snap curves through random points miss 1e-3 at least."""
ORDERS = 5
PLACES, MICROMETRE = 2001, 6
"""Samples of a motion for its lowest point, and the decimals of its points."""
LOW = 0.1
"""m: the height below which a vehicle would meet a floor at z = 0."""
RAMP_STEP = 0.05
"""s: length of the pieces of degree 7 from which the attitude on a ramp is computed."""


@result
class Place:
    """Where a written motion lies, in the axes of its file, z up; all in m."""

    first: Vec3
    """Its first point."""
    last: Vec3
    """Its last point, where the vehicle hovers in the end."""
    lowest: float
    highest: float
    room: Vec3
    """The sides of the box that holds the motion, along x, y and z."""
    anchor: Vec3

    @property
    def summary(self) -> str:
        """One sentence for whoever flies it: the ranges fit no other place of the anchor."""
        low = "; that is not above a floor at z = 0: fly it from a hover high enough" if self.lowest < LOW else ""
        return (
            f"in the file's axes (z up) the flight begins at {vector(self.first)} m and ends in hover at "
            f"{vector(self.last)} m, {significant(math.dist(self.first, self.last))} m away; it needs a room of "
            f"{' × '.join(significant(side) for side in self.room)} m and lies at z from {significant(self.lowest)} "
            f"to {significant(self.highest)} m{low}; the anchor must stand at {vector(self.anchor)} m of the same axes"
        )


@result
class HoverRamps:
    """A path from 0 to `duration`, entered and left from hover; callable like a signal, up to snap."""

    path: Signal
    duration: float
    """s of the path itself."""
    ramp: float
    """s of each ramp; 0 if the path starts and ends at rest."""

    @property
    def end(self) -> float:
        """Duration of path and ramps (s)."""
        return self.duration + self.ramp

    @property
    def steady(self) -> tuple[float, float]:
        """From when to when (s) it runs at the path's own speed."""
        return self.ramp, self.duration

    def place(self, anchor: Vec3) -> Place:
        """Where the motion and an anchor (m) lie, from PLACES samples; path and anchor have z up."""
        points = self(np.linspace(0.0, self.end, PLACES)).round(MICROMETRE) + 0.0
        (x, y, z), (u, v, w) = points[0].tolist(), points[-1].tolist()
        heights = points[:, 2]
        across, along, up = np.ptp(points, axis=0).tolist()
        return Place(
            first=(x, y, z),
            last=(u, v, w),
            lowest=float(heights.min()),
            highest=float(heights.max()),
            room=(across, along, up),
            anchor=anchor,
        )

    def __call__(self, t: Float[Array, "n"], order: int = 0) -> Float[Array, "n 3"]:
        """The derivative of the given order (0 to 4) at times t (s)."""
        own = self.own_time(t)
        return chained([self.path(own[:, 0], k) for k in range(order + 1)], own)[order]

    def own_time(self, t: Float[Array, "n"]) -> Float[Array, "n 5"]:
        """σ(t), the path's own time, and its first four derivatives."""
        own = np.zeros((len(t), ORDERS))
        own[:, 0], own[:, 1] = t - self.ramp / 2, 1.0
        if self.ramp == 0:
            return own
        rising, falling = t < self.ramp, t > self.duration
        for k in range(ORDERS):
            blend = BLEND.deriv(k) if k else BLEND
            scale = self.ramp ** (1 - k)
            own[rising, k] = blend(np.maximum(t[rising], 0.0) / self.ramp) * scale
            left = np.maximum(self.end - t[falling], 0.0) / self.ramp
            own[falling, k] = (-1.0) ** (k + 1) * blend(left) * scale
        own[falling, 0] += self.duration
        return own


def with_ramps(path: Signal, duration: float, *, window: float, ramp: float = RAMP) -> HoverRamps:
    """The path with its ramps. Raises ValueError if they leave less than one window (s) of steady flight."""
    refuse_ramp(ramp)
    if _rests(path, np.array([0.0, duration])):
        return HoverRamps(path=path, duration=duration, ramp=0.0)
    left = duration - ramp
    rule = f"ramps of {ramp:g} s leave {left:.3g} s of the path, less than its window of {window:g} s: fly longer"
    require(left >= window, rule)
    return HoverRamps(path=path, duration=duration, ramp=ramp)


def around_loop(path: Signal, period: float, *, ramp: float = RAMP) -> HoverRamps:
    """One period (s) of a path that closes, with its ramps: it is steady from half a ramp on, for one period."""
    refuse_ramp(ramp)
    if _rests(path, np.array([0.0, period])):
        return HoverRamps(path=path, duration=period, ramp=0.0)
    return HoverRamps(path=path, duration=period + ramp, ramp=ramp)


def refuse_ramp(ramp: float) -> None:
    """Raise ValueError for the length (s) of a ramp that nothing flies."""
    require(SHORTEST <= ramp <= LONGEST, f"a ramp must last {SHORTEST:g} to {LONGEST:g} s, got {ramp:g} s")


def closes(path: Signal, duration: float) -> bool:
    """Whether a path is, after its duration (s), where it began and as fast, so that it can be flown as a loop."""
    ends = np.array([0.0, duration])
    return all(float(np.abs(np.diff(path(ends, order), axis=0)).max()) < most for order, most in CLOSED.items())


def _rests(path: Signal, at: Float[Array, "n"]) -> bool:
    return max(float(np.abs(path(at, order)).max()) for order in (1, 2, 3)) < AT_REST


def left_out(ramp: float) -> str:
    """What is said where the ramps (s) of an own export are not read."""
    return (
        f"the first and last {ramp:.6g} s are the ramps of an export of rangenav, from hover and back to it: they are "
        "left out unless a part of the file is asked for"
    )


def recognised(path: Signal, duration: float, *, ramp: float = RAMP) -> bool:
    """Whether a path that was read begins and ends with these ramps (s).

    On a ramp ṗ(t)/σ'(t) is the velocity of the path proper at σ(t), and so a smooth function of σ. In other motions
    that start from rest it is smooth in t and not in σ, whose fifth root t is.
    """
    ends = np.array([0.0, duration])
    if duration <= 2 * ramp or max(float(np.abs(path(ends, order)).max()) for order in (1, 2, 3)) > RESTING:
        return False
    u = np.linspace(*LIKE_A_RAMP, LIKE_SAMPLES)
    own, speed = ramp * BLEND(u), BLEND.deriv()(u)[:, None]
    basis = np.polynomial.chebyshev.chebvander(2 * (own - own[0]) / (own[-1] - own[0]) - 1, DEGREE)
    for moving in (path(ramp * u, 1), -path(duration - ramp * u, 1)):
        velocity = moving / speed
        missed = velocity - basis @ np.linalg.lstsq(basis, velocity, rcond=None)[0]
        if not np.abs(missed).max() <= LIKE * np.abs(velocity).max() or not np.any(velocity):
            return False
    return True


def chained(value: list[Array], own: Float[Array, "n 5"]) -> list[Array]:
    """Derivatives of f(σ(t)) from those of f at σ, up to the fourth (Faà di Bruno)."""
    s1, s2, s3, s4 = (own[:, k].reshape(-1, *[1] * (value[0].ndim - 1)) for k in range(1, ORDERS))
    terms = [
        lambda f: f[0],
        lambda f: f[1] * s1,
        lambda f: f[2] * s1**2 + f[1] * s2,
        lambda f: f[3] * s1**3 + 3 * f[2] * s1 * s2 + f[1] * s3,
        lambda f: f[4] * s1**4 + 6 * f[3] * s1**2 * s2 + f[2] * (3 * s2**2 + 4 * s1 * s3) + f[1] * s4,
    ]
    return [term(value) for term in terms[: len(value)]]


def yaw(turning: object, course: HoverRamps, t: Float[Array, "n"]) -> list[Float[Array, "n"]]:
    """The yaw angle (rad) and its first three derivatives: those of a flown body, else zero."""
    if not isinstance(turning, Flown):
        return [np.zeros(len(t)) for _ in range(4)]
    own = course.own_time(t)
    angle = formula.derivatives(turning.yaw, own[:, 0], 3)
    return chained([np.broadcast_to(part, t.shape) for part in angle], own)


def attitude(course: HoverRamps, turning: object, gravity: Vec3, t: Float[Array, "n"]) -> Attitude:
    """What a multirotor must do to fly the course: thrust along the specific force, turned about it by the yaw."""
    tilt = _tilt(course, gravity, t)
    angle, rate, second, _ = yaw(turning, course, t)
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros(len(t))
    turn = np.stack([c, -s, zero, s, c, zero, zero, zero, zero + 1], axis=-1).reshape(-1, 3, 3)
    axis = np.array([0.0, 0.0, 1.0])
    rate_turned = np.einsum("nij,ni->nj", turn, tilt.angular_velocity)
    acceleration_turned = np.einsum("nij,ni->nj", turn, tilt.angular_acceleration)
    return Attitude(
        rotation=tilt.rotation @ turn,
        angular_velocity=rate_turned + rate[:, None] * axis,
        angular_acceleration=acceleration_turned + second[:, None] * axis - rate[:, None] * np.cross(axis, rate_turned),
    )


def _tilt(course: HoverRamps, gravity: Vec3, t: Array) -> Attitude:
    """Steady flight from the path itself, ramps from fine pieces of degree 7 (they hold still before and after)."""
    first, last = course.steady
    parts: list[tuple[Array, float, Signal | None]] = [
        (t < first, 0.0, _pieces(course, 0.0, first)),
        (t > last, last, _pieces(course, last, course.end)),
    ]
    parts.append((~(t < first) & ~(t > last), course.ramp / 2, course.path))
    tilt = Attitude(
        rotation=np.empty((len(t), 3, 3)),
        angular_velocity=np.empty((len(t), 3)),
        angular_acceleration=np.empty((len(t), 3)),
    )
    for inside, begin, signal in parts:
        if signal is None or not inside.any():
            continue
        part = multirotor.attitude(Flown(), signal, gravity, t[inside] - begin)
        for name in ("rotation", "angular_velocity", "angular_acceleration"):
            getattr(tilt, name)[inside] = getattr(part, name)
    return tilt


def _pieces(course: HoverRamps, begin: float, end: float) -> Polynomials | None:
    if course.ramp == 0:
        return None
    knots = np.linspace(begin, end, round((end - begin) / RAMP_STEP) + 1)
    return hermite.polynomials(knots - begin, np.stack([course(knots, order) for order in range(4)], axis=1))
