"""A Multisine: offset + drift t + Σ A sin(w t + phase) on each axis.

Its k-th derivative is Σ A wᵏ sin(w t + phase + k π/2): one formula, so snap is as exact as position.
"""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Input, Vec3, require, require_within

AXES = {"x": 0, "y": 1, "z": 2}
MAX_TONES = 64
MAX_AMPLITUDE = 1e4
MAX_OFFSET = 1e6
MAX_DRIFT = 1e5
"""Beyond these, and the amplitude above, nothing flies, and squares of squares would overflow."""
MIN_FREQUENCY, MAX_FREQUENCY = 1e-6, 1e4
"""rad/s; slower tones would repeat after months. Tones beyond the IMU's Nyquist frequency are refused by the preset,
which knows the rate."""
COMMON_PERIOD_DENOMINATOR = 1000
"""Frequencies whose ratios are fractions with a larger denominator are taken to have no common period."""


class Tone(Input, frozen=True, kw_only=True):
    """One sine on one axis: amplitude · sin(frequency · t + phase)."""

    axis: Literal["x", "y", "z"]
    amplitude: float
    """In the signal's unit (m for a path, rad/s for an angular velocity)."""
    frequency: float
    """rad/s, positive."""
    phase: float = 0.0
    """rad; π/2 makes it a cosine."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("amplitude", self.amplitude, -MAX_AMPLITUDE, MAX_AMPLITUDE)
        require_within("frequency", self.frequency, MIN_FREQUENCY, MAX_FREQUENCY, "rad/s")


class Multisine(Input, frozen=True, kw_only=True, tag="multisine", tag_field="kind"):
    """offset + drift · t + tones, with every derivative."""

    tones: tuple[Tone, ...] = ()
    offset: Vec3 = (0.0, 0.0, 0.0)
    """In the signal's unit."""
    drift: Vec3 = (0.0, 0.0, 0.0)
    """The signal's unit per second."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(len(self.tones) <= MAX_TONES, f"at most {MAX_TONES} tones, got {len(self.tones)}")
        for name, limit in (("offset", MAX_OFFSET), ("drift", MAX_DRIFT)):
            for value in getattr(self, name):
                require_within(name, value, -limit, limit)

    def __call__(self, t: Float[Array, "*n"], order: int = 0) -> Float[Array, "*n 3"]:
        """The derivative of the given order at times t (s), in the signal's unit per s**order."""
        t = np.asarray(t, dtype=float)
        value = np.zeros((*t.shape, 3))
        if order == 0:
            value += np.asarray(self.offset) + t[..., None] * np.asarray(self.drift)
        elif order == 1:
            value += np.asarray(self.drift)
        for tone in self.tones:
            sine = np.sin(tone.frequency * t + (tone.phase + order * math.pi / 2))
            value[..., AXES[tone.axis]] += tone.amplitude * tone.frequency**order * sine
        return value

    @property
    def bandwidth(self) -> float:
        """The highest frequency present (rad/s), 0 without tones."""
        return max((tone.frequency for tone in self.tones), default=0.0)

    def bound(self, order: int) -> float:
        """A bound on |signal(t, order)| for every t: the norm of Σ|A| wᵏ per axis. Infinite if it drifts at order 0."""
        if order == 0 and any(self.drift):
            return math.inf
        sums = np.zeros(3) if order > 1 else np.abs(self.offset if order == 0 else self.drift)
        for tone in self.tones:
            sums[AXES[tone.axis]] += abs(tone.amplitude) * tone.frequency**order
        return float(np.linalg.norm(sums))

    @property
    def period(self) -> float | None:
        """The common period (s) of all tones, 0 if there are none, None if their frequencies share none.

        Drift is left out: what depends on second and higher derivatives repeats all the same.
        """
        return common_period([tone.frequency for tone in self.tones if tone.amplitude != 0])


def common_period(frequencies: Sequence[float]) -> float | None:
    """The shortest time (s) in which each frequency (rad/s) makes whole turns; 0 without any, None if there is none."""
    if not frequencies:
        return 0.0
    first = frequencies[0]
    ratios = [Fraction(w / first).limit_denominator(COMMON_PERIOD_DENOMINATOR) for w in frequencies]
    if any(abs(float(r) - w / first) > 1e-12 * float(w / first) for r, w in zip(ratios, frequencies, strict=True)):
        return None
    divisor = Fraction(math.gcd(*(r.numerator for r in ratios)), math.lcm(*(r.denominator for r in ratios)))
    return 2 * math.pi / (first * float(divisor))
