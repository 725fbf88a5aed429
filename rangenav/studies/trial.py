"""What a point and a run of a study take on this machine, from a trial of a few points that are made as the study does.

Neighbours in a part share what depends on no parameter that differs between them, so a place is timed twice: a point
after one far from it, and the point after that. Of L points along the last dimension one begins anew:
    point = (far + (L − 1) · next)/L.
Runs are timed in the groups that are made together, eight of them and those that are left:
    run = Σ groups · time of a group / Σ groups · its runs.
"""

import time
from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from rangenav.inputs import shortened
from rangenav.studies import evaluation
from rangenav.studies.parameters import Choices
from rangenav.studies.study import PRESET, Study
from rangenav.studies.study_file import Grid

TRIALS, TRIED, CHECKED = 3, 20, 100
"""Valid points that are timed at least, points that are timed at most, and points whose presets are made."""
SECONDS = 2.0
"""CPU time after which the least number is enough."""


@dataclass(frozen=True, kw_only=True)
class Cost:
    """CPU time on this machine, s: means over points that are spread over the study."""

    point: float
    """Of one point without its runs; of those whose preset does not fit it is taken as zero."""
    run: float
    """Of one seed, all estimators together."""
    tried: int
    """Points that were looked at."""
    invalid: int
    """Of them, those that are invalid."""
    reason: str = ""
    """Why the first of them is invalid; empty if none is."""
    reasons: tuple[str, ...] = ()
    """The same of all of them; of reasons that differ by numbers alone the first one."""
    valid: float = 1.0
    """The share of valid points, as far as it is known; the others have no runs."""


def warm_up(study: Study) -> None:
    """Compute a few valid points with their runs: every kernel that the study needs is then compiled, or loaded."""
    for places in (_places(study, TRIED)[::-1], *([index] for index in _kinds(study))):
        for index in places:
            if all(not evaluation.point(study, index, runs=runs).reason for runs in (*_groups(study), 0)):
                break


def cost(study: Study) -> Cost:
    """The CPU time of a point and of a run."""
    warm_up(study)
    reasons, places, along = _unfit(study), _places(study, CHECKED), study.shape[-1]
    fitting, groups = [index for index in places if not reasons[index]], _groups(study)
    far, following, runs, began = {}, [], [], time.thread_time()
    for index in fitting[:TRIED]:
        seconds, reasons[index] = _timed(study, index, 0)
        far.setdefault(index // along, seconds)  # a second point along the same line may find what the first one left
        if not reasons[index]:
            runs.append(_of_a_run(study, index, groups))
        following.append(_timed(study, index + 1 if (index + 1) % along else index - 1, 0)[0] if along > 1 else 0.0)
        if len(runs) >= TRIALS and time.thread_time() - began > SECONDS:
            break
    wrong, fit = [reason for reason in reasons.values() if reason], len(fitting) / len(places)
    return Cost(
        point=fit * (_mean(far.values()) + (along - 1) * _mean(following)) / along,
        run=_mean(runs),
        tried=len(reasons),
        invalid=len(wrong),
        reason=wrong[0] if wrong else "",
        reasons=evaluation.kinds(wrong),
        valid=fit * len(runs) / max(1, len(following)),
    )


def _mean(values: Collection[float]) -> float:
    return sum(values) / max(1, len(values))


def _of_a_run(study: Study, index: int, groups: Counter[int]) -> float:
    """The CPU time of one run at a point whose motion is cached by now."""
    if not groups:
        return 0.0
    without = _timed(study, index, 0)[0]
    taken = sum(count * max(0.0, _timed(study, index, runs)[0] - without) for runs, count in groups.items())
    return taken / sum(count * runs for runs, count in groups.items())


def _timed(study: Study, index: int, runs: int) -> tuple[float, str]:
    """The CPU time of a point with so many runs, and why it is invalid."""
    began = time.thread_time()  # that of this thread: a worker counts its own, too
    reason = evaluation.point(study, index, runs=runs).reason
    return time.thread_time() - began, reason


def _groups(study: Study) -> Counter[int]:
    """How many groups of so many runs a point has, as far as no stopping rule ends it."""
    file = study.file
    return Counter(len(group) for groups in evaluation.rounds(file, file.most_runs) for group in groups)


def _places(study: Study, most: int) -> list[int]:
    """At most so many points spread over the study, the first few of them as well as all: multiples of irrational
    steps, which leave no dimension out. All points of a small study are among them."""
    d, g = len(study.shape), 2.0
    for _ in range(32):
        g = (1 + g) ** (1 / (d + 1))  # the root of gᵈ⁺¹ = g + 1, the golden ratio of one dimension
    share = (0.5 + np.arange(most)[:, None] * g ** -np.arange(1.0, d + 1)) % 1.0
    place = np.floor(share * study.shape).astype(int)
    spread = [int(np.ravel_multi_index(one, study.shape)) for one in map(tuple, place)]
    return list(dict.fromkeys([*spread, *range(study.count)] if study.count <= most else spread))


def _kinds(study: Study) -> list[int]:
    """Points that have every preset and every word, which may need kernels of their own."""
    words = {one.dimension for one in study.file.parameters if isinstance(one, Choices)}
    alike = {PRESET, *words} if isinstance(study.file.design, Grid) else {PRESET}
    middle = [length // 2 for length in study.shape]
    places = [
        int(np.ravel_multi_index([*middle[:k], j, *middle[k + 1 :]], study.shape))
        for k, name in enumerate(study.dimensions)
        if name in alike
        for j in range(study.shape[k])
    ]
    if not isinstance(study.file.design, Grid):
        each = [np.unique(study.values[name].astype(str), return_index=True)[1] for name in words]
        places += [int(k) for first in each for k in first]
    return places[:TRIED]


def _unfit(study: Study) -> dict[int, str]:
    """Why a point is invalid, empty where it is valid as far as its preset shows: where each parameter has its least
    and its largest value, and at points spread over the study."""
    reasons = {}
    for index in (*_extremes(study), *_places(study, CHECKED)):
        try:
            study.preset_at(index)
            reasons[index] = ""
        except ValueError as error:
            reasons[index] = shortened(str(error))
    return reasons


def _extremes(study: Study) -> list[int]:
    """Points at which a parameter has its first or last value in a grid, its least or largest one in a sample."""
    if isinstance(study.file.design, Grid):
        middle = [length // 2 for length in study.shape]
        places = [[*middle[:k], end, *middle[k + 1 :]] for k, n in enumerate(study.shape) for end in (0, n - 1)]
        return sorted({int(np.ravel_multi_index(place, study.shape)) for place in places})
    points = [values for values in study.values.values() if values.dtype != object]
    return sorted({int(k) for values in points for k in (np.argmin(values), np.argmax(values))})
