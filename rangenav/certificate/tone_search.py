"""The smallest tones that make a path meet its requirements, from a search over a few frequencies.

A direction n that is not excited needs a tone A sin(wt) along n: nᵀWn grows by about ½δA²w⁸, and σ falls with A. Two
directions need two frequencies, three need three: tones of one frequency on all axes trace an ellipse, which is planar.
"""

import math
from collections.abc import Iterator, Sequence

import msgspec
import numpy as np
import scipy.linalg
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.certificate.figures import Figures, figures, shortfall
from rangenav.observability import excitation
from rangenav.observability.excitation_bound import oriented
from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Multisine, Signal, Sum, Tone
from rangenav.signals.multisine import LETTERS

LEAST_TURN = 6.0
"""rad; a tone that turns less in a window cannot be distinguished from a cubic."""
HARMONICS, TURNS = (1.0, 1.5, 2.0, 2.5, 3.0), (2.0, 3.0)
"""Candidate frequencies: multiples of the path's own `pace`, and multiples of the slowest, LEAST_TURN / window."""
SPREAD, WHOLE = (1.0, 1.5, 2.0), (1.0, 2.0, 3.0)
"""Frequencies of two or three added tones, relative to each other; the second where they keep the path's period."""
LEAST_AMPLITUDE, MOST_AMPLITUDE, MOST_OF_PATH = 1e-3, 4.0, 0.25
"""m, m, and a share of a path's longest side: a controller does not follow smaller tones, and tones larger than the
larger of the two make another path."""
WORK, WORK_PER_TRY, WORK_PER_OPERATION = 1e8, 1e5, 4e4
"""The work of a search, of one trial, and of one operation of a formula; a long formula is tried less often."""
FINE = 1.04
"""The smallest amplitude is computed to this factor."""
MARGIN = 0.05
"""log; on samples so much more is required, so that the certificate's bound is met as well."""
PHASE = 0.0
"""rad, of every added tone."""
SHARE_OF_AXIS = 1e-6
"""Components of a direction below this are left out."""
STANDARD_GRAVITY = 9.81


@result
class Added:
    """Tones along directions, the preset with them, and its figures."""

    preset: Preset
    directions: tuple[Float[Array, "3"], ...]
    frequencies: tuple[float, ...]
    amplitude: float
    """m, of each tone."""
    figures: Figures


def smallest_tones(
    preset: Preset, at: float, *, tries: Iterator[int] | None = None, repeats: bool = False
) -> Added | None:
    """The smallest tones that meet the requirements within the vehicle's limits; None if the search has no result.

    The smallest has the least `effort`. at: start (s) of the least excited window. tries: an iterator from which every
    trial takes one item; the search ends when the iterator does. repeats: whether the tones keep the path's own period.
    """
    work = WORK_PER_TRY + WORK_PER_OPERATION * preset.path.operations()
    tries = iter(range(int(WORK / work))) if tries is None else tries
    spread = WHOLE if repeats else SPREAD
    for chosen in directions(preset, at):
        least: Added | None = None
        for w in candidates(preset, repeats=repeats):
            reached = _smallest(preset, chosen, w, tries, spread, math.inf if least is None else effort(least))
            if reached is not None and (least is None or effort(reached) < effort(least)):
                least = reached
        if least is not None:
            return least
    return None


def effort(added: Added) -> float:
    """The size of a change: amplitude in metres plus acceleration in units of standard gravity."""
    return _effort(added.amplitude, added.frequencies)


def _effort(amplitude: float, frequencies: Sequence[float]) -> float:
    return amplitude * (1 + math.hypot(*(w**2 for w in frequencies)) / STANDARD_GRAVITY)


def directions(preset: Preset, at: float) -> list[tuple[Array, ...]]:
    """Sets of directions to try: those without enough excitation, then with one more, then with all three."""
    values, axes = excitation.directions(preset.path, at, preset.requirement.window)
    missing = max(1, int(np.sum(values < preset.requirement.mu)))
    first, others = readable_basis(axes[:, :missing]), readable_basis(axes[:, missing:])
    return [(*first, *others[:more]) for more in range(len(others) + 1)]


def readable_basis(span: Float[Array, "3 k"]) -> list[Float[Array, "3"]]:
    """Unit vectors with the span of the orthonormal columns: coordinate axes where the span contains them."""
    if span.shape[1] == 0:
        return []
    columns = np.asarray(scipy.linalg.qr(span @ span.T, pivoting=True)[0])[:, : span.shape[1]]
    kept = np.where(np.abs(columns) > SHARE_OF_AXIS, columns, 0.0)
    return [oriented(column / np.linalg.norm(column)) for column in kept.T]


