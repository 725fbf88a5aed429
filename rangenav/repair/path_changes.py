"""Changes of a path itself, without added tones: of its size, the frequencies of its tones, its speed, its waypoints.

amplitude   one factor per axis, about the middle of the path
frequency   one factor per frequency of the path's own tones
timescale   one factor: the same geometry, run slower or faster
waypoints   points moved by sine and cosine waves over their indices
"""

import math

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import signals
from rangenav.inputs import Vec3
from rangenav.preset import MAX_DURATION, Preset
from rangenav.repair.change import Change, ChangeKind, with_path
from rangenav.signals import MinimumSnap, Multisine, Signal, Sum, Tone, Waypoints

MOST_FACTOR = 4.0
"""The largest factor by which sizes, frequencies and times are changed."""
MOST_MOVED = 3.0
"""m: the largest coefficient of a wave by which waypoints are moved."""
WAVES = 3
"""Waypoints are moved by waves of one, two and three periods over the path."""
BOX_SAMPLES = 401


def amplitude(preset: Preset) -> Change:
    """The path stretched along each axis about the middle of its box; θ = log factors of x, y, z."""
    places = preset.path(np.linspace(0, preset.duration, BOX_SAMPLES))
    middle, size = (places.max(axis=0) + places.min(axis=0)) / 2, np.ptp(places, axis=0)
    moves = size > 1e-9 * max(1.0, float(size.max()))

    def make(theta: Array) -> Preset:
        factors = np.where(moves, np.exp(theta), 1.0)
        return with_path(preset, preset.path.mapped(np.diag(factors), middle - factors * middle))

    return Change(
        box=_factors(3),
        make=make,
        effort=lambda theta: float(np.linalg.norm(theta[moves])),
        description=lambda theta: (
            "scaled " + _listed([f"{a} by {math.exp(t):.3g}" for a, t in zip("xyz", theta, strict=True)])
        ),
        rounded=_round_factors,
        rays=_corners(np.array([moves, *np.diag(moves)], dtype=float)),
    )


def frequency(preset: Preset) -> Change:
    """The path's own tones faster or slower, each frequency by its own factor; θ = log factors, by rising frequency."""
    own = own_tones(preset.path)
    frequencies = sorted({tone.frequency for tone in own})

    def make(theta: Array) -> Preset:
        factors = dict(zip(frequencies, np.exp(theta).tolist(), strict=True))
        tones = tuple(
            msgspec.structs.replace(tone, frequency=float(f"{tone.frequency * factors[tone.frequency]:.3g}"))
            for tone in own
        )
        return with_path(preset, _with_own_tones(preset.path, tones))

    return Change(
        box=_factors(len(frequencies)),
        make=make,
        effort=lambda theta: float(np.linalg.norm(theta)),
        description=lambda theta: (
            "changed "
            + _listed(
                [
                    f"{w:g} to {w * math.exp(t):.3g} rad/s"
                    for w, t in zip(frequencies, theta, strict=True)
                    if abs(t) > 1e-3
                ]
            )
        ),
        rounded=lambda theta: np.array(
            [math.log(float(f"{w * math.exp(t):.3g}") / w) for w, t in zip(frequencies, theta, strict=True)]
        ),
        rays=_corners(np.vstack([np.eye(len(frequencies)), np.ones((1, len(frequencies)))])),
    )


def timescale(preset: Preset) -> Change:
    """The same geometry flown faster or slower; θ = (log factor). Without a period the duration changes too."""

    def make(theta: Array) -> Preset:
        factor = math.exp(float(theta[0]))
        duration = preset.duration
        if preset.path.period is None:
            duration = min(MAX_DURATION, duration * factor)
        return msgspec.structs.replace(preset, path=signals.slowed(preset.path, factor), duration=duration)

    def description(theta: Array) -> str:
        factor = math.exp(float(theta[0]))
        return f"run {factor:.3g} times slower" if factor > 1 else f"run {1 / factor:.3g} times faster"

    return Change(
        box=_factors(1),
        make=make,
        effort=lambda theta: abs(float(theta[0])),
        description=description,
        rounded=_round_factors,
        rays=_corners(np.ones((1, 1))),
    )


