"""The search for a twin: exact twins first, then motions whose range agrees within a tolerance.

A twin of the motion p is p + Δp + Δv s, with the same IMU record and the same range. Exact twins are rotations and
mirror images about the anchor (`observability.symmetry`). The others are searched along the nonlinear null space
(`observability.ambiguity`).
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import so3
from rangenav.inputs import Vec3, refuse_nonfinite, require_within
from rangenav.motion import World, time_grid
from rangenav.observability import ambiguity, symmetry
from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Signal, with_start
from rangenav.twin import text
from rangenav.twin.outcome import Refusal, Twin, TwinKind

TOLERANCE, APART = 0.02, 1.0
"""m: the tolerance of the range, and the least distance of a twin (RMS over the flight)."""
MAX_TOLERANCE, MIN_APART, MAX_APART = 100.0, 0.01, 1e4
MAX_RANGES, GRID = 4000, 2001
"""Ranges are compared at their own times, evenly thinned to at most MAX_RANGES, and on a grid of GRID times."""
ITSELF = 1e-6
"""m: an exact twin this near is the motion itself."""
SAME = 1e-9
"""m: ranges that differ by less are the same, whatever the tolerance; rounding at 1000 km is 1e-10."""
RIGHT_ANGLE = math.pi / 2
ALMOST = 1 - 1e-9
"""Share of the required distance that is enough: it allows for rounding."""
CACHED = 8

NONE: Vec3 = (0.0, 0.0, 0.0)


@result
class _Flight:
    """One motion, and the times at which its range is compared."""

    path: Signal
    anchor: Float[Array, "3"]
    up: Float[Array, "3"]
    duration: float
    time: Float[Array, "n"]
    position: Float[Array, "n 3"]
    """m, relative to the anchor."""
    start: Float[Array, "3"]
    """m, the position at time 0 relative to the anchor."""
    velocity: Float[Array, "3"]
    """m/s, at time 0."""
    unaccelerated: Float[Array, "m 3"]
    """Orthonormal directions along which p̈ is zero throughout."""


def twin(
    preset: Preset, *, tolerance: float = TOLERANCE, apart: float = APART, turn: Vec3 | None = None
) -> Twin | Refusal:
    """The twin of a preset's motion, or the reason why the motion has none.

    tolerance: the largest difference (m) of the ranges. apart: the least distance (m, RMS over the flight) of the twin.
    turn: the rotation vector (rad, about the anchor) of a turned twin; None means a right angle. The antenna is assumed
    at the body's origin; with a lever arm, the summary says so.
    """
    require_within("tolerance", tolerance, 0.0, MAX_TOLERANCE, "m")
    require_within("apart", apart, MIN_APART, MAX_APART, "m")
    refuse_nonfinite("turn", turn)
    answer = _twin(preset.path, preset.world, preset.duration, preset.sensors.range_rate, tolerance, apart, turn)
    arm = math.hypot(*preset.sensors.unmodelled.lever_arm)
    if not arm:
        return answer
    note = text.lever_arm(arm)
    if isinstance(answer, Refusal):
        return replace(answer, reason=answer.reason + note)
    return replace(answer, summary=answer.summary + note)


def turn_towards(preset: Preset, point: Vec3, *, time: float) -> Vec3:
    """The rotation vector (rad) of the turned twin nearest to a point (m) at a time (s); zero if none is allowed."""
    refuse_nonfinite("point", point)
    anchor = np.asarray(preset.world.anchor)
    here, there = preset.path(np.array(time)) - anchor, np.asarray(point) - anchor
    return _vec(symmetry.turn_towards(here, there, symmetry.unaccelerated(preset.path, preset.duration)))


@lru_cache(maxsize=CACHED)
def _twin(
    path: Signal, world: World, duration: float, range_rate: float, tolerance: float, apart: float, turn: Vec3 | None
) -> Twin | Refusal:
    flight = _flight(path, world, duration, range_rate)
    try:
        exact = _exact(flight, apart, turn)
        dragged = turn is not None and exact is not None and exact.draggable
        agrees = exact is not None and exact.mismatch <= max(tolerance, SAME)
        if exact is not None and agrees and (dragged or _rms(flight, exact) >= apart * ALMOST):
            return exact
        return _searched(flight, exact, tolerance, apart)
    except ValueError as error:  # the twin of a path near the limits of its parameters may exceed them
        return Refusal(kind="too large", reason=f"no twin: its {error}", sensitivity=math.nan, mismatch=math.nan)


def _flight(path: Signal, world: World, duration: float, range_rate: float) -> _Flight:
    ranges, anchor, gravity = time_grid(duration, range_rate), np.asarray(world.anchor), np.asarray(world.gravity)
    time = np.union1d(ranges[:: -(-len(ranges) // MAX_RANGES)], np.linspace(0.0, duration, GRID))
    return _Flight(
        path=path,
        anchor=anchor,
        up=-gravity / np.linalg.norm(gravity),
        duration=duration,
        time=time,
        position=path(time) - anchor,
        start=path(np.zeros(())) - anchor,
        velocity=path(np.zeros(()), 1),
        unaccelerated=symmetry.unaccelerated(path, duration),
    )


def _exact(flight: _Flight, apart: float, turn: Vec3 | None) -> Twin | None:
    """The exact twin, at any distance; None if p̈ spans all directions."""
    if len(flight.unaccelerated) == 0:
        return None
    if len(flight.unaccelerated) == 1:
        normal = flight.unaccelerated[0]
        return _compared(flight, "mirrored", *_straight(flight, symmetry.mirror(normal)), text.mirror(normal))
    wanted = _usual_turn(flight, apart) if turn is None else np.asarray(turn)
    chosen = symmetry.allowed(wanted, flight.unaccelerated)
    axis = _vec(np.cross(*flight.unaccelerated)) if len(flight.unaccelerated) == 2 else None
    straight = _straight(flight, so3.exp(chosen))
    return _compared(flight, "turned", *straight, text.turn(chosen), turn=_vec(chosen), axis=axis)


def _usual_turn(flight: _Flight, apart: float) -> Array:
    """The first turn by 90°, then by 180°, about any axis whose twin is far enough; else that of the farthest twin."""
    axes = symmetry.axes(flight.velocity, flight.up, flight.unaccelerated)
    turns = [angle * axis for angle in (RIGHT_ANGLE, 2 * RIGHT_ANGLE) for axis in axes]

    def distance(turn: Array) -> float:
        return ambiguity.rms(*_straight(flight, so3.exp(turn)), flight.duration)

    return next((turn for turn in turns if distance(turn) >= apart * ALMOST), max(turns, key=distance))


def _straight(flight: _Flight, matrix: Array) -> tuple[Array, Array]:
    """Δp and Δv of O q − q, where this difference is a straight line."""
    change = matrix - np.eye(3)
    return change @ flight.start, change @ flight.velocity


def _rms(flight: _Flight, twin: Twin) -> float:
    """m: the distance between both motions, RMS over the flight."""
    return ambiguity.rms(twin.shift, twin.drift, flight.duration)


def _compared(
    flight: _Flight,
    kind: TwinKind,
    shift: Array,
    drift: Array,
    how: str,
    *,
    turn: Vec3 = NONE,
    axis: Vec3 | None = None,
) -> Twin:
    """The twin with a straight-line difference; its range is computed from its own path."""
    start = flight.anchor + flight.start + shift
    path = with_start(flight.path, position=_vec(start), velocity=_vec(flight.velocity + drift))
    true, other = (np.linalg.norm(q, axis=-1) for q in (flight.position, path(flight.time) - flight.anchor))
    distance = np.linalg.norm(shift + flight.time[:, None] * drift, axis=-1)
    mismatch, nearest, farthest = float(np.abs(other - true).max()), float(distance.min()), float(distance.max())
    return Twin(
        kind=kind,
        path=path,
        turn=turn,
        axis=axis,
        shift=shift,
        drift=drift,
        time=flight.time,
        range=true,
        twin_range=other,
        mismatch=mismatch,
        nearest=nearest,
        farthest=farthest,
        summary=text.summary(how, nearest=nearest, farthest=farthest, mismatch=mismatch, same=SAME),
    )


def _searched(flight: _Flight, exact: Twin | None, tolerance: float, apart: float) -> Twin | Refusal:
    """The twin that is not exact but within the tolerance, or the reason why there is none."""
    time = symmetry.moments(flight.duration)
    position, acceleration = flight.path(time) - flight.anchor, flight.path(time, 2)
    candidates = ambiguity.search(position, acceleration, time, flight.duration, apart=apart)
    worst = [_worst(flight, shift, drift) for shift, drift in zip(candidates.shift, candidates.drift, strict=True)]
    best = int(np.argmin(worst))
    if worst[best] <= tolerance:
        shift, drift = candidates.shift[best], candidates.drift[best]
        return _compared(flight, "nearby", shift, drift, text.displacement(shift, drift))
    sensitivity = ambiguity.sensitivity(position, time, flight.duration)
    return _refusal(flight, exact, sensitivity, worst[best], tolerance, apart)


def _worst(flight: _Flight, shift: Array, drift: Array) -> float:
    moved = flight.position + shift + flight.time[:, None] * drift
    return float(np.abs(np.linalg.norm(moved, axis=-1) - np.linalg.norm(flight.position, axis=-1)).max())


def _refusal(
    flight: _Flight, exact: Twin | None, sensitivity: ambiguity.Sensitivity, best: float, tolerance: float, apart: float
) -> Refusal:
    least = float(sensitivity.singular[-1])
    others = text.no_ambiguity(apart=apart, mismatch=best, tolerance=tolerance)
    if exact is not None and _rms(flight, exact) > ITSELF:
        kind, reason = "too near", text.too_near(exact.summary, apart=apart, others=others)
    elif least < ambiguity.BLIND:
        later, directions = (
            _worst(flight, apart * sensitivity.shift, apart * sensitivity.drift),
            len(flight.unaccelerated),
        )
        reason = text.locally_blind(sensitivity.shift, directions=directions, apart=apart, later=later, others=others)
        kind = "locally blind"
    else:
        kind, reason = "observable", text.observable(least, others=others)
    return Refusal(kind=kind, reason=reason, sensitivity=least, mismatch=best)


def _vec(vector: Array) -> Vec3:
    x, y, z = (float(value) + 0.0 for value in vector)  # no −0
    return (x, y, z)