def candidates(preset: Preset, *, repeats: bool = False) -> list[float]:
    """Frequencies (rad/s) to try: multiples of the path's pace, rounded so that a periodic path remains periodic.

    repeats: with its own period, and not with twice that.
    """
    path, window = preset.path, preset.requirement.window
    base, least = pace(preset), LEAST_TURN / window
    fastest = math.pi * min(preset.sensors.imu_rate, preset.sensors.range_rate) / 4
    wanted = [base * harmonic for harmonic in HARMONICS] + [least * turns for turns in TURNS]
    wanted = [min(max(least, w), fastest) for w in wanted]
    # half the fundamental: the common period doubles at most
    step = (2 if repeats else 1) * math.pi / path.period if path.period else 0.0
    if step:
        return sorted({step * max(1, round(w / step)) for w in wanted})
    return sorted({float(f"{w:.2g}") for w in wanted})


def pace(preset: Preset) -> float:
    """A typical frequency of the path (rad/s): sqrt(rms snap / rms acceleration), which is w for one tone."""
    time = np.linspace(0, preset.duration, 401)
    sizes = [float(np.sqrt(np.mean(preset.path(time, order) ** 2))) for order in (2, 4)]
    return math.sqrt(sizes[1] / sizes[0]) if min(sizes) > 1e-9 else 2 * LEAST_TURN / preset.requirement.window


def longest_side(preset: Preset) -> float:
    """m, of the box around the path."""
    return float(np.ptp(preset.path(np.linspace(0, preset.duration, 401)), axis=0).max())


def _smallest(
    preset: Preset,
    directions: tuple[Array, ...],
    w: float,
    tries: Iterator[int],
    spread: tuple[float, ...],
    most_effort: float,
) -> Added | None:
    """The smallest amplitude at these frequencies, rounded up to two digits; None if no amplitude is enough.

    None as soon as whatever is enough takes more than `most_effort`.
    """
    frequencies = tuple(float(f"{w * factor:.12g}") for factor in spread[: len(directions)])

    most = max(MOST_AMPLITUDE, MOST_OF_PATH * longest_side(preset))

    def trial(amplitude: float) -> Added | None:
        return None if next(tries, None) is None else attempt(preset, directions, frequencies, amplitude)

    low, high = LEAST_AMPLITUDE, LEAST_AMPLITUDE
    best = trial(high)
    while not _serves(best, preset):
        low, high = high, high * 3
        if best is None or best.figures.worst_excess > 0 or high > most:
            return None  # already beyond the vehicle's limits
        if _effort(low, frequencies) > most_effort:
            return None
        best = trial(high)
    while high / low > FINE:
        if _effort(low, frequencies) > most_effort:
            return None
        middle = math.sqrt(low * high)
        reached = trial(middle)
        if _serves(reached, preset):
            high = middle
        else:
            low = middle
    best = trial(upwards(high))
    return best if best is not None and _serves(best, preset) and best.figures.worst_excess <= 0 else None


def attempt(
    preset: Preset, directions: Sequence[Array], frequencies: Sequence[float], amplitude: float
) -> Added | None:
    """The preset with tones of an amplitude (m), and its figures; None if there is no valid preset with them."""
    tones = tuple(
        Tone(axis=axis, amplitude=float(amplitude * n[k]), frequency=w, phase=PHASE)
        for n, w in zip(directions, frequencies, strict=True)
        for k, axis in enumerate(LETTERS)
        if n[k] != 0
    )
    try:
        changed = msgspec.structs.replace(preset, path=with_tones(preset.path, tones))
        reached = figures(changed)
    except ValueError:
        return None
    return Added(
        preset=changed,
        directions=tuple(directions),
        frequencies=tuple(frequencies),
        amplitude=amplitude,
        figures=reached,
    )


def with_tones(path: Signal, tones: tuple[Tone, ...]) -> Signal:
    """The path with tones added: to a Multisine itself, else as the wiggle of a Sum.

    Raises ValueError if there would be too many tones, or if the path is a Sum of other parts.
    """
    match path:
        case Multisine():
            return msgspec.structs.replace(path, tones=(*path.tones, *tones))
        case Sum(wiggle=Multisine() as wiggle):
            return msgspec.structs.replace(path, wiggle=msgspec.structs.replace(wiggle, tones=(*wiggle.tones, *tones)))
        case Sum():
            raise ValueError("the path is a sum already, and neither part of it takes tones")
        case _:
            return Sum(base=path, wiggle=Multisine(tones=tones))


def upwards(value: float, digits: int = 2) -> float:
    """The next number of so many digits that is not below the value."""
    unit = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return float(f"{math.ceil(value / unit - 1e-9) * unit:.{digits}g}")


def _serves(added: Added | None, preset: Preset) -> bool:
    return added is not None and max(shortfall(added.figures, preset, margin=MARGIN).values()) <= 0