def waypoints(preset: Preset, directions: tuple[Float[Array, "3"], ...]) -> Change:
    """Waypoints moved along directions by waves over their indices; θ = a coefficient (m) per direction and wave."""
    base = _curve(preset.path)
    turn = np.arange(len(base.points)) / len(base.points)
    waves = [wave(2 * math.pi * j * turn) for j in range(1, WAVES + 1) for wave in (np.cos, np.sin)]
    waves = [wave for wave in waves if np.linalg.norm(wave) > 1e-9]
    patterns = np.array([np.outer(wave, n) for n in directions for wave in waves])  # (θ, points, 3)

    def moved(theta: Array) -> Array:
        return np.round(np.tensordot(theta, patterns, axes=1), 3)  # millimetres

    def make(theta: Array) -> Preset:
        points = tuple(
            msgspec.structs.replace(point, value=_vec(np.asarray(point.value) + step))
            for point, step in zip(base.points, moved(theta), strict=True)
        )
        return with_path(preset, _with_curve(preset.path, msgspec.structs.replace(base, points=points)))

    def description(theta: Array) -> str:
        size = np.linalg.norm(moved(theta), axis=1)
        return f"moved {int(np.sum(size > 0))} waypoints by up to {size.max():.3g} m"

    count = len(patterns)
    return Change(
        box=np.array([[-MOST_MOVED, MOST_MOVED]] * count),
        make=make,
        effort=lambda theta: float(np.sqrt(np.mean(np.sum(moved(theta) ** 2, axis=1)))),
        description=description,
        rounded=lambda theta: np.round(theta, 3),
        rays=tuple(MOST_MOVED * row for row in np.eye(count)),
    )


def own_tones(path: Signal) -> tuple[Tone, ...]:
    """The tones of a Multisine, or of the wiggle of a Sum; none for other families."""
    match path:
        case Multisine(tones=tones) | Sum(wiggle=Multisine(tones=tones)):
            return tones
        case _:
            return ()


def refusal(kind: ChangeKind, preset: Preset) -> str | None:
    """Why a kind of change is impossible for a path, as one clause; None if it can be tried."""
    path = preset.path
    if kind == "frequency" and not own_tones(path):
        return "the path has no tones whose frequency could be changed"
    if kind == "waypoints" and not isinstance(_holder(path), Waypoints | MinimumSnap):
        return "the path has no waypoints that could be moved"
    if kind == "tones" and isinstance(path, Sum) and not isinstance(path.wiggle, Multisine):
        return "the path is a sum already, and neither part of it takes tones"
    if kind in ("amplitude", "timescale") and path.period == 0:
        return "the path does not bend, and stays straight at any size and speed"
    return None


def _holder(path: Signal) -> Signal:
    return path.base if isinstance(path, Sum) else path


def _curve(path: Signal) -> Waypoints | MinimumSnap:
    held = _holder(path)
    if not isinstance(held, Waypoints | MinimumSnap):
        raise ValueError("the path has no waypoints that could be moved")
    return held


def _with_curve(path: Signal, curve: Waypoints | MinimumSnap) -> Signal:
    return msgspec.structs.replace(path, base=curve) if isinstance(path, Sum) else curve


def _with_own_tones(path: Signal, tones: tuple[Tone, ...]) -> Signal:
    if isinstance(path, Sum):
        return msgspec.structs.replace(path, wiggle=msgspec.structs.replace(path.wiggle, tones=tones))
    return msgspec.structs.replace(path, tones=tones)


def _factors(count: int) -> Float[Array, "n 2"]:
    return np.array([[-1.0, 1.0]] * count) * math.log(MOST_FACTOR)


def _corners(rows: Float[Array, "k n"]) -> tuple[Array, ...]:
    """The ends of the rays: each row with both signs, scaled to the largest factor."""
    return tuple(sign * math.log(MOST_FACTOR) * row for row in rows for sign in (1, -1) if np.any(row))


def _round_factors(theta: Array) -> Array:
    return np.array([math.log(float(f"{math.exp(t):.3g}")) for t in theta])


def _listed(parts: list[str]) -> str:
    return " and ".join(parts)


def _vec(vector: Array) -> Vec3:
    x, y, z = (float(value) for value in vector)
    return (x, y, z)
