"""What a study will take: points, runs, parts, CPU time and bytes, from a trial of a few of its points.

    seconds = points · point + runs · run        bytes ≤ 8 · (points · metrics + runs · estimators · metrics) + the rest
The trial decides how many points a part has, and nothing of the results.
"""

import math
import time
from dataclasses import dataclass

import numpy as np

from rangenav import preset
from rangenav.studies import blocks, evaluation
from rangenav.studies.blocks import Blocks
from rangenav.studies.study import Study

PART_SECONDS = 6.0
"""CPU time of one part: long against the overhead of a task, short enough to lose little with a worker."""
LEAST_SECONDS = 0.3
MANY = 32
"""A small study has about so many parts, so that every worker has some."""
SMALLER, SIZES = 0.75, 32
"""A part may be smaller by this factor so that all workers end at about the same time; sizes that are compared."""
TRIALS, TRIED = 3, 12
"""Valid points that are timed, and points that are looked at to find them."""
TRIAL_RUNS = 4
"""Runs of such a point: enough to be made side by side."""
RECEIPT_BYTES, FILE_BYTES = 400, 110
"""Of a receipt, and for each of its files."""
CHUNK_BYTES, ARRAY_BYTES, GROUP_BYTES = 40, 2500, 4000
"""What a file of numbers takes beyond them, and what describes an array, and the store."""


@dataclass(frozen=True, kw_only=True)
class Cost:
    """CPU time on this machine, s."""

    point: float
    """Of one point without its runs."""
    run: float
    """Of one seed, all estimators together."""
    tried: int
    """Points that were looked at to find a few valid ones."""
    invalid: int
    """Of them, those that are invalid."""


@dataclass(frozen=True, kw_only=True)
class Plan:
    """What a study will take."""

    points: int
    runs: int
    """Seeds at all points; with a stopping rule, the most."""
    least_runs: int
    """The fewest that a stopping rule allows; the same as `runs` without one."""
    parts: int
    seconds: float
    """CPU time of all runs on this machine."""
    bytes: int
    """On the disk before compression."""
    cost: Cost


def warm_up(study: Study) -> None:
    """Compute one valid point with a few runs: every kernel that the study needs is then compiled, or loaded."""
    for index in _places(study):
        if not evaluation.point(study, index, runs=TRIAL_RUNS).reason:
            return


def cost(study: Study) -> Cost:
    """The CPU time of a point and of a run, medians of a few points."""
    warm_up(study)
    point, run, tried = [], [], 0
    for index in _places(study):
        tried += 1
        began = time.process_time()
        if evaluation.point(study, index, runs=0).reason:
            continue
        middle = time.process_time()
        done = evaluation.point(study, index, runs=TRIAL_RUNS).runs.shape[1]  # of a motion that is cached by now
        point.append(middle - began)
        run.append((time.process_time() - middle) / done if done else 0.0)
        if len(run) == TRIALS:
            break
    invalid = tried - len(run)
    if not run:
        return Cost(point=0.0, run=0.0, tried=tried, invalid=invalid)
    return Cost(point=float(np.median(point)), run=float(np.median(run)), tried=tried, invalid=invalid)


def divided(study: Study, of: Cost, *, workers: int = 1) -> Blocks:
    """The parts of a study: some seconds of work each, or fewer if the study is small, for so many workers to share."""
    stop, most = study.file.stop, study.file.most_runs
    usual = most if stop is None else (stop.least * most) ** 0.5  # between the fewest and the most
    each = max(of.point + of.run * usual, 1e-6)
    seconds = min(PART_SECONDS, max(LEAST_SECONDS, each * study.count / MANY))
    points = max(1, int(seconds / each))
    sizes = np.unique(np.linspace(max(1, int(SMALLER * points)), points, SIZES).astype(int)).tolist()

    def longest(size: int) -> int:
        """Points that one worker has if every part takes the same time."""
        parts = blocks.divided(study.shape, size)
        return -(-parts.count // workers) * math.prod(parts.chunk)

    return blocks.divided(study.shape, min(reversed(sizes), key=longest))


def plan(study: Study, *, workers: int = 1) -> Plan:
    """What a study will take. It computes a few points, in this process."""
    return of_cost(study, cost(study), workers=workers)


def of_cost(study: Study, of: Cost, *, workers: int = 1) -> Plan:
    """The same for a cost that is known."""
    file, parts = study.file, divided(study, of, workers=workers).count
    runs = study.count * file.most_runs
    files = len(file.metrics) + 2
    described = (
        ARRAY_BYTES * (files + len(study.values) + 3)
        + GROUP_BYTES
        + sum(len(preset.dumps(base)) for base in study.bases)
    )
    numbers = study.count * (len(file.point_metrics) + 1) + runs * len(file.estimators) * len(file.run_metrics)
    return Plan(
        points=study.count,
        runs=runs,
        least_runs=runs if file.stop is None else study.count * file.stop.least,
        parts=parts,
        seconds=study.count * of.point + runs * of.run,
        bytes=8 * numbers + parts * (RECEIPT_BYTES + files * (FILE_BYTES + CHUNK_BYTES)) + described,
        cost=of,
    )


def _places(study: Study) -> list[int]:
    """Points spread over the study."""
    return np.unique(np.linspace(0, study.count - 1, TRIED).round().astype(int)).tolist()
