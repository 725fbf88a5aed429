"""The evil twin: a second motion with the same IMU record and, within a tolerance, the same range.

The same gyro, magnetometer, accelerometer and attitude leave p̈ the same, so a twin is p + Δp + Δv s. Exact ones are
turns and mirrors about the anchor (observability.symmetry); others, within the tolerance only, are searched along the
nonlinear null space (observability.lookalike).

Without a magnetometer every motion has twins: turned about the vertical through the anchor, body and all. With it a
body turned by O about the magnetic direction would do too if it felt ½s²(Oᵀ − I)g; those are not searched: exact ones
need n·(p̈ − g) ≡ 0, a motion that falls freely along n.
"""

import math
from dataclasses import replace
from functools import lru_cache
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import so3
from rangenav.inputs import Vec3, refuse_nonfinite, require_within
from rangenav.motion import World, time_grid
from rangenav.observability import ambiguity, blindness, symmetry
from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Signal, with_start

TOLERANCE, APART = 0.02, 1.0
"""m: of the range; and how far off a twin must be (RMS over the flight) to be worth showing."""
MAX_TOLERANCE, MIN_APART, MAX_APART = 100.0, 0.01, 1e4
MAX_RANGES, GRID = 4000, 2001
"""Moments at which the ranges are compared: their own, or so many of them evenly, and a grid between them."""
ITSELF = 1e-6
"""m: an exact twin this near is the motion itself."""
SAME = 1e-9
"""m: ranges that differ by less are the same, whatever the tolerance; rounding at 1000 km is 1e-10."""
RIGHT_ANGLE = math.pi / 2
ZERO = 1e-9
"""Parts of a unit vector below it are rounding."""
STEADY = 0.01
"""A twin whose distance varies by less than this share is said to be at one distance."""
ALMOST = 1 - 1e-9
"""Of the distance asked for: what is as far as that but for rounding is far enough."""
CACHED = 8

ITS_OWN_TWIN = (
    "no turn or mirror leaves its acceleration alone",
    "the anchor lies in its plane, so its mirror image is the motion itself",
    "the anchor lies on its line, so what is turned about that is the motion itself",
    "it stands at the anchor, so what is turned about that is the motion itself",
)
"""Why there is no exact twin, by the number of directions along which nothing accelerates."""
TwinKind = Literal["turned", "mirrored", "nearby"]
NONE: Vec3 = (0.0, 0.0, 0.0)


@result
class Twin:
    """Another motion that range and IMU cannot tell from the true one; its attitude is the true one's."""

    kind: TwinKind
    """Turned and mirrored ones are exact; a nearby one only agrees within the tolerance."""
    path: Signal
    """m, inertial frame: a preset with it instead of its own has the same IMU record."""
    turn: Vec3
    """rad: the turn about the anchor, a rotation vector; zero unless turned."""
    axis: Vec3 | None
    """The only axis it may be turned about; None if any will do, or none."""
    shift: Float[Array, "3"]
    """Δp (m), at t = 0."""
    drift: Float[Array, "3"]
    """Δv (m/s)."""
    time: Float[Array, "n"]
    """s: where both ranges were compared."""
    range: Float[Array, "n"]
    """m, of the true path."""
    twin_range: Float[Array, "n"]
    mismatch: float
    """m: the largest difference of the two ranges."""
    nearest: float
    """m between the two motions, at their nearest and at their farthest."""
    farthest: float
    words: str

    @property
    def draggable(self) -> bool:
        """Whether it is one of a family that `turn` runs through."""
        return self.kind == "turned"


@result
class Refusal:
    """Why there is no twin."""

    kind: Literal["locally blind", "too near", "observable", "too large"]
    reason: str
    sensitivity: float
    """The least singular value: metres of range (RMS) for a metre of difference. Above 0 it forbids a twin nearby."""
    mismatch: float
    """m: by how much the best lookalike at the distance asked for is off, at its worst moment."""


