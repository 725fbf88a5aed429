"""The store of a study: a zarr v3 group that xarray opens, with a chunk of every array for each part.

dimensions     each parameter of a grid, or `point`; `preset` if there are several; `estimator` and `run`
variables      each metric; `runs`, how many there are (−1: not computed yet); `reason`, why a point is invalid
attributes     the study's file and its presets as TOML, so that a store can be repeated and gone on with
"""

import os
import shutil
import tempfile
import warnings
from collections.abc import Iterator, Mapping, Sequence
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
from rangenav.studies import extra, parameters, receipts, study_file, units
from rangenav.studies.blocks import Blocks
from rangenav.studies.estimators import ESTIMATORS
from rangenav.studies.evaluation import Block
from rangenav.studies.metrics import METRICS
from rangenav.studies.receipts import Receipt
from rangenav.studies.study import Study, of_file

SUFFIX = ".zarr"
FORMAT_VERSION = 1
RUNS, REASON = "runs", "reason"
UNKNOWN = -1
"""Runs of a point that is not computed yet."""


@dataclass(frozen=True)
class Store:
    """A study's store on the disk."""

    path: Path
    study: Study
    blocks: Blocks

    @cached_property
    def arrays(self) -> Mapping[str, Any]:
        """The zarr arrays of the results, by name, for reading and writing."""
        zarr = extra.zarr()
        with zarr.config.set({"array.write_empty_chunks": True}):  # a chunk of NaN only is a result, too
            group = zarr.open_group(self.path, mode="r+", use_consolidated=False)
            return {name: group[name] for name in (*self.study.file.metrics, RUNS, REASON)}

    def write(self, part: int, block: Block, *, width: float | None, seconds: float) -> Receipt:
        """Write one part and its receipt. Raises OSError, and leaves no receipt, if the disk refuses."""
        region, extent, file = self.blocks.region(part), self.blocks.extent(part), self.study.file
        for k, name in enumerate(file.point_metrics):
            self.arrays[name][region] = block.point[:, k].reshape(extent)
        for k, name in enumerate(file.run_metrics):
            self.arrays[name][region] = block.runs[..., k].reshape(*extent, *block.runs.shape[1:3])
        self.arrays[RUNS][region] = block.count.astype(np.int32).reshape(extent)
        self.arrays[REASON][region] = block.reason.reshape(extent)
        files = tuple((name, receipts.flushed(self.path / name)) for name in self.chunks(part))
        receipt = Receipt(
            part=part,
            study=self.study.digest,
            points=len(block.index),
            invalid=int(np.sum(block.reason != "")),
            runs=int(block.count.sum()),
            width=width,
            seconds=seconds,
            files=files,
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
    require(path.exists(), f"{path}: no such store")
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
        chunk = tuple(attributes["points_of_a_part"])
    except (KeyError, TypeError) as error:
        raise ValueError(f"{path}: an attribute of the study is damaged ({error})") from None
    return Store(path, study, Blocks(study.shape, chunk))


@lru_cache(maxsize=4)
def cached(path: Path, digest: str) -> Store:
    """A store by its path and its study's digest, opened once in each worker. Raises ValueError as `opened` does."""
    store = opened(path)
    require(store.study.digest == digest, f"{path}: holds another study")
    return store


def created(path: Path, study: Study, blocks: Blocks) -> Store:
    """A new store without results, there whole or not at all.

    Raises ValueError if the path cannot be one, and OSError if the disk refuses.
    """
    require(path.suffix == SUFFIX, f"{path}: the name of a store must end in {SUFFIX}")
    require(path.parent.is_dir(), f"{path}: no such folder as {path.parent}")
    require(not path.exists(), f"{path}: exists already, and is no store of this study")
    temporary = Path(tempfile.mkdtemp(dir=path.parent, prefix=f"{path.stem}.", suffix=".partial"))
    try:
        temporary.chmod(0o777 & ~_umask())
        _fill(temporary, study, blocks)
        os.rename(temporary, path)
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise
    return Store(path, study, blocks)


def _fill(path: Path, study: Study, blocks: Blocks) -> None:
    zarr = extra.zarr()
    file = study.file
    group = zarr.create_group(path, zarr_format=3, overwrite=True, attributes=_attributes(study, blocks))
    group.create_group(receipts.FOLDER)
    for name, dimensions, values, attributes in _coordinates(study):
        _create(group, name, dimensions, values.shape, values.shape, values.dtype, attributes)[:] = values
    inner, extra_shape = (*study.dimensions, "estimator", "run"), (len(file.estimators), file.most_runs)
    for name in file.metrics:
        row = METRICS[name]
        of_run = row.needs == "run"
        _create(
            group,
            name,
            inner if of_run else study.dimensions,
            (*study.shape, *extra_shape) if of_run else study.shape,
            (*blocks.chunk, *extra_shape) if of_run else blocks.chunk,
            np.dtype(np.float64),
            {"units": row.unit or "1", "long_name": row.title},
        )
    words = {"long_name": "runs of the point", "units": "1", "comment": "-1: not computed yet; 0: invalid, see reason"}
    _create(group, RUNS, study.dimensions, study.shape, blocks.chunk, np.dtype(np.int32), words)
    words = {"long_name": "why the point is invalid"}
    _create(group, REASON, study.dimensions, study.shape, blocks.chunk, np.dtype(object), words)
    with warnings.catch_warnings():  # the format of this index is not standardised yet; every reader does without it
        warnings.simplefilter("ignore")
        zarr.consolidate_metadata(path)


def _attributes(study: Study, blocks: Blocks) -> dict[str, Any]:
    file = study.file
    inner = [name for name in study.values if name not in study.dimensions]
    return {
        "title": file.title,
        "Conventions": "CF-1.11",
        "source": f"rangenav {rangenav.__version__}",
        "rangenav_study": FORMAT_VERSION,
        "study": study_file.dumps(file),
        "presets": [preset.dumps(base) for base in study.bases],
        "preset_names": list(study.names),
        "digest": study.digest,
        "points_of_a_part": list(blocks.chunk),
        **({"coordinates": " ".join(inner)} if inner else {}),
    }


def _coordinates(study: Study) -> Iterator[tuple[str, tuple[str, ...], Any, dict[str, Any]]]:
    """Name, dimensions, values and attributes of every coordinate."""
    if len(study.bases) > 1:
        yield "preset", ("preset",), _texts(study.names), {"long_name": "preset"}
    for name, values in study.values.items():
        of = study.parameter(name)
        title = parameters.DERIVED.get(of.path, of.path)
        attributes = {"long_name": title, "path": of.path, "scale": parameters.scale(of)}
        if values.dtype != object:
            attributes["units"] = units.of(of, next(iter(study.bases))) or "1"
        yield name, ((name,) if name in study.dimensions else ("point",)), values, attributes
    if study.file.run_metrics:
        titles = [ESTIMATORS[name].title for name in study.file.estimators]
        yield "estimator", ("estimator",), _texts(study.file.estimators), {"long_name": "estimator", "titles": titles}
        yield "run", ("run",), np.arange(study.file.most_runs), {"long_name": "run", "units": "1"}


def _texts(words: Sequence[str]) -> Array:
    return np.array(words, dtype=object)


def _create(
    group: Any,
    name: str,
    dimensions: tuple[str, ...],
    shape: tuple[int, ...],
    chunks: tuple[int, ...],
    kind: np.dtype,
    attributes: dict[str, Any],
) -> Any:
    text = kind == np.dtype(object)
    fill = "" if text else UNKNOWN if kind == np.dtype(np.int32) else np.nan if kind.kind == "f" else 0
    return group.create_array(
        name,
        shape=shape,
        chunks=chunks,
        dtype="str" if text else kind,
        fill_value=fill,
        dimension_names=dimensions,
        attributes=attributes,
    )


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
