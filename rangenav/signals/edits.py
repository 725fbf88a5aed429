"""Edits of a whole signal: slowed, started elsewhere, moved, scaled, turned, mirrored, centred.

Pure functions signal -> signal. Each family stays what it is: a rotated Multisine is a Multisine, a mirrored path of
waypoints keeps its waypoints, and a formula keeps its text. Only a start with another velocity makes a Sum of what has
no drift of its own.
"""

import cmath
import math
from functools import lru_cache
from typing import Literal, TypeVar, cast

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3, require
from rangenav.signals.families import Family, Signal, Sum
from rangenav.signals.formula import Formula, Rows
from rangenav.signals.multisine import AXES, Multisine, Tone
from rangenav.signals.polynomials import Coefficients, Piece, Polynomials
from rangenav.signals.waypoints import MinimumSnap, Waypoints

AnySignal = TypeVar("AnySignal", bound=Signal)
LETTERS: tuple[Literal["x", "y", "z"], ...] = ("x", "y", "z")
SILENT = 1e-15
"""A tone that a rotation leaves with this share of its amplitude is rounding."""
BOX_SAMPLES = 2001


def slowed(signal: AnySignal, factor: float) -> AnySignal:
    """The same geometry run `factor` times slower: s(t / factor). Its snap falls by factor⁻⁴, μ over a period by ⁻⁷."""
    require(math.isfinite(factor) and factor > 0, f"the time scale must be a positive number, got {factor}")
    replace = msgspec.structs.replace
    match signal:
        case Multisine():
            tones = tuple(replace(tone, frequency=tone.frequency / factor) for tone in signal.tones)
            return cast(AnySignal, replace(signal, tones=tones, drift=_over(signal.drift, factor)))
        case Formula():
            return cast(AnySignal, replace(signal, slower=signal.slower * factor, drift=_over(signal.drift, factor)))
        case Waypoints() | MinimumSnap():
            points = tuple(replace(point, time=point.time * factor) for point in signal.points)
            period = None if signal.period is None else signal.period * factor
            return cast(AnySignal, replace(signal, points=points, period=period))
        case Polynomials():
            return cast(
                AnySignal, replace(signal, pieces=tuple(_slowed_piece(piece, factor) for piece in signal.pieces))
            )
        case Sum():
            base, wiggle = slowed(signal.base, factor), slowed(signal.wiggle, factor)
            return cast(AnySignal, replace(signal, base=base, wiggle=wiggle, drift=_over(signal.drift, factor)))
    raise TypeError(type(signal))


def started_at(signal: Signal, *, position: Vec3, velocity: Vec3) -> Signal:
    """The signal shifted and drifting so that it has the given value and rate at t = 0; higher derivatives are kept."""
    if isinstance(signal, Waypoints | MinimumSnap | Polynomials):
        signal = Sum(base=signal, wiggle=Multisine())
    zero = np.zeros(())
    offset = np.asarray(signal.offset) + np.asarray(position) - signal(zero)
    drift = np.asarray(signal.drift) + np.asarray(velocity) - signal(zero, 1)
    return msgspec.structs.replace(signal, offset=_vec(offset), drift=_vec(drift))


@lru_cache(maxsize=64)
def bent(signal: Signal) -> Signal:
    """The signal without offset and drift: what is left is all that second and higher derivatives know of it.

    What has neither is moved to begin at 0, so that far-off places cost no digits.
    """
    nothing = (0.0, 0.0, 0.0)
    match signal:
        case Multisine() | Formula():
            return msgspec.structs.replace(signal, offset=nothing, drift=nothing)
        case Sum():
            base, wiggle = cast(Family, bent(signal.base)), cast(Family, bent(signal.wiggle))
            return Sum(base=base, wiggle=wiggle)
        case _:
            return moved(signal, _vec(-signal(np.zeros(()))))


def moved(signal: AnySignal, shift: Vec3) -> AnySignal:
    """The signal plus a constant."""
    return mapped(signal, np.eye(3), np.asarray(shift))


def scaled(signal: AnySignal, factor: float, *, about: Vec3) -> AnySignal:
    """The path `factor` times as large, seen from a point that stays."""
    require(math.isfinite(factor) and factor != 0, f"the factor must be a number other than 0, got {factor}")
    return _about(signal, factor * np.eye(3), about)


def rotated(signal: AnySignal, rotation: Float[Array, "3 3"], *, about: Vec3) -> AnySignal:
    """The path turned by a rotation matrix about a point that stays."""
    return _about(signal, rotation, about)


