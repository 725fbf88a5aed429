"""A signal is converted to another family, so that a visitor who chooses another family starts from a similar signal.

Sines become formulas, and minimum-snap curves become polynomials, without loss. All other conversions sample the
signal: waypoints lie on it, and sums of sines have its strongest frequencies. A family of a few numbers starts from a
signal of its own.
"""

import math
from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import (
    AXES,
    AngularVelocity,
    Family,
    Flown,
    Formula,
    MinimumSnap,
    Multisine,
    Polynomials,
    Signal,
    Tone,
    Waypoint,
    Waypoints,
)
from rangenav.signals.multisine import LETTERS, MAX_FREQUENCY, Axis
from rangenav.signals.polynomials import from_minimum_snap

Conversion = Callable[[Signal, float], AngularVelocity]
"""From a signal and the duration of a flight (s) to a signal of one family that equals or resembles it."""
REST_DURATION = 1.0
"""s; a flown body is converted as a body at rest for this time."""
POINTS = 12
SAMPLES, TONES_PER_AXIS = 512, 2
LEAST_SHARE = 0.02
"""Tones weaker than this share of the strongest one of their axis are left out."""
DECIMALS = 3
"""Decimals of the coordinates of points: millimetres, which are easy to read and to type."""


def converted(signal: AngularVelocity, convert: Conversion, duration: float) -> AngularVelocity:
    """A signal of another family that equals or resembles a signal over a flight of some duration (s).

    The angular velocity of a flown body is unknown without its path, so a flown body is converted as a body at rest.
    """
    return convert(Multisine(), REST_DURATION) if isinstance(signal, Flown) else convert(signal, duration)


def constant(signal: Signal, duration: float) -> Multisine:
    """The signal's value at t = 0."""
    del duration
    return Multisine(offset=_rounded(signal(np.zeros(()))))


def flown(signal: Signal, duration: float) -> Flown:
    """The angular velocity with which a multirotor flies the path, without yaw."""
    del signal, duration
    return Flown()


def replaced(signal: Signal, duration: float, *, first: Family) -> Family:
    """The signal itself if it is of the family of `first`, else `first`: numbers alone do not imitate any signal."""
    del duration
    return signal if isinstance(signal, type(first)) else first


def sines(signal: Signal, duration: float) -> Multisine:
    """The strongest tones of the signal over its period, or over the flight."""
    if isinstance(signal, Multisine):
        return signal
    length = signal.period or duration
    values = signal(np.arange(SAMPLES) * (length / SAMPLES))
    spectrum = 2 * np.fft.rfft(values, axis=0)[: SAMPLES // 2] / SAMPLES
    tones = [tone for axis in LETTERS for tone in _strongest(spectrum[:, AXES[axis]], axis, 2 * math.pi / length)]
    return Multisine(tones=tuple(tones), offset=_rounded(spectrum[0].real / 2))


def _strongest(line: Array, axis: Axis, fundamental: float) -> list[Tone]:
    strength = np.abs(line)
    strength[0] = 0
    chosen = sorted(np.argsort(strength)[::-1][:TONES_PER_AXIS].tolist())
    return [
        Tone(
            axis=axis,
            amplitude=float(f"{strength[k]:.4g}"),
            frequency=min(k * fundamental, MAX_FREQUENCY),
            phase=float(f"{np.angle(line[k]) + math.pi / 2:.4g}"),
        )
        for k in chosen
        if strength[k] > max(LEAST_SHARE * strength.max(), 1e-9)
    ]


def formula(signal: Signal, duration: float) -> Formula:
    """Sines as a formula, term by term; anything else through its sines."""
    if isinstance(signal, Formula):
        return signal
    wave = sines(signal, duration)
    x, y, z = (" + ".join(_term(tone) for tone in wave.tones if tone.axis == axis) or "0" for axis in AXES)
    return Formula(x=x, y=y, z=z, offset=wave.offset, drift=wave.drift)


def _term(tone: Tone) -> str:
    phase = "" if tone.phase == 0 else f" + {tone.phase!r}" if tone.phase > 0 else f" - {-tone.phase!r}"
    amplitude = repr(tone.amplitude) if tone.amplitude >= 0 else f"({tone.amplitude!r})"
    return f"{amplitude}*sin({tone.frequency!r}*t{phase})"


def waypoints(signal: Signal, duration: float) -> Waypoints:
    """Points where the signal passes: closed over its period, or open over the flight."""
    if isinstance(signal, Waypoints):
        return signal
    if isinstance(signal, MinimumSnap):
        return Waypoints(points=signal.points, period=signal.period, free_ends=signal.free_ends)
    return Waypoints(points=_points_on(signal, duration), period=signal.period or None)


def minimum_snap(signal: Signal, duration: float) -> MinimumSnap:
    """The minimum-snap curve through the same points, or through points where the signal passes."""
    if isinstance(signal, MinimumSnap):
        return signal
    if isinstance(signal, Waypoints):
        return MinimumSnap(points=signal.points, period=signal.period, free_ends=signal.free_ends)
    return MinimumSnap(points=_points_on(signal, duration), period=signal.period or None)


def polynomials(signal: Signal, duration: float) -> Polynomials:
    """A minimum-snap curve piece by piece, or such a curve through points where the signal passes."""
    if isinstance(signal, Polynomials):
        return signal
    curve = minimum_snap(signal, duration)
    if curve.period is not None and curve.points[0].time > 0:  # pieces that repeat begin at t = 0
        curve = MinimumSnap(points=_points_on(curve, duration), period=curve.period)
    return from_minimum_snap(curve)


def _points_on(signal: Signal, duration: float) -> tuple[Waypoint, ...]:
    """Twelve points over the period, the first not repeated, or over the flight."""
    time = np.linspace(0, duration, POINTS) if not signal.period else np.arange(POINTS) * (signal.period / POINTS)
    time = np.round(time, DECIMALS)
    return tuple(Waypoint(time=float(t), value=_rounded(value)) for t, value in zip(time, signal(time), strict=True))


def _rounded(value: Float[Array, "3"]) -> tuple[float, float, float]:
    x, y, z = (float(entry) + 0.0 for entry in np.round(value, DECIMALS))
    return x, y, z
