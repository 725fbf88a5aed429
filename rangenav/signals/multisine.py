"""A Multisine: offset + drift t + Σ A sin(w t + phase) on each axis.

Its k-th derivative is Σ A wᵏ sin(w t + phase + k π/2): one formula, so snap is as exact as position.
"""

import cmath
import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Literal

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Input, Vec3, require, require_within
from rangenav.signals.base import ROUNDING_MARGIN, SignalBase, add_line, divided, vector

AXES = {"x": 0, "y": 1, "z": 2}
Axis = Literal["x", "y", "z"]
LETTERS: tuple[Axis, ...] = ("x", "y", "z")
SILENT = 1e-15
"""A tone that a rotation leaves with this share of its amplitude is rounding."""
MAX_TONES = 64
MAX_AMPLITUDE = 1e4
MAX_OFFSET = 1e6
MAX_DRIFT = 1e5
"""With larger values, or a larger amplitude, no vehicle flies, and fourth powers would overflow."""
MIN_FREQUENCY, MAX_FREQUENCY = 1e-6, 1e4
"""rad/s; slower tones would repeat after months. Tones beyond the IMU's Nyquist frequency are refused by the preset,
which knows the rate."""
COMMON_PERIOD_DENOMINATOR = 1000
"""Frequencies whose ratios are fractions with a larger denominator are taken to have no common period."""


class Tone(Input, frozen=True, kw_only=True):
    """One sine on one axis: amplitude · sin(frequency · t + phase)."""

    axis: Axis
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


class Multisine(SignalBase, frozen=True, kw_only=True, tag="multisine", tag_field="kind"):
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
        if order == 0 and any(self.offset + self.drift):
            value += np.asarray(self.offset) + t[..., None] * np.asarray(self.drift)
        elif order == 1 and any(self.drift):
            value += np.asarray(self.drift)
        for tone in self.tones:
            sine = np.sin(tone.frequency * t + (tone.phase + order * math.pi / 2))
            sine *= tone.amplitude * tone.frequency**order
            value[..., AXES[tone.axis]] += sine
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
        return math.hypot(*sums)  # whose squares do not underflow to a bound of 0

    @property
    def period(self) -> float | None:
        """The common period (s) of all tones, 0 if there are none, None if their frequencies share none.

        Drift is left out: what depends on second and higher derivatives repeats all the same.
        """
        return common_period([tone.frequency for tone in self.tones if tone.amplitude != 0])

    def bandwidth_until(self, time: float) -> float:
        """The highest frequency present (rad/s), at any time."""
        return self.bandwidth

    @property
    def bound_stretches(self) -> int:
        """One bound holds at all times."""
        return 1

    def derivative_bounds(self, edges: Float[Array, "k"], orders: range) -> Float[Array, "o m"]:
        """`bound` of each order, on every stretch between neighbouring edges (s)."""
        constant = np.array([self.bound(order) for order in orders]) * ROUNDING_MARGIN
        return np.repeat(constant[:, None], len(edges) - 1, axis=1)

    def rounding_bound(self, edges: Float[Array, "k"]) -> float:
        """Σ|A| (w t + |phase| + 2) of each axis for its sines and their angles, and for the sum of so many of them."""
        latest = float(np.abs(edges[[0, -1]]).max())
        sums = (np.abs(self.offset) + latest * np.abs(self.drift)) * 2
        for tone in self.tones:
            turned = tone.frequency * latest + abs(tone.phase) + 2 + len(self.tones)
            sums[AXES[tone.axis]] += abs(tone.amplitude) * turned
        return math.hypot(*sums)

    def jet(self, t: Float[Array, "n"], highest: int) -> Float[Array, "o n 3"]:
        """The signal and its derivatives up to the highest order (1 at least): one sine and one cosine a tone."""
        every = np.zeros((highest + 1, len(t), 3))
        add_line(every, t, offset=self.offset, drift=self.drift)
        for tone in self.tones:
            angle = tone.frequency * t + tone.phase
            waves = np.sin(angle), np.cos(angle)
            for order in range(highest + 1):
                sign = -1.0 if order % 4 > 1 else 1.0  # sin, cos, −sin, −cos, and round again
                every[order, :, AXES[tone.axis]] += sign * tone.amplitude * tone.frequency**order * waves[order % 2]
        return every

    def operations(self) -> int:
        """There is no formula."""
        return 0

    def piecewise(self) -> None:
        """Sines are no polynomials."""
        return

    def slowed(self, factor: float) -> "Multisine":
        """The signal s(t / factor)."""
        tones = tuple(msgspec.structs.replace(tone, frequency=tone.frequency / factor) for tone in self.tones)
        return msgspec.structs.replace(self, tones=tones, drift=divided(self.drift, factor))

    def mapped(self, matrix: Float[Array, "3 3"], shift: Float[Array, "3"]) -> "Multisine":
        """matrix · signal + shift."""
        offset, drift = vector(matrix @ self.offset + shift), vector(matrix @ self.drift)
        return msgspec.structs.replace(self, tones=_mixed(self.tones, matrix), offset=offset, drift=drift)

    def curved_part(self) -> "Multisine":
        """The tones alone."""
        return msgspec.structs.replace(self, offset=(0.0, 0.0, 0.0), drift=(0.0, 0.0, 0.0))


def _mixed(tones: tuple[Tone, ...], matrix: Array) -> tuple[Tone, ...]:
    """Tones of one frequency add as phasors; a matrix that mixes no axes keeps every tone and its phase."""
    if np.count_nonzero(matrix - np.diag(np.diagonal(matrix))) == 0:
        factors = {axis: float(matrix[k, k]) for axis, k in AXES.items()}
        return tuple(msgspec.structs.replace(tone, amplitude=factors[tone.axis] * tone.amplitude) for tone in tones)
    mixed: list[Tone] = []
    for frequency in dict.fromkeys(tone.frequency for tone in tones):
        together = [tone for tone in tones if tone.frequency == frequency]
        phasors = np.zeros(3, dtype=complex)
        for tone in together:
            phasors[AXES[tone.axis]] += cmath.rect(tone.amplitude, tone.phase)
        largest = sum(abs(tone.amplitude) for tone in together) * float(np.abs(matrix).max())
        for axis, phasor in zip(LETTERS, (matrix @ phasors).tolist(), strict=True):
            if abs(phasor) > SILENT * largest:
                mixed.append(Tone(axis=axis, amplitude=abs(phasor), frequency=frequency, phase=cmath.phase(phasor)))
    return tuple(mixed)


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
