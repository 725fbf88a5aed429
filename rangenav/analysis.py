"""Observability of a preset's motion from one range: sliding windows, the worst of them, blind directions, verdict.

analyse(preset)     the worst of all windows, as certificates have it: what `analyze` and the page at rest show
sampled(preset)     the worst of 101 windows or fewer, some ten times as fast: for a page while a hand moves
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.model import STATES
from rangenav.motion import World
from rangenav.motion_analysis import (
    WINDOWS,
    Ranges,
    Windows,
    farthest_from_anchor,
    sampled_windows,
)
from rangenav.observability import accuracy, excitation, horizon, reduced, undetermined
from rangenav.observability.accuracy import Accuracy, FourAccuracies
from rangenav.observability.blindness import Direction
from rangenav.observability.horizon import Horizon
from rangenav.observability.shortest_windows import ShortestWindows, shortest_windows
from rangenav.observability.worst_excitation import EVERY
from rangenav.preset import Preset, Requirement
from rangenav.proof import Proof, arguments, prove
from rangenav.provenance import Source
from rangenav.results import result
from rangenav.sensors import drift
from rangenav.signals import Signal
from rangenav.verdict import Verdict, caveats, excitation_reached, for_these_ranges, judge, restriction

Lengths = TypeVar("Lengths", Horizon, ShortestWindows)
CACHED = 8
"""Cached analyses: enough for undo and for A/B, few enough for many visitors."""


@result
class Analysis:
    """The analysis of one preset. Every number without a window of its own is that of a worst window."""

    proof: Proof | None
    """What the worst windows come from; None where they are the worst of the sampled windows."""

    windows: Windows
    mu: float
    """The least excitation eigenvalue over all windows (m²/s⁷)."""
    mu_at: float
    """s, where that window starts."""
    excitation: Float[Array, "3"]
    """All three eigenvalues there."""
    bound_for_all_t: float | None
    """A lower bound of the excitation over every window at every t ≥ 0; None if the path has no period, if no bound
    above 0 is known, or if only sampled windows were computed."""
    gramian_at: float
    """s, where the window of least rank (and then least scaled singular value) starts."""
    gramian: Float[Array, "13"]
    floor: float
    rank: int
    rounded: bool
    """Whether the rank is 13, as a longer window shows, and `rank` is lower because of rounding alone."""
    tolerance: float
    """Relative: a scaled singular value counts above this share of the largest."""
    directions: tuple[Direction, ...]
    accuracy_at: float
    """s, the start of the window whose lifted position error at its end is largest; a blind window counts as worst."""
    accuracies: FourAccuracies
    """Of that window."""
    ranges: int
    """How many ranges that window holds."""
    ranges_rounded: bool
    """Whether they leave the position undetermined because of rounding alone, as far as is known."""
    farthest: float
    """m: the largest distance to the anchor in the flight, on samples."""
    verdict: Verdict

    @property
    def mu_floor(self) -> float:
        """Excitation eigenvalues below it are rounding (m²/s⁷)."""
        return excitation.floor(self.windows.excitation) if self.proof is None else self.proof.excitation.floor

    @property
    def nonlinear_at(self) -> float:
        """s, where the window of least nonlinear rank (and then of least scaled singular value) starts."""
        if self.proof is not None:
            return self.proof.rank.nonlinear_at
        return float(self.windows.start[self.windows.worst_nonlinear[0]])

    @property
    def nonlinear(self) -> Float[Array, "9"]:
        """The eigenvalues of its Gramian, ascending, SI."""
        if self.proof is not None:
            return self.proof.rank.nonlinear_eigenvalues
        return self.windows.worst_nonlinear[1].eigenvalues[0]

    @property
    def nonlinear_floor(self) -> float:
        """Nonlinear eigenvalues below it are rounding."""
        if self.proof is not None:
            return self.proof.rank.nonlinear_floor
        return float(self.windows.worst_nonlinear[1].floor[0])

    @property
    def nonlinear_rank(self) -> int:
        """Of 9."""
        if self.proof is not None:
            return self.proof.rank.nonlinear
        return int(self.windows.worst_nonlinear[1].rank[0])

    @property
    def lifted_start(self) -> Accuracy:
        """Of the lifted problem, at the start of the window of the largest error."""
        return self.accuracies.lifted_start

    @property
    def lifted_end(self) -> Accuracy:
        """The same at its end."""
        return self.accuracies.lifted_end

    @property
    def nonlinear_start(self) -> Accuracy:
        """Of the nonlinear problem, at the start of that window."""
        return self.accuracies.nonlinear_start

    @property
    def nonlinear_end(self) -> Accuracy:
        """The same at its end."""
        return self.accuracies.nonlinear_end

    @property
    def reduced_min(self) -> float:
        """The least eigenvalue of the reduced pair (Proposition 1) on the window of least rank."""
        return self._reduced[0]

    @property
    def reduced_floor(self) -> float:
        """Below it that eigenvalue is rounding."""
        return self._reduced[1]

    @cached_property
    def _reduced(self) -> tuple[float, float]:
        windows = self.windows
        return reduced.least_eigenvalue(windows.path, windows.world.gravity, self.gramian_at, windows.window)

    @property
    def resolved_mu(self) -> float:
        """μ (m²/s⁷), and 0 where it is rounding."""
        clear = self.mu >= excitation.CLEAR * excitation.most(self.windows.path, self.windows.window)
        return self.mu if clear or self.mu >= self.mu_floor else 0.0

    @property
    def below_rounding(self) -> bool:
        """Whether rank or position are undetermined because of rounding alone, as far as is known."""
        return self.rounded or self.ranges_rounded

    @property
    def blind(self) -> bool:
        """Whether the position cannot be told, for the motion or for its ranges; of motions not judged, by the rank."""
        return self.verdict.word == "blind" or self.known_rank < STATES

    @property
    def known_rank(self) -> int:
        """13 where the rank is lower because of rounding alone."""
        return STATES if self.rounded else self.rank

    def caveats(self, preset: Preset) -> tuple[str, ...]:
        """Why the verdict on this preset is of little use, one sentence each."""
        worst = self.lifted_end.position
        determined, window = math.isfinite(worst), self.windows.window
        return caveats(
            preset.world.gravity,
            preset.sensors.sigma.range,
            position_sigma=worst if determined else 0.0,
            farthest=self.farthest,
            window=window,
            drift=drift(preset.sensors, window) if determined else 0.0,
        )


def analyse(preset: Preset) -> Analysis:
    """Analyse a preset over its own window: the worst of all windows."""
    return _proven(*arguments(preset), preset.source)


def sampled(preset: Preset, windows: int = WINDOWS) -> Analysis:
    """Analyse a preset over its own window: the worst of so many windows, evenly spaced over the flight."""
    return analysis(*arguments(preset), preset.source, windows)


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
) -> Analysis:
    """The analysis by sampled windows. What depends on neither anchor nor noise comes from `motion_analysis`.

    `arriving` is the share of ranges that random drop-outs leave. `source` is the file that the path was imported from.
    count: of the windows.
    """
    window = requirement.window
    ranges = Ranges(sigma=range_sigma, rate=range_rate, share=arriving)
    windows = sampled_windows(path, world, duration, window, ranges, count)
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


def how_long(preset: Preset) -> Horizon:
    """How long a window must be for rank 13, and for the accuracy that a preset requires, as curves of its length.

    The worst is that of five starts, and ranges are summed as if they came at all times; `shortest` has every start
    and the ranges themselves.
    """
    return _against_length(horizon.horizon, preset)


def shortest(preset: Preset) -> ShortestWindows:
    """The shortest windows whose ranges, as the preset really takes them, give the accuracy that it requires."""
    return _against_length(shortest_windows, preset)


def _against_length(compute: Callable[..., Lengths], preset: Preset) -> Lengths:
    """What is computed for windows of many lengths, from the flight of a preset and its ranges."""
    sensors = preset.sensors
    return compute(
        preset.path,
        preset.world,
        preset.duration,
        sigma=sensors.sigma.range,
        rate=sensors.range_rate,
        share=sensors.arriving,
        position_sigma=preset.requirement.position_sigma,
    )