def mirrored(signal: AnySignal, normal: Vec3, *, about: Vec3) -> AnySignal:
    """The path seen in a mirror with this normal through a point."""
    n = np.asarray(normal, dtype=float)
    require(bool(n @ n > 0), "a mirror's normal must not be zero")
    return _about(signal, np.eye(3) - 2 * np.outer(n, n) / (n @ n), about)


def centred(signal: AnySignal, point: Vec3, *, duration: float) -> AnySignal:
    """The path moved so that the middle of the box around it, from 0 to duration (s), lies at the point."""
    places = signal(np.linspace(0, duration, BOX_SAMPLES))
    return moved(signal, _vec(np.asarray(point) - (places.min(axis=0) + places.max(axis=0)) / 2))


def mapped(signal: AnySignal, matrix: Float[Array, "3 3"], shift: Float[Array, "3"]) -> AnySignal:
    """matrix · signal + shift."""
    replace = msgspec.structs.replace
    match signal:
        case Multisine():
            offset, drift = _vec(matrix @ signal.offset + shift), _vec(matrix @ signal.drift)
            return cast(AnySignal, replace(signal, tones=_mixed(signal.tones, matrix), offset=offset, drift=drift))
        case Formula():
            x, y, z = (_vec(row) for row in matrix @ np.asarray(signal.mix))
            mix: Rows = (x, y, z)
            offset, drift = _vec(matrix @ signal.offset + shift), _vec(matrix @ signal.drift)
            return cast(AnySignal, replace(signal, mix=mix, offset=offset, drift=drift))
        case Waypoints() | MinimumSnap():
            points = tuple(replace(point, value=_vec(matrix @ point.value + shift)) for point in signal.points)
            return cast(AnySignal, replace(signal, points=points))
        case Polynomials():
            return cast(AnySignal, replace(signal, pieces=tuple(_mixed_piece(p, matrix, shift) for p in signal.pieces)))
        case Sum():
            base, wiggle = mapped(signal.base, matrix, np.zeros(3)), mapped(signal.wiggle, matrix, np.zeros(3))
            offset, drift = _vec(matrix @ signal.offset + shift), _vec(matrix @ signal.drift)
            return cast(AnySignal, replace(signal, base=base, wiggle=wiggle, offset=offset, drift=drift))
    raise TypeError(type(signal))


def _about(signal: AnySignal, matrix: Array, about: Vec3) -> AnySignal:
    return mapped(signal, matrix, np.asarray(about) - matrix @ np.asarray(about))


def _mixed(tones: tuple[Tone, ...], matrix: Array) -> tuple[Tone, ...]:
    """Tones of one frequency add as phasors; a matrix that mixes no axes keeps every tone and its phase."""
    if np.count_nonzero(matrix - np.diag(np.diagonal(matrix))) == 0:
        factors = {axis: float(matrix[k, k]) for axis, k in AXES.items()}
        return tuple(msgspec.structs.replace(tone, amplitude=factors[tone.axis] * tone.amplitude) for tone in tones)
    found: list[Tone] = []
    for frequency in dict.fromkeys(tone.frequency for tone in tones):
        together = [tone for tone in tones if tone.frequency == frequency]
        phasors = np.zeros(3, dtype=complex)
        for tone in together:
            phasors[AXES[tone.axis]] += cmath.rect(tone.amplitude, tone.phase)
        largest = sum(abs(tone.amplitude) for tone in together) * float(np.abs(matrix).max())
        for axis, phasor in zip(LETTERS, (matrix @ phasors).tolist(), strict=True):
            if abs(phasor) > SILENT * largest:
                found.append(Tone(axis=axis, amplitude=abs(phasor), frequency=frequency, phase=cmath.phase(phasor)))
    return tuple(found)


def _mixed_piece(piece: Piece, matrix: Array, shift: Array) -> Piece:
    table = matrix @ np.array([piece.x, piece.y, piece.z])
    table[:, 0] += shift
    x, y, z = (cast(Coefficients, tuple(row.tolist())) for row in table)
    return msgspec.structs.replace(piece, x=x, y=y, z=z)


def _slowed_piece(piece: Piece, factor: float) -> Piece:
    table = np.array([piece.x, piece.y, piece.z, piece.yaw]) / factor ** np.arange(8)
    x, y, z, yaw = (cast(Coefficients, tuple(row.tolist())) for row in table)
    return Piece(duration=piece.duration * factor, x=x, y=y, z=z, yaw=yaw)


def _over(vector: Vec3, factor: float) -> Vec3:
    x, y, z = vector
    return (x / factor, y / factor, z / factor)


def _vec(vector: Array) -> Vec3:
    x, y, z = (float(value) for value in vector)
    return (x, y, z)
