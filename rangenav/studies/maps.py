"""A small map of two parameters, computed in this process from coarse to fine: for a page, or a notebook.

    for map in maps.coarse_to_fine(study, cancelled=...): draw(map)
Every point is computed once, and has the value that a store of the same study has. No dask and no zarr is needed.
"""

import time
from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Int, Shaped
from numpy import ndarray as Array

from rangenav.inputs import require
from rangenav.progress import Cancelled, CancelledError, Progress, never, unheard
from rangenav.results import result
from rangenav.studies import evaluation, intervals
from rangenav.studies.metrics import METRICS
from rangenav.studies.study import Study
from rangenav.studies.study_file import Grid

MAX_POINTS = 40_000
COARSEST = 8
"""Points apart, along each axis, at first; a power of two."""
EVERY = 0.4
"""s between two maps, at least."""


@result
class StudyMap:
    """Metrics over two parameters: the first one along the rows, the second one along the columns."""

    first: Float[Array, "n"]
    second: Float[Array, "m"]
    values: dict[str, Float[Array, "n m"]]
    """Each metric; of runs their mean, median or share, of the study's first estimator. NaN where it is not computed,
    or invalid."""
    computed: Bool[Array, "n m"]
    reason: Shaped[Array, "n m"]
    """Why a point is invalid, as objects; empty where it is valid, or not computed yet."""
    step: int
    """How many points apart the points of the finest complete level are; 1 at the end, 0 before the first level."""

    @property
    def share(self) -> float:
        """The share of the points that is computed."""
        return float(np.mean(self.computed))

    def filled(self, metric: str) -> Float[Array, "n m"]:
        """A metric with the value of the nearest coarser point in place of each that is not computed yet."""
        values, known = self.values[metric].copy(), self.computed.copy()
        step = 2 * COARSEST
        while step > 1:
            step //= 2
            rows, columns = (_nearest(length, step) for length in known.shape)
            at = rows[:, None], columns
            take = ~known & self.computed[at]
            values[take] = self.values[metric][at][take]
        return values


def coarse_to_fine(
    study: Study,
    *,
    begun: StudyMap | None = None,
    every: float = EVERY,
    progress: Progress = unheard,
    cancelled: Cancelled = never,
) -> Iterator[StudyMap]:
    """Maps of a grid of two parameters, each with more points than the one before; the last one has all.

    begun: a map of the same study that was stopped; its points are not computed again. every: s between two maps, at
    least. The arrays of a map are its own. Raises ValueError if the study is no grid of
    two parameters with numbers, and CancelledError when it is cancelled.
    """
    _refuse(study)
    shape, names = study.shape, study.file.metrics
    values = {name: np.full(shape, np.nan) for name in names}
    computed, reason = np.zeros(shape, dtype=bool), np.full(shape, "", dtype=object)
    if begun is not None:
        values = {name: begun.values[name].copy() for name in names}
        computed, reason = begun.computed.copy(), begun.reason.copy()
    first, second = study.values.values()
    complete, last = 0 if begun is None else begun.step, time.monotonic()

    def now() -> StudyMap:
        return StudyMap(
            first=first,
            second=second,
            values={name: array.copy() for name, array in values.items()},
            computed=computed.copy(),
            reason=reason.copy(),
            step=complete,
        )

    for step in _steps(shape):
        for place in _level(shape, step, computed):
            if cancelled():
                raise CancelledError
            index = int(np.ravel_multi_index(place, shape))
            done = evaluation.point(study, index, cancelled=cancelled)
            computed[place], reason[place] = True, done.reason
            for name, value in _means(study, done).items():
                values[name][place] = value
            progress(float(np.mean(computed)))
            if time.monotonic() - last >= every:
                yield now()
                last = time.monotonic()
        complete = min(complete or step, step)
        yield now()
        last = time.monotonic()


def _nearest(length: int, step: int) -> Int[Array, "n"]:
    """Of each index along an axis the nearest one of a level."""
    return np.minimum((np.arange(length) + step // 2) // step, (length - 1) // step) * step


def _refuse(study: Study) -> None:
    rule = "a map needs a grid of two parameters with numbers and one preset"
    usual = isinstance(study.file.design, Grid) and len(study.bases) == 1 and len(study.shape) == 2
    require(usual and all(values.dtype != object for values in study.values.values()), rule)
    require(study.count <= MAX_POINTS, f"a map may have {MAX_POINTS} points, got {study.count}")


def _steps(shape: tuple[int, ...]) -> list[int]:
    """Distances of the points of each level: halved until every point is there."""
    steps = [COARSEST]
    while steps[-1] > 1:
        steps.append(steps[-1] // 2)
    return [step for step in steps if step == 1 or step < max(shape)]


def _level(shape: tuple[int, ...], step: int, computed: Array) -> list[tuple[int, int]]:
    """The points of one level that no coarser level has."""
    return [(i, j) for i in range(0, shape[0], step) for j in range(0, shape[1], step) if not computed[i, j]]


def _means(study: Study, done: evaluation.PointResult) -> dict[str, float]:
    file = study.file
    found = dict(zip(file.point_metrics, done.point.tolist(), strict=True))
    for k, name in enumerate(file.run_metrics):
        found[name] = float(intervals.middle(done.runs[:1, :, k], METRICS[name].middle)[0])
    return found
