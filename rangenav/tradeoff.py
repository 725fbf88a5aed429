"""Settling time and steady error of gains on several records, and the tradeoff curve between the two.

Both are geometric means over the records: the time until position and attitude stay below 0.3 m and 5°, and the RMSE
over the last quarter. The first record starts with the preset's guess. The others start with the same attitude error
about random axes, because gains that are judged about one axis may be good for that axis only: the magnetometer alone
corrects an error about the presets' axis in 0.3 s, and never one about the magnetic field.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

import numpy as np
from msgspec.structs import replace

from rangenav import cascade, ensemble, errors, record
from rangenav.cascade import Estimate, ObserverConfig, Start
from rangenav.gains import Gains
from rangenav.preset import Preset
from rangenav.progress import Cancelled
from rangenav.record import Truth
from rangenav.sensors import Measurements

SOONEST = 0.05
"""s; a run that settles earlier counts as settling at this time."""
NEVER = 2.0
"""A run that does not settle counts as settling after this many durations."""
WORST = 1e6
"""Largest steady error in units of the settled error; larger and non-finite errors count as this."""
RUNS_TOGETHER = 8
"""Runs with constant gains that one thread makes side by side; no result depends on it."""
Measure = Literal["settle", "settle_position", "settle_attitude", "steady", "steady_position", "steady_attitude"]


@dataclass(frozen=True, kw_only=True)
class Point:
    """Gains, with their settling times and steady errors on some seeds (geometric means)."""

    gains: Gains
    settled: float
    """Share of the runs in which position and attitude settle."""
    settle_position: float
    """s; a run that never settles counts as twice the duration."""
    settle_attitude: float
    """s"""
    steady_position: float
    """m"""
    steady_attitude: float
    """rad"""

    @property
    def settle(self) -> float:
        """s: the geometric mean of both settling times."""
        return math.sqrt(self.settle_position * self.settle_attitude)

    @property
    def steady(self) -> float:
        """The geometric mean of both steady errors, in units of the errors that count as settled."""
        position = self.steady_position / record.SETTLED_POSITION
        return math.sqrt(position * self.steady_attitude / record.SETTLED_ATTITUDE)

    def objective(self, steadiness: float) -> float:
        """J = (1 − w) ln settle + w ln steady, with w = steadiness."""
        return (1 - steadiness) * math.log(self.settle) + steadiness * math.log(self.steady)


class TrainingRun(NamedTuple):
    """One record, and the start of its observers."""

    truth: Truth
    measurements: Measurements
    start: Start


def front(points: tuple[Point, ...], settle: Measure, steady: Measure) -> tuple[Point, ...]:
    """The tradeoff curve: the points that no other point beats in both measures, fastest settling first."""
    kept: list[Point] = []
    for point in sorted(points, key=lambda point: (getattr(point, settle), getattr(point, steady))):
        if not kept or getattr(point, steady) < getattr(kept[-1], steady):
            kept.append(point)
    return tuple(kept)


def runs(preset: Preset, first: int, count: int) -> list[TrainingRun]:
    """Records of `count` seeds. All have the preset's attitude error; all but the first have it about a random axis."""
    course = record.truth_inputs(preset)
    truth, rng = record.simulated(course), np.random.default_rng(first)
    axes = rng.standard_normal((count, 3))  # normal in R³: no preferred direction
    axes[0] = preset.guess.attitude_axis
    runs = []
    for k, axis in enumerate(axes.tolist()):
        guess = replace(preset.guess, attitude_axis=tuple(axis))
        start = cascade.start(guess, state=truth.state[0], rotation=truth.motion.rotation[0], world=preset.world)
        runs.append(TrainingRun(truth, record.drawn(course, preset.sensors, first + k), start))
    return runs


def score(gains: Gains, runs: list[TrainingRun], *, preset: Preset, cancelled: Cancelled) -> Point:
    """Settling time and steady error of gains on runs of a preset. Raises CancelledError when it is cancelled."""
    setting = ObserverConfig(world=preset.world, sensors=preset.sensors, gains=gains)
    size = RUNS_TOGETHER if gains.mode == "constant" else 1
    jobs = ensemble.each(
        partial(_settling_and_steady, setting),
        [runs[first : first + size] for first in range(0, len(runs), size)],
        samples=size * len(runs[0].measurements.time),
        progress=lambda _: None,
        cancelled=cancelled,
    )
    results = [result for job in jobs for result in job]
    settle, steady = (np.array(part) for part in zip(*results, strict=True))
    ends = NEVER * preset.duration
    settles = np.exp(np.mean(np.log(np.where(np.isfinite(settle), np.maximum(settle, SOONEST), ends)), axis=0))
    limits = np.array([record.SETTLED_POSITION, record.SETTLED_ATTITUDE])
    clipped = np.clip(np.where(np.isnan(steady), np.inf, steady), limits / WORST, limits * WORST)
    steadies = np.exp(np.mean(np.log(clipped), axis=0))
    return Point(
        gains=gains,
        settled=float(np.mean(np.isfinite(settle).all(axis=1))),
        settle_position=float(settles[0]),
        settle_attitude=float(settles[1]),
        steady_position=float(steadies[0]),
        steady_attitude=float(steadies[1]),
    )


def _settling_and_steady(setting: ObserverConfig, runs: list[TrainingRun]) -> list[tuple[list[float], list[float]]]:
    """Settling times (infinite if the run does not settle) and steady errors, of position and attitude, of each run."""
    measured, starts = [run.measurements for run in runs], [run.start for run in runs]
    estimates = cascade.observe_each(measured, starts, [setting] * len(runs))
    return [_figures(estimate, run.truth) for estimate, run in zip(estimates, runs, strict=True)]


def _figures(estimate: Estimate, truth: Truth) -> tuple[list[float], list[float]]:
    tracking = errors.of(estimate, truth=truth.state, rotation=truth.motion.rotation)
    settle, steady = [], []
    limits = (record.SETTLED_POSITION, record.SETTLED_ATTITUDE)
    for error, limit in zip((tracking.position, tracking.attitude), limits, strict=True):
        at = record.settled(estimate.time, error, limit)
        settle.append(np.inf if at is None else at)
        with np.errstate(over="ignore", invalid="ignore"):
            steady.append(record.steady(error))
    return settle, steady
