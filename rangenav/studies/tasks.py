"""What a worker does: compile the kernels, and compute one part and write it into the store."""

import time
from pathlib import Path

import numpy as np
from numpy import ndarray as Array

from rangenav.inputs import require
from rangenav.studies import evaluation, intervals, store, trial
from rangenav.studies.evaluation import Block
from rangenav.studies.metrics import METRICS
from rangenav.studies.store import Store
from rangenav.studies.study import Study


def compile_kernels(path: str, digest: str) -> None:
    """Compile the kernels that a study needs into this host's cache, or load them from there."""
    trial.warm_up(_seen(path, digest).study)


def compute(path: str, digest: str, part: int) -> None:
    """Compute one part of a store and write it, with its receipt.

    Raises ValueError if this worker does not see the store, and OSError if the disk refuses.
    """
    of = _seen(path, digest)
    began = time.thread_time()
    block = evaluation.block(of.study, of.blocks.indices(part).tolist())
    width, met = _width(of.study, block.runs), _met(of.study, block)
    of.write(part, block, width=width, met=met, seconds=time.thread_time() - began)


def _seen(path: str, digest: str) -> Store:
    rule = f"{path}: a worker does not see this store; every worker needs the same folder"
    require(Path(path).is_dir(), rule)
    return store.cached(Path(path), digest)


def _width(study: Study, runs: Array) -> float | None:
    """The median over the points of the relative half width of the metric that is watched; None without any."""
    watched = study.watched
    if watched is None:
        return None
    values = runs[..., study.file.run_metrics.index(watched)]
    widths = intervals.relative_half_width(values, METRICS[watched].middle).max(axis=1)
    finite = widths[np.isfinite(widths)]
    return float(np.median(finite)) if len(finite) else None


def _met(study: Study, block: Block) -> int | None:
    """How many points meet the stopping rule; None without one."""
    stop = study.file.stop
    if stop is None:
        return None
    values = block.runs[..., study.file.run_metrics.index(stop.metric)]
    return sum(stop.met(of[:, :count]) for of, count in zip(values, block.count, strict=True))
