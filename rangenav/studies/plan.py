"""What a study will take: points, runs, parts, CPU time and bytes, from a trial of a few of its points.

    seconds = points · point + runs · run        bytes ≤ 8 · (points · metrics + runs · estimators · metrics) + the rest
The trial decides how many points a part has, and nothing of the results.
"""

import math
from dataclasses import dataclass, replace

import msgspec
import numpy as np

from rangenav import preset
from rangenav.studies import blocks, evaluation, trial
from rangenav.studies.blocks import Blocks
from rangenav.studies.metrics import METRICS, RANKS, ROWS
from rangenav.studies.parameters import Choices, Listed, Parameter
from rangenav.studies.study import Study
from rangenav.studies.study_file import Grid
from rangenav.studies.trial import Cost

PART_SECONDS = 6.0
"""CPU time of one part: long against the overhead of a task, short enough to lose little with a worker."""
LEAST_SECONDS = 0.3
MANY = 32
"""A small study has about so many parts, so that every worker has some."""
SMALLER, SIZES = 0.75, 32
"""A part may be smaller by this factor so that all workers end at about the same time; sizes that are compared."""
ENDS = (0.1, 0.9)
"""Shares of the probability at which a distribution, or the range of a sample, is tried for its effect."""
RECEIPT_BYTES, FILE_BYTES = 400, 110
"""Of a receipt, and for each of its files."""
CHUNK_BYTES, ARRAY_BYTES, GROUP_BYTES = 40, 2500, 4000
"""What a file of numbers takes beyond them, and what describes an array, and the store."""


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


def without_effect(study: Study) -> tuple[str, ...]:
    """The parameters that change no metric: from their first value to their last one, the others at both ends.

    A run of either value has the same seed, so that a parameter with any effect on it is seen.
    """
    ends = tuple(_ends(one) for one in study.file.parameters)
    changes = {"design": Grid(), "runs": 1, "stop": None, "common_seeds": True, "metrics": _finer(study.file.metrics)}
    file = msgspec.structs.replace(study.file, parameters=ends, **changes)
    of = replace(study, file=file, bases=study.bases[:1], names=study.names[:1])
    last, without = of.count - 1, []
    corners = {place: evaluation.point(of, place) for place in {0, last}}
    for k, one in enumerate(ends):
        step = math.prod(of.shape[k + 1 :]) if one.size == len(ENDS) else 0
        others = {0: step, last: last - step}
        if step and all(_same(corners[corner], evaluation.point(of, other)) for corner, other in others.items()):
            without.append(one.path)
    return tuple(without)


def _finer(metrics: tuple[str, ...]) -> tuple[str, ...]:
    """The metrics, and for a yes or no or a rank, which hide most changes, all others of the same origin."""
    coarse = {METRICS[name].needs for name in metrics if METRICS[name].middle == "share" or name in RANKS}
    coarse |= {"analysis"} if "verdict" in coarse else set()
    return tuple(row.name for row in ROWS if row.name in metrics or row.needs in coarse)


def _ends(of: Parameter) -> Listed | Choices:
    """A parameter with the first and the last of its values alone."""
    values = of.grid() if of.size else of.quantile(np.array(ENDS))
    kept = tuple(dict.fromkeys((values[0], values[-1])))
    kind = Choices if isinstance(of, Choices) else Listed
    return kind(path=of.path, name=of.name, values=kept)


def _same(one: evaluation.PointResult, other: evaluation.PointResult) -> bool:
    """Whether all metrics of two points are equal; no invalid point is equal to any."""
    valid = not one.reason and not other.reason
    return valid and all(np.array_equal(getattr(one, of), getattr(other, of), True) for of in ("point", "runs"))


def divided(study: Study, of: Cost, *, workers: int = 1) -> Blocks:
    """The parts of a study: some seconds of work each, or fewer if the study is small, for so many workers to share."""
    stop, most = study.file.stop, study.file.most_runs
    usual = most if stop is None else (stop.least * most) ** 0.5  # between the fewest and the most
    each = max(of.point + of.valid * of.run * usual, 1e-6)
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
    return of_cost(study, trial.cost(study), workers=workers)


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
        seconds=study.count * of.point + of.valid * runs * of.run,
        bytes=8 * numbers + parts * (RECEIPT_BYTES + files * (FILE_BYTES + CHUNK_BYTES)) + described,
        cost=of,
    )