@result
class _Flight:
    """One motion, and the moments at which its range is compared."""

    path: Signal
    anchor: Float[Array, "3"]
    up: Float[Array, "3"]
    duration: float
    time: Float[Array, "n"]
    position: Float[Array, "n 3"]
    """m, relative to the anchor, as everything here."""
    start: Float[Array, "3"]
    velocity: Float[Array, "3"]
    still: Float[Array, "m 3"]
    """Directions along which nothing accelerates."""


def twin(
    preset: Preset, *, tolerance: float = TOLERANCE, apart: float = APART, turn: Vec3 | None = None
) -> Twin | Refusal:
    """The twin of a preset's motion, or why it has none.

    `tolerance` (m) is how well the ranges must agree at every moment, `apart` (m, RMS over the flight) how far off it
    must be. `turn` (rad, a rotation vector about the anchor) drags a turned one anywhere; None takes a right angle.
    The antenna is taken to sit at the body's origin; with a lever arm the words say so.
    """
    require_within("tolerance", tolerance, 0.0, MAX_TOLERANCE, "m")
    require_within("apart", apart, MIN_APART, MAX_APART, "m")
    refuse_nonfinite("turn", turn)
    found = _twin(preset.path, preset.world, preset.duration, preset.sensors.range_rate, tolerance, apart, turn)
    arm = math.hypot(*preset.sensors.unmodelled.lever_arm)
    if not arm:
        return found
    note = f"; so it is for an antenna at the body's origin, and here a lever arm of {arm:.2g} m is left out"
    if isinstance(found, Refusal):
        return replace(found, reason=found.reason + note)
    return replace(found, words=found.words + note)


def turn_towards(preset: Preset, point: Vec3, *, time: float) -> Vec3:
    """The turn (rad) that brings a turned twin as near as can be to a point (m) at a time (s); zero if none may be."""
    refuse_nonfinite("point", point)
    anchor = np.asarray(preset.world.anchor)
    here, there = preset.path(np.array(time)) - anchor, np.asarray(point) - anchor
    return _vec(symmetry.turn_towards(here, there, symmetry.still(preset.path, preset.duration)))


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
    except ValueError as error:  # the twin of a path at the limits of its numbers may lie beyond them
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
        still=symmetry.still(path, duration),
    )


def _exact(flight: _Flight, apart: float, turn: Vec3 | None) -> Twin | None:
    """The exact twin, whatever its distance; None if p̈ goes all ways."""
    if len(flight.still) == 0:
        return None
    if len(flight.still) == 1:
        normal = flight.still[0]
        how = f"the mirror image in the plane through the anchor with normal {_along(normal)}"
        return _compared(flight, "mirrored", *_straight(flight, symmetry.mirror(normal)), how)
    chosen = symmetry.allowed(_usual_turn(flight, apart) if turn is None else np.asarray(turn), flight.still)
    angle = float(np.linalg.norm(chosen))
    about = f" about {_along(chosen / angle)}" if angle else ""
    axis = _vec(np.cross(*flight.still)) if len(flight.still) == 2 else None
    how = f"turned by {math.degrees(angle):.3g}°{about} through the anchor"
    return _compared(flight, "turned", *_straight(flight, so3.exp(chosen)), how, turn=_vec(chosen), axis=axis)


def _usual_turn(flight: _Flight, apart: float) -> Array:
    """A right angle, else half a turn, about the first axis that leads far enough; else what leads farthest."""
    axes = symmetry.axes(flight.velocity, flight.up, flight.still)
    turns = [angle * axis for angle in (RIGHT_ANGLE, 2 * RIGHT_ANGLE) for axis in axes]

    def distance(turn: Array) -> float:
        return ambiguity.rms(*_straight(flight, so3.exp(turn)), flight.duration)

    return next((turn for turn in turns if distance(turn) >= apart * ALMOST), max(turns, key=distance))


