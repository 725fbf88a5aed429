"""What change would meet the requirement: the smallest tones that a search over a few frequencies finds, in words.

A direction n that is not excited takes a tone A sin(wt) along n: nᵀWn grows by about ½δA²w⁸, σ falls with A. Two
directions take two frequencies, three take three: tones of one frequency on all axes are an ellipse, which is planar.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Literal

import msgspec
import numpy as np
import scipy.linalg
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import provenance, signals
from rangenav.certificate.derivative_bounds import UnboundedDerivativeError
from rangenav.certificate.excitation_bound import oriented
from rangenav.certificate.figures import Figures, demanded, excess, figures, shortfall
from rangenav.observability import blindness, excitation
from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Multisine, Signal, Sum, Tone

LETTERS: tuple[Literal["x", "y", "z"], ...] = ("x", "y", "z")
LEAST_TURN = 6.0
"""rad; a tone that turns less in a window is not told from a cubic."""
HARMONICS, TURNS = (1.0, 1.5, 2.0, 2.5, 3.0), (2.0, 3.0)
"""Candidates, times how fast the path moves already, and times the slowest that a window tells."""
SPREAD = (1.0, 1.5, 2.0)
"""Frequencies of two or three added tones, relative to each other."""
LEAST_AMPLITUDE, MOST_AMPLITUDE = 1e-3, 4.0
"""m; smaller tones are lost in any controller, larger ones are another path."""
WORK, WORK_PER_TRY, WORK_PER_OPERATION = 1e8, 1e5, 4e4
"""A search is given so much work; a formula that takes long to look at is looked at less often."""
FINE = 1.04
"""The smallest amplitude is found to this factor."""
MARGIN = 0.05
"""Samples are held to this much more than is required (log), so that the certificate's bound is met as well."""
SHARE_OF_AXIS = 1e-6
"""Components of a direction below this are left out."""
SLOWEST = 16.0
STANDARD_GRAVITY = 9.81


@result
class Added:
    """Tones along directions, the preset that has them, and what it reaches."""

    preset: Preset
    directions: tuple[Float[Array, "3"], ...]
    frequencies: tuple[float, ...]
    amplitude: float
    """m, of each."""
    figures: Figures


def remedy(preset: Preset, at: float) -> str | None:
    """A sentence on what would meet the requirement; `at` (s) starts the window that is excited least."""
    if provenance.restriction(preset.source, preset.path) is not None:
        return provenance.ADOPT
    try:
        found = figures(preset)
    except UnboundedDerivativeError:
        return None
    if max(shortfall(found, preset).values()) > 0:
        added = smallest_tones(preset, at)
        return None if added is None else f"add {described(added)}"
    return _slower(preset)


def described(added: Added) -> str:
    """The tones in words."""
    each = [
        f"{added.amplitude:g} m at {w:g} rad/s along {blindness.name(n)}"
        for n, w in zip(added.directions, added.frequencies, strict=True)
    ]
    return f"a tone of at least {each[0]}" if len(each) == 1 else "tones of at least " + " and ".join(each)


def smallest_tones(preset: Preset, at: float, *, tries: Iterator[int] | None = None) -> Added | None:
    """The smallest tones found that meet the requirement within the vehicle's limits; None if none do.

    Small is a small effort: the amplitude in metres plus the acceleration in weights. `tries` is taken one from before
    every look, and ends the search when it ends.
    """
    work = WORK_PER_TRY + WORK_PER_OPERATION * preset.path.operations()
    tries = iter(range(int(WORK / work))) if tries is None else tries
    for several in directions(preset, at):
        tried = [found for w in candidates(preset) if (found := _smallest(preset, several, w, tries)) is not None]
        if tried:
            return min(tried, key=effort)
    return None


def effort(added: Added) -> float:
    """How large a change is: amplitude in metres plus acceleration in weights."""
    return added.amplitude * (1 + math.hypot(*(w**2 for w in added.frequencies)) / STANDARD_GRAVITY)


def directions(preset: Preset, at: float) -> list[tuple[Array, ...]]:
    """Which directions to move along: those without excitation; if that does not serve, the others besides."""
    values, axes = excitation.directions(preset.path, at, preset.requirement.window)
    missing = max(1, int(np.sum(values < preset.requirement.mu)))
    first, others = readable_basis(axes[:, :missing]), readable_basis(axes[:, missing:])
    return [(*first, *others[:more]) for more in range(len(others) + 1)]


