"""A preset judged by its worst windows: the worst of all windows, proved, or the worst of some windows.

Of some windows, μ and rank are those of windows evenly spaced, and σ is that of the windows that hold the fewest ranges
(`every_range_window.likely_worst`), by the ranges that each of them holds.
"""

import math
from functools import lru_cache

import numpy as np

from rangenav.analysis.values import Analysis
from rangenav.model import STATES
from rangenav.motion import World
from rangenav.motion_analysis import (
    WINDOWS,
    MotionAnalysis,
    Ranges,
    farthest_from_anchor,
    sampled_windows,
)
from rangenav.observability import accuracy, every_range_window, excitation, undetermined
from rangenav.observability.every_range_window import RangeWindows
from rangenav.observability.worst_excitation import EVERY
from rangenav.preset import Preset, Requirement
from rangenav.proof import arguments, prove
from rangenav.provenance import Source
from rangenav.signals import Signal
from rangenav.verdict import excitation_reached, for_these_ranges, judge, restriction

CACHED = 8
"""Cached analyses: enough for undo and for A/B, few enough for many visitors."""


def analyse(preset: Preset, *, compiled: bool = False) -> Analysis:
    """Analyse a preset over its own window: the worst of all windows. compiled: see `analysis`; equal to rounding."""
    return _proven(*arguments(preset), preset.source, compiled=compiled)


def sampled(preset: Preset, windows: int = WINDOWS) -> Analysis:
    """Analyse a preset over its own window: the worst of some windows. μ and rank are those of so many, evenly spaced.

    σ is never larger than over all windows, and rarely 1 % smaller (`every_range_window.likely_worst`).
    """
    return analysis(*arguments(preset), preset.source, windows, compiled=True)


@lru_cache(maxsize=CACHED)
def analysis(
    path: Signal,
    world: World,
    duration: float,
    requirement: Requirement,
    range_sigma: float,
    range_rate: float,
    arriving: float = 1.0,
    source: Source | None = None,
    count: int = WINDOWS,
    *,
    compiled: bool = False,
) -> Analysis:
    """The analysis by sampled windows. What depends on neither anchor nor noise comes from `motion_analysis`.

    `arriving` is the share of ranges that random drop-outs leave. `source` is the file that the path was imported from.
    count: of the windows. compiled: by compiled code, whose loading is worth it for a program that judges many motions.
    """
    window = requirement.window
    ranges = Ranges(sigma=range_sigma, rate=range_rate, share=arriving)
    windows = sampled_windows(path, world, duration, window, ranges, count, compiled=compiled)
    lifted, k, worst = windows.lifted, windows.lifted.worst, windows.lifted.worst_spectrum
    found = _worst_held(path, world, duration, window, ranges, lifted, compiled=compiled)
    first, last = found.first, found.last
    of = accuracy.of_held(
        path, world, found.at, window, first=first, last=last, rate=range_rate, sigma=range_sigma, share=arriving
    )
    rank, farthest, cause = lifted.rank, farthest_from_anchor(path, world, duration), None
    if rank == STATES and not math.isfinite(found.sigma):
        noise = range_sigma or 1.0
        cause = undetermined.cause(path, world, window=window, first=first, last=last, rate=range_rate, noise=noise)
    return Analysis(
        proof=None,
        windows=windows,
        mu=float(lifted.least[0]),
        mu_at=lifted.least_at,
        excitation=lifted.least,
        bound_for_all_t=None,
        gramian_at=float(lifted.start[k]),
        gramian=worst.eigenvalues[0],
        floor=float(worst.floor[0]),
        rank=rank,
        rounded=lifted.rounded,
        tolerance=float(worst.tolerance[0] / worst.scaled[0, 0]),
        directions=lifted.directions,
        accuracy_at=found.at,
        accuracies=of,
        ranges=found.ranges,
        ranges_rounded=cause == "rounding",
        farthest=farthest,
        verdict=judge(
            rank,
            found.sigma,
            requirement.position_sigma,
            excitation=excitation_reached(float(lifted.least[0]), None, requirement.mu),
            rounded=lifted.rounded,
            restriction=restriction(path, source, duration),
            ranges=for_these_ranges(cause, found.ranges, found.at, window, rate=range_rate, period=path.period),
            farthest=farthest,
        ),
    )


def _worst_held(
    path: Signal,
    world: World,
    duration: float,
    window: float,
    ranges: Ranges,
    lifted: MotionAnalysis,
    *,
    compiled: bool,
) -> RangeWindows:
    """The worst window for the position by the ranges that windows hold; of a blind motion the window of least rank."""
    start = float(lifted.start[lifted.worst])
    if lifted.rank < STATES and not lifted.rounded:
        return every_range_window.held(start, window, rate=ranges.rate)
    return every_range_window.likely_worst(
        path, world, duration, window, sigma=ranges.sigma, rate=ranges.rate, share=ranges.share, compiled=compiled
    )


@lru_cache(maxsize=CACHED)
def _proven(
    path: Signal,
    world: World,
    duration: float,
    requirement: Requirement,
    range_sigma: float,
    range_rate: float,
    arriving: float,
    source: Source | None,
    *,
    compiled: bool,
) -> Analysis:
    """The analysis by the worst of all windows; the sampled ones are kept for curves."""
    window = requirement.window
    ranges = Ranges(sigma=range_sigma, rate=range_rate, share=arriving)
    proof = prove(path, world, duration, requirement, range_sigma, range_rate, arriving, compiled=compiled)
    excited, rank, worst, held = proof.excitation, proof.rank, proof.accuracy, proof.accuracy.windows
    values = excitation.eigenvalues(path, np.array([excited.at]), window)[0]
    farthest = farthest_from_anchor(path, world, duration)
    return Analysis(
        proof=proof,
        windows=sampled_windows(path, world, duration, window, ranges, compiled=compiled),
        mu=float(values[0]),
        mu_at=excited.at,
        excitation=values,
        bound_for_all_t=(excited.lower or None) if excited.starts == EVERY else None,
        gramian_at=rank.at,
        gramian=rank.eigenvalues,
        floor=rank.floor,
        rank=rank.rank,
        rounded=rank.rounded,
        tolerance=rank.tolerance,
        directions=rank.directions,
        accuracy_at=held.at,
        accuracies=worst.accuracies,
        ranges=held.ranges,
        ranges_rounded=proof.undetermined == "rounding",
        farthest=farthest,
        verdict=judge(
            rank.rank,
            held.bound,
            requirement.position_sigma,
            excitation=excitation_reached(excited.mu, excited.lower, requirement.mu),
            rounded=rank.rounded,
            restriction=restriction(path, source, duration),
            ranges=for_these_ranges(
                proof.undetermined, held.ranges, held.at, window, rate=range_rate, period=path.period
            ),
            farthest=farthest,
        ),
    )
