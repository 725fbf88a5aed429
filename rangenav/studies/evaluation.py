"""One point of a study, and one block of points: what every way of running a study calls.

A value that does not fit is no error: the point is invalid, and its reason is recorded. The results of a point depend
on the study and on the point's index alone.
"""

import re
import warnings
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int, Shaped
from numpy import ndarray as Array

from rangenav import analysis, record
from rangenav.inputs import shortened
from rangenav.motion import DirectionWarning
from rangenav.preset import Preset
from rangenav.progress import Cancelled, CancelledError, never, stopping
from rangenav.record import Truth
from rangenav.results import result
from rangenav.sensors import measure
from rangenav.studies.estimators import ESTIMATORS, Flown
from rangenav.studies.metrics import METRICS, OBSERVABLE, Metric, Run, flight
from rangenav.studies.study import Study
from rangenav.studies.study_file import StudyFile

NUMBER = re.compile(r"[-+]?\d[\d.e+-]*")
RUNS_TOGETHER = 8
"""Runs of a point that are made side by side."""


@result
class PointResult:
    """Every metric at one point."""

    point: Float[Array, "m"]
    """The metrics of the point, in the order of the study's `point_metrics`; NaN where it is invalid."""
    runs: Float[Array, "e r q"]
    """The metrics of each run: estimator, run, `run_metrics`; NaN where it is invalid."""
    reason: str
    """Why the point is invalid; empty where it is valid."""


@result
class Block:
    """Every metric at some points; a row for each."""

    index: Int[Array, "p"]
    point: Float[Array, "p m"]
    runs: Float[Array, "p e r q"]
    """NaN behind the last run of a point that the stopping rule ended."""
    count: Int[Array, "p"]
    """Runs of each point; 0 where it is invalid."""
    reason: Shaped[Array, "p"]
    """Texts, as objects."""


def kind(reason: str) -> str:
    """A reason without its numbers: those of one kind differ by them alone."""
    return NUMBER.sub("", reason)


def kinds(reasons: Sequence[str]) -> tuple[str, ...]:
    """The first reason of each kind."""
    first: dict[str, str] = {}
    for reason in reasons:
        first.setdefault(kind(reason), reason)
    return tuple(first.values())


def point(study: Study, index: int, *, runs: int | None = None, cancelled: Cancelled = never) -> PointResult:
    """Every metric at one point. `runs` limits the runs, for a trial.

    Raises CancelledError when it is cancelled.
    """
    file, estimators = study.file, len(study.file.estimators)
    most = file.most_runs if runs is None else min(runs, file.most_runs)
    try:
        with stopping(cancelled), np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore", DirectionWarning)
            preset = study.preset_at(index)
            values, truth = _of_motion(study, preset)
            rows = _runs(study, index, preset, truth, most, cancelled) if truth is not None else []
    except (ValueError, ArithmeticError) as error:
        return PointResult(
            point=np.full(len(file.point_metrics), np.nan),
            runs=np.full((estimators, 0, len(file.run_metrics)), np.nan),
            reason=shortened(str(error)) or type(error).__name__,
        )
    shape = (0, estimators, len(file.run_metrics))
    return PointResult(point=values, runs=np.array(rows).reshape(len(rows), *shape[1:]).swapaxes(0, 1), reason="")


def rounds(file: StudyFile, most: int) -> list[list[range]]:
    """The numbers of so many runs of a point, in the groups that are made together; a stopping rule is asked after
    each round of groups."""
    each = max(most, 1) if file.stop is None else file.stop.least
    ends = [(first, min(first + each, most)) for first in range(0, most, each)]
    return [[range(k, min(k + RUNS_TOGETHER, end)) for k in range(first, end, RUNS_TOGETHER)] for first, end in ends]


def block(study: Study, indices: Sequence[int], *, cancelled: Cancelled = never) -> Block:
    """Every metric at some points. Raises CancelledError when it is cancelled."""
    file, points = study.file, len(indices)
    runs = np.full((points, len(file.estimators), file.most_runs, len(file.run_metrics)), np.nan)
    values, count = np.full((points, len(file.point_metrics)), np.nan), np.zeros(points, dtype=np.int64)
    reason = np.full(points, "", dtype=object)
    for k, index in enumerate(indices):
        done = point(study, index, cancelled=cancelled)
        values[k], reason[k], count[k] = done.point, done.reason, done.runs.shape[1]
        runs[k, :, : count[k]] = done.runs
    return Block(index=np.asarray(indices), point=values, runs=runs, count=count, reason=reason)


def _of_motion(study: Study, preset: Preset) -> tuple[Float[Array, "m"], Truth | None]:
    """The metrics of the point, and the truth if a metric needs it."""
    rows = [METRICS[name] for name in study.file.point_metrics]
    values = np.full(len(rows), np.nan)
    wanted = {row.needs for row in rows}
    truth = record.simulated(record.truth_inputs(preset)) if study.file.run_metrics or "motion" in wanted else None
    if "motion" in wanted and truth is not None:
        _fill(values, rows, "motion", flight(truth.motion, preset))
    if wanted & {"analysis", "verdict"}:
        every = study.file.every_window
        of = analysis.analyse(preset, compiled=True) if every else analysis.sampled(preset, study.file.windows)
        _fill(values, rows, "analysis", of)
        sure = every or "verdict" not in wanted or of.verdict.word != OBSERVABLE  # no window is better than the worst
        _fill(values, rows, "verdict", of if sure else analysis.analyse(preset, compiled=True))
    return values, truth


def _fill(values: Array, rows: list[Metric], needs: str, of: object) -> None:
    for k, row in enumerate(rows):
        if row.needs == needs:
            values[k] = row.value(of)


def _runs(
    study: Study, index: int, preset: Preset, truth: Truth, most: int, cancelled: Cancelled
) -> list[list[list[float]]]:
    """Runs until the stopping rule is met: run, estimator, metric."""
    stop = study.file.stop
    judged = study.file.run_metrics.index(stop.metric) if stop is not None else 0
    rows: list[list[list[float]]] = []
    for groups in rounds(study.file, most):
        for group in groups:
            if cancelled():
                raise CancelledError
            rows += _together(study, preset, truth, [study.seed(index, run) for run in group])
        if stop is not None and stop.met(np.array(rows)[:, :, judged].T):
            break
    return rows


def _together(study: Study, preset: Preset, truth: Truth, seeds: list[int]) -> list[list[list[float]]]:
    """Some runs, side by side where an estimator can: their results do not depend on it."""
    of = {"path": preset.path, "world": preset.world, "sensors": preset.sensors}
    measurements = [measure(truth.motion, **of, rng=np.random.default_rng(seed)) for seed in seeds]
    flown = Flown(preset, truth, measurements)
    outcomes = [row.run(flown) for row in _chosen(study)]
    names = study.file.run_metrics
    return [[_metrics(names, Run(outcome=one, truth=truth)) for one in each] for each in zip(*outcomes, strict=True)]


def _chosen(study: Study) -> list:
    return [ESTIMATORS[name] for name in study.file.estimators]


def _metrics(names: tuple[str, ...], run: Run) -> list[float]:
    return [METRICS[name].value(run) for name in names]