def readable_basis(span: Float[Array, "3 k"]) -> list[Float[Array, "3"]]:
    """Unit vectors that span the same as the orthonormal columns, coordinate axes where it contains them."""
    if span.shape[1] == 0:
        return []
    columns = np.asarray(scipy.linalg.qr(span @ span.T, pivoting=True)[0])[:, : span.shape[1]]
    kept = np.where(np.abs(columns) > SHARE_OF_AXIS, columns, 0.0)
    return [oriented(column / np.linalg.norm(column)) for column in kept.T]


def candidates(preset: Preset) -> list[float]:
    """Frequencies (rad/s) to try: around how fast the path moves, and such that what repeats still repeats."""
    path, window = preset.path, preset.requirement.window
    base, least = pace(preset), LEAST_TURN / window
    fastest = math.pi * min(preset.sensors.imu_rate, preset.sensors.range_rate) / 4
    wanted = [base * harmonic for harmonic in HARMONICS] + [least * turns for turns in TURNS]
    wanted = [min(max(least, w), fastest) for w in wanted]
    step = math.pi / path.period if path.period else 0.0  # half the fundamental: the common period doubles at most
    if step:
        return sorted({step * max(1, round(w / step)) for w in wanted})
    return sorted({float(f"{w:.2g}") for w in wanted})


def pace(preset: Preset) -> float:
    """How fast the path moves (rad/s): sqrt(rms snap / rms acceleration), which is w for one tone."""
    time = np.linspace(0, preset.duration, 401)
    sizes = [float(np.sqrt(np.mean(preset.path(time, order) ** 2))) for order in (2, 4)]
    return math.sqrt(sizes[1] / sizes[0]) if min(sizes) > 1e-9 else 2 * LEAST_TURN / preset.requirement.window


def _smallest(preset: Preset, directions: tuple[Array, ...], w: float, tries: Iterator[int]) -> Added | None:
    """The smallest amplitude at these frequencies, to two digits and upwards; None if none serves."""
    frequencies = tuple(float(f"{w * factor:.12g}") for factor in SPREAD[: len(directions)])

    def tried(amplitude: float) -> Added | None:
        return None if next(tries, None) is None else attempt(preset, directions, frequencies, amplitude)

    low, high = LEAST_AMPLITUDE, LEAST_AMPLITUDE
    best = tried(high)
    while not _serves(best, preset):
        low, high = high, high * 3
        if best is None or best.figures.worst_excess > 0 or high > MOST_AMPLITUDE:
            return None  # more of what is too much already does not help
        best = tried(high)
    while high / low > FINE:
        middle = math.sqrt(low * high)
        found = tried(middle)
        if _serves(found, preset):
            high = middle
        else:
            low = middle
    best = tried(upwards(high))
    return best if best is not None and _serves(best, preset) and best.figures.worst_excess <= 0 else None


def attempt(
    preset: Preset, directions: Sequence[Array], frequencies: Sequence[float], amplitude: float
) -> Added | None:
    """The preset with tones of this amplitude, and its figures; None if it cannot be had."""
    tones = tuple(
        Tone(axis=axis, amplitude=float(amplitude * n[k]), frequency=w)
        for n, w in zip(directions, frequencies, strict=True)
        for k, axis in enumerate(LETTERS)
        if n[k] != 0
    )
    try:
        made = msgspec.structs.replace(preset, path=with_tones(preset.path, tones))
        found = figures(made)
    except ValueError:
        return None
    return Added(
        preset=made,
        directions=tuple(directions),
        frequencies=tuple(frequencies),
        amplitude=amplitude,
        figures=found,
    )


def with_tones(path: Signal, tones: tuple[Tone, ...]) -> Signal:
    """The path with tones added; what is no Multisine gets them as the wiggle of a Sum. Raises ValueError if full."""
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


def _slower(preset: Preset) -> str | None:
    """For what is only too much for its vehicle: how many times slower it would have to be flown."""
    factor = 1.0
    while factor < SLOWEST:
        factor *= 1.05
        try:
            slowed = msgspec.structs.replace(preset, path=signals.slowed(preset.path, factor))
            broken = max(excess(demanded(slowed), preset.vehicle).values(), default=-math.inf) > 0
        except ValueError:
            return None
        if not broken:
            return f"fly it {upwards(factor):g} times slower, if that leaves excitation enough"
    return None