def _straight(flight: _Flight, matrix: Array) -> tuple[Array, Array]:
    """Δp and Δv of O q − q, where that is straight."""
    change = matrix - np.eye(3)
    return change @ flight.start, change @ flight.velocity


def _rms(flight: _Flight, found: Twin) -> float:
    """m between both motions, RMS over the flight."""
    return ambiguity.rms(found.shift, found.drift, flight.duration)


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
    """The twin with a straight-line difference, its range taken from its own path."""
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
        words=f"{how}: {_distance(nearest, farthest)}, and its range {_agreement(mismatch)}",
    )


def _searched(flight: _Flight, exact: Twin | None, tolerance: float, apart: float) -> Twin | Refusal:
    """A twin that is not exact, or the refusal of any."""
    time = symmetry.moments(flight.duration)
    position, acceleration = flight.path(time) - flight.anchor, flight.path(time, 2)
    found = ambiguity.search(position, acceleration, time, flight.duration, apart=apart)
    worst = [_worst(flight, shift, drift) for shift, drift in zip(found.shift, found.drift, strict=True)]
    best = int(np.argmin(worst))
    if worst[best] <= tolerance:
        shift, drift = found.shift[best], found.drift[best]
        how = f"moved by {_numbers(shift)} m and {_numbers(drift)} m/s"
        return _compared(flight, "nearby", shift, drift, how)
    felt = ambiguity.sensitivity(position, time, flight.duration)
    return _refusal(flight, exact, felt, worst[best], tolerance, apart)


def _worst(flight: _Flight, shift: Array, drift: Array) -> float:
    moved = flight.position + shift + flight.time[:, None] * drift
    return float(np.abs(np.linalg.norm(moved, axis=-1) - np.linalg.norm(flight.position, axis=-1)).max())


def _refusal(
    flight: _Flight, exact: Twin | None, felt: ambiguity.Sensitivity, best: float, tolerance: float, apart: float
) -> Refusal:
    least = float(felt.singular[-1])
    others = f"the best lookalike {apart:g} m away is off by {best:.2g} m, more than the tolerance of {tolerance:g} m"
    if exact is not None and _rms(flight, exact) > ITSELF:
        kind, reason = "too near", f"no twin {apart:g} m away, only this one, {exact.words}; {others}"
    elif least < ambiguity.BLIND:
        later = _worst(flight, apart * felt.shift, apart * felt.drift)
        kind, reason = (
            "locally blind",
            (
                f"locally blind, no twin: to first order no range feels a step along {_along(_unit(felt.shift))}, but "
                f"{ITS_OWN_TWIN[len(flight.still)]}, and {apart:g} m of it changes the range by {later:.2g} m; {others}"
            ),
        )
    else:
        felt_least = f"a metre of the least felt difference changes the range by {least:.2g} m (RMS)"
        kind, reason = "observable", f"no twin: {felt_least}, and {others}"
    return Refusal(kind=kind, reason=reason, sensitivity=least, mismatch=best)


def _agreement(mismatch: float) -> str:
    return "is the same" if mismatch < SAME else f"differs by at most {mismatch:.2g} m"


def _distance(nearest: float, farthest: float) -> str:
    if farthest - nearest <= STEADY * farthest:
        return f"{farthest:.3g} m away throughout"
    return f"{nearest:.3g} to {farthest:.3g} m away"


def _along(direction: Array) -> str:
    """The name of a direction that has no sign."""
    direction = np.where(np.abs(direction) < ZERO, 0.0, direction)
    return blindness.name(direction if direction[np.argmax(np.abs(direction))] > 0 else -direction)


def _unit(vector: Array) -> Array:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else vector


def _numbers(vector: Array) -> str:
    return "(" + ", ".join(f"{value:.2g}" for value in vector) + ")"


def _vec(vector: Array) -> Vec3:
    x, y, z = (float(value) + 0.0 for value in vector)  # no −0
    return (x, y, z)
