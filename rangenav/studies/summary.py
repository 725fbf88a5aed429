"""What a store holds, in a few figures: how much is done, where each metric is least and largest, what is invalid."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from numpy import ndarray as Array

from rangenav.studies import stopping
from rangenav.studies.store import REASON, Store


@dataclass(kw_only=True)
class Extremes:
    """The least and the largest value of a metric; of runs, of their mean at a point."""

    least: float = np.inf
    least_at: int = -1
    """The point; −1 if no value is finite."""
    largest: float = -np.inf
    largest_at: int = -1
    finite: int = 0
    """Points at which it is finite."""

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
        metrics={
            **{(name, ""): Extremes() for name in file.point_metrics},
            **{(name, estimator): Extremes() for name in file.run_metrics for estimator in file.estimators},
        },
    )
    for receipt in done:
        arrays, indices = of.read(receipt.part), of.blocks.indices(receipt.part)
        for name in file.point_metrics:
            result.metrics[name, ""].take(arrays[name].ravel(), indices)
        for name in file.run_metrics:
            means = stopping.mean(arrays[name]).reshape(len(indices), len(file.estimators))
            for k, estimator in enumerate(file.estimators):
                result.metrics[name, estimator].take(means[:, k], indices)
        reasons = np.asarray(arrays[REASON], dtype=object).ravel()
        result.reasons.update(reasons[reasons != ""].tolist())
    return result
