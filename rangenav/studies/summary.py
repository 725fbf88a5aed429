"""What a store holds, in a few figures: how much is done, what is invalid, and of each metric where it is least and
largest, and at how many points, between which values of the parameters, it meets its bound."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from numpy import ndarray as Array

from rangenav.studies import intervals
from rangenav.studies.metrics import METRICS
from rangenav.studies.requirements import Bound, bound_of
from rangenav.studies.store import REASON, Store
from rangenav.studies.study import POINT, Study


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
    bound: Bound | None = None
    meets: int = 0
    """Points at which it meets the bound."""
    within: dict[str, tuple[float, float]] = field(default_factory=dict)
    """The least and the largest value of each parameter at those points, by dimension."""

    def take(self, values: Array, study: Study, indices: Array) -> None:
        """Take more points into account."""
        if self.bound is not None:
            self._judge(self.bound.met(values), study, indices)
        finite = np.isfinite(values)
        self.finite += int(finite.sum())
        if not finite.any():
            return
        low, high = np.argmin(np.where(finite, values, np.inf)), np.argmax(np.where(finite, values, -np.inf))
        if values[low] < self.least:
            self.least, self.least_at = float(values[low]), int(indices[low])
        if values[high] > self.largest:
            self.largest, self.largest_at = float(values[high]), int(indices[high])

    def _judge(self, met: Array, study: Study, indices: Array) -> None:
        self.meets += int(met.sum())
        if not met.any():
            return
        places = dict(zip(study.dimensions, np.unravel_index(indices[met], study.shape), strict=True))
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
    met: int | None
    """Points that meet the stopping rule; None without one."""
    metrics: dict[tuple[str, str], Extremes] = field(default_factory=dict)
    """By metric and estimator; the estimator of a metric of the point is empty."""
    reasons: Counter[str] = field(default_factory=Counter)
    """Invalid points by reason."""


def summary(of: Store) -> Summary:
    """What a store holds; it reads the store part by part."""
    file, receipts = of.study.file, of.receipts()
    done = [receipt for receipt in receipts.values() if receipt is not None]
    result = Summary(
        parts=of.blocks.count,
        done=len(done),
        damaged=len(receipts) - len(done),
        points=sum(one.points for one in done),
        invalid=sum(one.invalid for one in done),
        runs=sum(one.runs for one in done),
        seconds=sum(one.seconds for one in done),
        met=None if file.stop is None else sum(one.met or 0 for one in done),
        metrics={
            **{(name, ""): Extremes(bound=_bound(of.study, name)) for name in file.point_metrics},
            **{
                (name, estimator): Extremes(bound=_bound(of.study, name))
                for name in file.run_metrics
                for estimator in file.estimators
            },
        },
    )
    for receipt in done:
        arrays, indices = of.read(receipt.part), of.blocks.indices(receipt.part)
        for name in file.point_metrics:
            result.metrics[name, ""].take(arrays[name].ravel(), of.study, indices)
        for name in file.run_metrics:
            middles = intervals.middle(arrays[name], METRICS[name].middle).reshape(len(indices), len(file.estimators))
            for k, estimator in enumerate(file.estimators):
                result.metrics[name, estimator].take(middles[:, k], of.study, indices)
        reasons = np.asarray(arrays[REASON], dtype=object).ravel()
        result.reasons.update(reasons[reasons != ""].tolist())
    return result


def _bound(study: Study, metric: str) -> Bound | None:
    """What the metric is compared with, if that is the same at every point."""
    varied = any(parameter.path.startswith(("requirement.", "vehicle.")) for parameter in study.file.parameters)
    bounds = {bound_of(metric, base) for base in study.bases}
    return bounds.pop() if len(bounds) == 1 and not varied else None
