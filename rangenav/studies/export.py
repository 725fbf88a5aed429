"""A store as a table, for tools that read CSV or Parquet: a row for each point and estimator, or for each run.

    point · parameters … · [estimator] · metrics of the point … · runs · metrics of runs with their intervals … · reason
    point · parameters … · estimator · run · seed · metrics of the run …                                    (every run)
It goes through the store part by part, so that a store of any size needs the memory of one part.
"""

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray as Array

from rangenav.inputs import require
from rangenav.studies import extra, intervals
from rangenav.studies.metrics import METRICS
from rangenav.studies.store import REASON, RUNS, Store
from rangenav.studies.study import POINT

Columns = dict[str, Array]
LOW, HIGH = "_low_95", "_high_95"
"""After a metric's name: the ends of the 95 % confidence interval of its mean, its median or its share."""


def to_csv(of: Store, path: Path, *, every_run: bool = False) -> int:
    """Write a CSV table, and return the number of its rows; NaN and infinite numbers are `nan` and `inf`.

    Raises OSError if the disk refuses, and ValueError for every run of a study without runs.
    """
    count = 0
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        for columns in tables(of, every_run=every_run):
            if count == 0:
                writer.writerow(columns)
            rows = list(zip(*(column.tolist() for column in columns.values()), strict=True))
            writer.writerows(rows)
            count += len(rows)
    return count


def to_parquet(of: Store, path: Path, *, every_run: bool = False) -> int:
    """Write a Parquet table, a row group for each part, and return the number of its rows. Raises as `to_csv` does."""
    arrow, parquet = extra.parquet()
    count, writer = 0, None
    try:
        for columns in tables(of, every_run=every_run):
            typed = {name: _typed(column) for name, column in columns.items()}
            table = arrow.table(typed, metadata=_metadata(of))
            writer = parquet.ParquetWriter(path, table.schema) if writer is None else writer
            writer.write_table(table)
            count += table.num_rows
    finally:
        if writer is not None:
            writer.close()
    return count


def _metadata(of: Store) -> dict[str, str]:
    """Which windows the metrics of observability come from, if the table has any."""
    file = of.study.file
    judged = any(METRICS[name].needs == "analysis" for name in file.metrics)
    return {"observability": file.windows_judged} if judged else {}


def tables(of: Store, *, every_run: bool = False) -> Iterator[Columns]:
    """The columns of each part that is done, in the order of the parts. Raises ValueError as `to_csv` does."""
    file = of.study.file
    require(not every_run or len(file.run_metrics) > 0, f"{of.path}: no metric of this study is of a run")
    done = sorted(of.done())
    require(len(done) > 0, f"{of.path}: no part is computed yet")
    for part in done:
        arrays, indices = of.read(part), of.blocks.indices(part)
        yield _each_run(of, indices, arrays) if every_run else _each_point(of, indices, arrays)


def _each_point(of: Store, indices: Array, arrays: dict[str, Array]) -> Columns:
    file = of.study.file
    estimators = len(file.estimators) if file.run_metrics else 1
    columns = {name: np.repeat(values, estimators) for name, values in _parameters(of, indices).items()}
    if file.run_metrics:
        columns["estimator"] = np.tile(np.array(file.estimators, dtype=object), len(indices))
    for name in file.point_metrics:
        columns[name] = np.repeat(arrays[name].ravel(), estimators)
    if file.run_metrics:
        columns[RUNS] = np.repeat(arrays[RUNS].ravel(), estimators)
    for name in file.run_metrics:
        values = arrays[name].reshape(len(columns[RUNS]), file.most_runs)
        kind = METRICS[name].middle
        columns[name] = intervals.middle(values, kind)
        columns[name + LOW], columns[name + HIGH] = intervals.interval(values, kind)
    columns[REASON] = np.repeat(np.asarray(arrays[REASON], dtype=object).ravel(), estimators)
    return columns


def _each_run(of: Store, indices: Array, arrays: dict[str, Array]) -> Columns:
    file, count = of.study.file, arrays[RUNS].ravel()
    point, estimator, run = (
        axis.ravel()
        for axis in np.meshgrid(
            np.arange(len(indices)), np.arange(len(file.estimators)), np.arange(file.most_runs), indexing="ij"
        )
    )
    there = run < count[point]
    point, estimator, run = point[there], estimator[there], run[there]
    columns = {name: values[point] for name, values in _parameters(of, indices).items()}
    columns["estimator"] = np.array(file.estimators, dtype=object)[estimator]
    columns["run"] = run
    columns["seed"] = np.array([of.study.seed(int(indices[p]), int(r)) for p, r in zip(point, run, strict=True)])
    for name in file.run_metrics:
        columns[name] = arrays[name].ravel()[there]
    return columns


def _parameters(of: Store, indices: Array) -> Columns:
    """The point's number, its preset if there are several, and its values of the parameters, by dimension."""
    study = of.study
    places = dict(zip(study.dimensions, np.unravel_index(indices, study.shape), strict=True))
    columns: dict[str, Any] = {POINT: indices}
    if len(study.bases) > 1:
        columns["preset"] = np.array(study.names, dtype=object)[places["preset"]]
    for name, values in study.values.items():
        columns[name] = values[places[name] if name in places else places["point"]]
    return columns


def _typed(column: Array) -> Any:
    return column.tolist() if column.dtype == object else column
