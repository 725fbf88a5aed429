"""A preset judged by its worst windows: the worst of all windows, proved, or the worst of windows evenly spaced."""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from rangenav.analysis.values import Analysis
from rangenav.model import STATES
from rangenav.motion import World
from rangenav.motion_analysis import (
    WINDOWS,
    Ranges,
    farthest_from_anchor,
    sampled_windows,
)
from rangenav.observability import accuracy, excitation, undetermined
from rangenav.observability.worst_excitation import EVERY
from rangenav.preset import Preset, Requirement
from rangenav.proof import arguments, prove
from rangenav.provenance import Source
from rangenav.signals import Signal
from rangenav.verdict import excitation_reached, for_these_ranges, judge, restriction

CACHED = 8
"""Cached analyses: enough for undo and for A/B, few enough for many visitors."""


def analyse(preset: Preset) -> Analysis:
    """Analyse a preset over its own window: the worst of all windows."""
    return _proven(*arguments(preset), preset.source)


def sampled(preset: Preset, windows: int = WINDOWS) -> Analysis:
    """Analyse a preset over its own window: the worst of so many windows, evenly spaced over the flight."""
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
    at = float(lifted.start[int(np.argmax(np.nan_to_num(windows.sigma_lifted, nan=np.inf)))])
    first, last = math.ceil(at * range_rate - 1e-9), math.floor((at + window) * range_rate + 1e-9)
    of = accuracy.of_held(
        path, world, at, window, first=first, last=last, rate=range_rate, sigma=range_sigma, share=arriving
    )
    rank, farthest, cause = lifted.rank, farthest_from_anchor(path, world, duration), None
    if rank == STATES and not math.isfinite(of.lifted_end.position):
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
        accuracy_at=at,
        accuracies=of,
        ranges=last - first + 1,
        ranges_rounded=cause == "rounding",
        farthest=farthest,
        verdict=judge(
            rank,
            of.lifted_end.position,
            requirement.position_sigma,
            excitation=excitation_reached(float(lifted.least[0]), None, requirement.mu),
            rounded=lifted.rounded,
            restriction=restriction(path, source, duration),
            ranges=for_these_ranges(cause, last - first + 1, at, window, rate=range_rate, period=path.period),
            farthest=farthest,
        ),
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
) -> Analysis:
    """The analysis by sampled windows, with the worst of all windows in place of the worst sampled one."""
    window = requirement.window
    few = analysis(path, world, duration, requirement, range_sigma, range_rate, arriving, source, WINDOWS)
    proof = prove(path, world, duration, requirement, range_sigma, range_rate, arriving)
    excited, rank, worst, held = proof.excitation, proof.rank, proof.accuracy, proof.accuracy.windows
    values = excitation.eigenvalues(path, np.array([excited.at]), window)[0]
    return replace(
        few,
        proof=proof,
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
            farthest=few.farthest,
        ),
    )
