"""Tones added to a path: the tones of a first search with free amplitudes and phases, or three free tones."""

import math

import numpy as np
from numpy import ndarray as Array

from rangenav.certificate import tone_search
from rangenav.certificate.tone_search import STANDARD_GRAVITY, Added, upwards, with_tones
from rangenav.observability import blindness
from rangenav.preset import Preset
from rangenav.repair.change import Change, with_path
from rangenav.signals import Tone
from rangenav.signals.multisine import LETTERS

MOST_ACCELERATION = 10.0
"""m/s², of one added tone: about a weight."""


def searched_tones(preset: Preset, added: Added) -> Change:
    """The tones of a first search, each with a free amplitude and phase; θ = (amplitudes, phases)."""
    count = len(added.directions)
    weights = np.array([1 + w**2 / STANDARD_GRAVITY for w in added.frequencies])

    def added_tones(theta: Array) -> tuple[Tone, ...]:
        return tuple(
            Tone(axis=axis, amplitude=float(theta[i] * n[k]), frequency=w, phase=float(theta[count + i]))
            for i, (n, w) in enumerate(zip(added.directions, added.frequencies, strict=True))
            for k, axis in enumerate(LETTERS)
            if n[k] != 0
        )

    def description(theta: Array) -> str:
        each = [
            f"{theta[i]:g} m at {w:g} rad/s along {blindness.name(n)} with phase {theta[count + i]:g}"
            for i, (n, w) in enumerate(zip(added.directions, added.frequencies, strict=True))
        ]
        return f"added {'a tone' if count == 1 else 'tones'} of " + " and ".join(each)

    def rounded(theta: Array) -> Array:
        return np.array([_up(a, 3) for a in theta[:count]] + [round(float(a), 2) for a in theta[count:]])

    most = [[0.0, 3 * added.amplitude]] * count + [[-math.pi, math.pi]] * count
    return Change(
        box=np.array(most),
        make=lambda theta: with_path(preset, with_tones(preset.path, added_tones(theta))),
        effort=lambda theta: float(np.linalg.norm(theta[:count] * weights)),
        description=description,
        rounded=lambda theta: np.array(
            [_up(a, 3) for a in theta[:count]] + [round(float(a), 2) for a in theta[count:]]
        ),
        rays=(np.array([2 * added.amplitude] * count + [0.0] * count),),
    )


def free_tones(preset: Preset, *, repeats: bool = False) -> Change:
    """One free tone for each axis; θ = (accelerations, frequencies, phases). repeats: they keep the path's period."""
    candidates = tone_search.candidates(preset, repeats=repeats)
    slowest, fastest = 0.5 * candidates[0], 1.5 * candidates[-1]
    period = preset.path.period
    # half the fundamental: what repeats still repeats, in two periods at most
    step = (2 if repeats else 1) * math.pi / period if period else 0.1

    def snapped(w: float) -> float:
        return float(f"{step * max(1, round(w / step)):.12g}")

    def added_tones(theta: Array) -> tuple[Tone, ...]:
        w = [snapped(float(value)) for value in theta[3:6]]
        return tuple(
            Tone(axis=axis, amplitude=float(theta[k]) / w[k] ** 2, frequency=w[k], phase=float(theta[6 + k]))
            for k, axis in enumerate(LETTERS)
        )

    def kept_tones(theta: Array) -> tuple[Tone, ...]:
        return tuple(tone for tone in added_tones(theta) if tone.amplitude >= tone_search.LEAST_AMPLITUDE)

    def effort(theta: Array) -> float:
        return math.hypot(*(tone.amplitude * (1 + tone.frequency**2 / STANDARD_GRAVITY) for tone in added_tones(theta)))

    def description(theta: Array) -> str:
        each = [
            f"{tone.amplitude:.3g} m at {tone.frequency:g} rad/s along {tone.axis} with phase {tone.phase:g}"
            for tone in kept_tones(theta)
        ]
        if not each:
            return "the motion as it is"
        return f"added {'a tone' if len(each) == 1 else 'tones'} of " + " and ".join(each)

    def rounded(theta: Array) -> Array:
        w = np.array([snapped(float(value)) for value in theta[3:6]])
        sizes = [_up(float(a), 3) * v**2 for a, v in zip(theta[:3] / w**2, w, strict=True)]
        return np.concatenate([sizes, w, np.round(theta[6:], 2)])

    box = [[0.0, MOST_ACCELERATION]] * 3 + [[slowest, fastest]] * 3 + [[0.0, 2 * math.pi]] * 3
    return Change(
        box=np.array(box),
        make=lambda theta: with_path(preset, with_tones(preset.path, kept_tones(theta))),
        effort=effort,
        description=description,
        rounded=rounded,
        rays=tuple(
            np.concatenate([MOST_ACCELERATION * axis, [w] * 3, [0.0] * 3]) for axis in np.eye(3) for w in candidates
        ),
        grows=np.array([True] * 3 + [False] * 6),
    )


def _up(value: float, digits: int) -> float:
    return upwards(value, digits) if value > 0 else 0.0
