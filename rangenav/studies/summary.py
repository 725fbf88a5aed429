"""What a store holds, in a few figures: how much is done, what is invalid, and of each metric where it is least and
largest, and at how many points it meets its bound; at how many points every metric does."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool
from numpy import ndarray as Array

from rangenav.studies import evaluation, intervals
from rangenav.studies.metrics import METRICS
from rangenav.studies.requirements import DEPENDENT, Bound, bound_of
from rangenav.studies.store import REASON, Store
from rangenav.studies.study import POINT, Study

FEW = 3
"""Points that are named one by one."""
Key = tuple[str, str]
"""A metric and an estimator; the estimator of a metric of the point is empty."""


@dataclass(kw_only=True)
class Points:
    """How many points have a property, and the first few of them."""

    count: int = 0
    first: list[int] = field(default_factory=list)

    def take(self, indices: Array) -> None:
        """Take more points into account."""
        self.count += len(indices)
        self.first += indices[: FEW - len(self.first)].tolist()


@dataclass(kw_only=True)
class Extremes:
    """The least and the largest value of a metric, and where it meets its bound; of several runs at a point the middle
    counts."""

    least: float = np.inf
    least_at: int = -1
    """The point; −1 if no value is finite."""
    largest: float = -np.inf
    largest_at: int = -1
    finite: int = 0
    """Points at which it is finite."""
    best: float = np.nan
    """Of the points that meet every bound."""
    best_at: int = -1
    """The point; −1 if there is none, or if no value of the metric is better than another."""
    bounds: tuple[Bound | None, ...] = ()
    """Of each base preset; empty if the metric is compared with nothing."""
    met: Points = field(default_factory=Points)
    missed: Points = field(default_factory=Points)
    """Valid points that do not meet the bound."""
    within: dict[str, tuple[float, float]] = field(default_factory=dict)
    """The least and the largest value of each parameter at the points that meet the bound, by dimension."""

    @property
    def meets(self) -> int:
        """Points at which it meets the bound."""
        return self.met.count

    def judged(self, values: Array, base: Array) -> Bool[Array, "n"]:
        """Whether each value meets the bound of its base preset; a preset without such a bound is always met."""
        result = np.ones(len(values), dtype=bool)
        for k, bound in enumerate(self.bounds):
            if bound is not None:
                result[base == k] = bound.met(values[base == k])
        return result

    def take(self, values: Array, indices: Array) -> None:
        """Take more points into account."""
        finite = np.isfinite(values)
        self.finite += int(finite.sum())
        if not finite.any():
            return
        low, high = np.argmin(np.where(finite, values, np.inf)), np.argmax(np.where(finite, values, -np.inf))
        if values[low] < self.least:
            self.least, self.least_at = float(values[low]), int(indices[low])
        if values[high] > self.largest:
            self.largest, self.largest_at = float(values[high]), int(indices[high])

    def take_best(self, values: Array, indices: Array, *, more: bool) -> None:
        """Take more points that meet every bound into account; `more`: whether larger values are better."""
        finite = np.isfinite(values)
        if not finite.any():
            return
        k = int(np.argmax(np.where(finite, values if more else -values, -np.inf)))
        if self.best_at < 0 or (values[k] > self.best if more else values[k] < self.best):
            self.best, self.best_at = float(values[k]), int(indices[k])

    def take_met(self, met: Array, valid: Array, study: Study, indices: Array) -> None:
        """Take into account where the bound is met."""
        self.met.take(indices[met & valid])
        self.missed.take(indices[~met & valid])
        if not (met & valid).any():
            return
        places = dict(zip(study.dimensions, np.unravel_index(indices[met & valid], study.shape), strict=True))
        for name, values in study.values.items():
            if values.dtype != object:
                there = values[places.get(name, places.get(POINT))]
                low, high = self.within.get(name, (np.inf, -np.inf))
                self.within[name] = float(min(low, there.min())), float(max(high, there.max()))


@dataclass(kw_only=True)
class Summary:
    """What a store holds."""

    parts: int
    done: int
    damaged: int
    """Parts with a receipt whose files, or whose receipt, are not what was written."""
    points: int
    invalid: int
    runs: int
    seconds: float
    """CPU time of the parts that are done."""
    stopped: int | None
    """Points that meet the stopping rule; None without one."""
    metrics: dict[Key, Extremes] = field(default_factory=dict)
    together: dict[str, Points] = field(default_factory=dict)
    """Points that meet every bound, by estimator; of an empty name if no metric is of a run."""
    reasons: Counter[str] = field(default_factory=Counter)
    """Invalid points by reason; of reasons that differ by numbers alone, the first one."""


def summary(of: Store) -> Summary:
    """What a store holds; it reads the store part by part."""
    file, receipts = of.study.file, of.receipts()
    done = [receipt for receipt in receipts.values() if receipt is not None]
    estimators = file.estimators if file.run_metrics else ("",)
    keys = [(name, "") for name in file.point_metrics]
    keys += [(name, estimator) for name in file.run_metrics for estimator in file.estimators]
    result = Summary(
        parts=of.blocks.count,
        done=len(done),
        damaged=len(receipts) - len(done),
        points=sum(one.points for one in done),
        invalid=sum(one.invalid for one in done),
        runs=sum(one.runs for one in done),
        seconds=sum(one.seconds for one in done),
        stopped=None if file.stop is None else sum(one.met or 0 for one in done),
        metrics={key: Extremes(bounds=_bounds(of.study, key[0])) for key in keys},
        together={estimator: Points() for estimator in estimators},
    )
    kinds: dict[str, str] = {}
    for receipt in done:
        arrays, indices = of.read(receipt.part), of.blocks.indices(receipt.part)
        reasons = np.asarray(arrays[REASON], dtype=object).ravel()
        _take(result, of.study, indices, _middles(of.study, arrays, len(indices)), reasons == "")
        for words in reasons[reasons != ""].tolist():
            result.reasons[kinds.setdefault(evaluation.kind(words), words)] += 1
    return result


def varied(study: Study) -> str | None:
    """The parameter that changes a requirement or a limit from point to point; None without one."""
    paths = (parameter.path for parameter in study.file.parameters)
    return next((path for path in paths if path.startswith(("requirement.", "vehicle."))), None)


def _middles(study: Study, arrays: dict[str, Array], points: int) -> dict[Key, Array]:
    """The value of each metric at each point of a part; of several runs their middle."""
    file = study.file
    values = {(name, ""): arrays[name].ravel() for name in file.point_metrics}
    for name in file.run_metrics:
        middles = intervals.middle(arrays[name], METRICS[name].middle).reshape(points, len(file.estimators))
        values |= {(name, estimator): middles[:, k] for k, estimator in enumerate(file.estimators)}
    return values


def _take(result: Summary, study: Study, indices: Array, values: dict[Key, Array], valid: Array) -> None:
    """Take the points of a part into account."""
    base = study.base_of(indices)
    met = {key: one.judged(values[key], base) for key, one in result.metrics.items() if one.bounds}
    among = {}
    for estimator, points in result.together.items():
        every = [of for (_, name), of in met.items() if name in ("", estimator)]
        among[estimator] = np.all([valid, *every], axis=0)
        points.take(indices[among[estimator]])
    any_of = np.any(list(among.values()), axis=0)
    for key, one in result.metrics.items():
        one.take(values[key], indices)
        there, better = among.get(key[1], any_of), METRICS[key[0]].better
        if met and better != "neither":
            one.take_best(values[key][there], indices[there], more=better == "more")
        if key in met:
            one.take_met(met[key], valid, study, indices)


def _bounds(study: Study, metric: str) -> tuple[Bound | None, ...]:
    """What the metric is compared with, for each base preset; empty with nothing, or if it changes with the point."""
    bounds = tuple(bound_of(metric, base) for base in study.bases)
    changes = varied(study) is not None and metric in DEPENDENT
    return () if changes or not any(bounds) else bounds
