"""The store of a study: a zarr v3 group that xarray opens, with a chunk of every array for each part.

dimensions     each parameter of a grid, or `point`; `preset` if there are several; `estimator` and `run`
variables      each metric; `runs`, how many there are (−1: not computed yet); `reason`, why a point is invalid
attributes     the study's file and its presets as TOML, so that a store can be repeated and gone on with
"""

from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from filelock import FileLock, Timeout
from numpy import ndarray as Array

import rangenav
from rangenav import preset
from rangenav.inputs import require
from rangenav.studies import extra, receipts, study_file
from rangenav.studies.blocks import Blocks
from rangenav.studies.evaluation import Block
from rangenav.studies.receipts import Receipt
from rangenav.studies.study import Study, of_file

SUFFIX = ".zarr"
FORMAT_VERSION = 1
SOURCE = f"rangenav {rangenav.__version__}"
RUNS, REASON = "runs", "reason"
UNKNOWN = -1
"""Runs of a point that is not computed yet."""


@dataclass(frozen=True)
class Store:
    """A study's store on the disk."""

    path: Path
    study: Study
    blocks: Blocks
    source: str
    """The version of rangenav that began it."""

    @cached_property
    def arrays(self) -> Mapping[str, Any]:
        """The zarr arrays of the results, by name, for reading and writing."""
        zarr = extra.zarr()
        with zarr.config.set({"array.write_empty_chunks": True}):  # a chunk of NaN only is a result, too
            group = zarr.open_group(self.path, mode="r+", use_consolidated=False)
            return {name: group[name] for name in (*self.study.file.metrics, RUNS, REASON)}

    def write(
        self, part: int, block: Block, *, seconds: float, width: float | None = None, met: int | None = None
    ) -> Receipt:
        """Write one part and its receipt. Raises OSError, and leaves no receipt, if the disk refuses."""
        region, extent, file = self.blocks.region(part), self.blocks.extent(part), self.study.file
        for k, name in enumerate(file.point_metrics):
            self.arrays[name][region] = block.point[:, k].reshape(extent)
        for k, name in enumerate(file.run_metrics):
            self.arrays[name][region] = block.runs[..., k].reshape(*extent, *block.runs.shape[1:3])
        self.arrays[RUNS][region] = block.count.astype(np.int32).reshape(extent)
        self.arrays[REASON][region] = block.reason.reshape(extent)
        names = tuple(self.chunks(part))
        with ThreadPoolExecutor(len(names)) as pool:  # the disk flushes several files in the time of one
            digests = tuple(pool.map(receipts.flushed, (self.path / name for name in names)))
        receipt = Receipt(
            part=part,
            study=self.study.digest,
            points=len(block.index),
            invalid=int(np.sum(block.reason != "")),
            runs=int(block.count.sum()),
            width=width,
            met=met,
            seconds=seconds,
            files=tuple(zip(names, digests, strict=True)),
        )
        receipts.write(self.path, receipt)
        return receipt

    def chunks(self, part: int) -> Iterator[str]:
        """The files of a part below the store."""
        place = "/".join(map(str, self.blocks.place(part)))
        for name in (*self.study.file.point_metrics, RUNS, REASON):
            yield f"{name}/c/{place}"
        for name in self.study.file.run_metrics:
            yield f"{name}/c/{place}/0/0"

    def done(self) -> dict[int, Receipt]:
        """The receipts of all parts whose files are whole, by part."""
        return {part: receipt for part, receipt in self.receipts().items() if receipt is not None}

    def receipts(self) -> dict[int, Receipt | None]:
        """The receipt of every part that has one, by part; None where it, or a file of its part, is damaged."""
        return {part: self._whole(part, receipt) for part, receipt in receipts.written(self.path)}

    def _whole(self, part: int, receipt: Receipt | None) -> Receipt | None:
        if receipt is None or receipt.study != self.study.digest or receipt.part != part:
            return None
        return receipt if part < self.blocks.count and receipts.whole(self.path, receipt) else None

    def read(self, part: int) -> dict[str, Array]:
        """Every array of one part, by name; the first axes are those of the part."""
        region = self.blocks.region(part)
        return {name: np.asarray(array[region]) for name, array in self.arrays.items()}

    @contextmanager
    def locked(self) -> Iterator[None]:
        """While one program computes a store, others are refused with ValueError; a crash leaves no lock."""
        try:
            with FileLock(self.path / receipts.FOLDER / "lock", timeout=0):
                yield
        except Timeout:
            raise ValueError(f"{self.path}: another program is computing this study") from None


def opened(path: Path) -> Store:
    """A store that exists. Raises ValueError with one sentence if it is none."""
    zarr = extra.zarr()
    there = path.with_suffix(SUFFIX)
    meant = f"; did you mean {there}?" if there != path and there.is_dir() else ""
    require(path.exists(), f"{path}: no such store{meant}")
    require(path.is_dir(), f"{path}: a file, and no store of a study{meant}")
    try:
        attributes = dict(zarr.open_group(path, mode="r").attrs)
    except (OSError, KeyError, TypeError, ValueError):
        raise ValueError(f"{path}: no zarr group, so no store of a study") from None
    require("rangenav_study" in attributes, f"{path}: a zarr group, but no store of a study")
    require(attributes["rangenav_study"] == FORMAT_VERSION, f"{path}: of a later version of rangenav")
    try:
        file = study_file.loads(attributes["study"], source=f"{path}, attribute study")
        bases = tuple(preset.loads(text, source=f"{path}, a preset") for text in attributes["presets"])
        study = of_file(file, bases, tuple(attributes["preset_names"]))
        chunk, source = tuple(attributes["points_of_a_part"]), str(attributes["source"])
    except (KeyError, TypeError) as error:
        raise ValueError(f"{path}: an attribute of the study is damaged ({error})") from None
    return Store(path, study, Blocks(study.shape, chunk), source)


@lru_cache(maxsize=4)
def cached(path: Path, digest: str) -> Store:
    """A store by its path and its study's digest, opened once in each worker. Raises ValueError as `opened` does."""
    store = opened(path)
    require(store.study.digest == digest, f"{path}: holds another study")
    return store
