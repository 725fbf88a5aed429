"""A new store: its groups, arrays, dimensions, coordinates, units and attributes, without results."""

import os
import shutil
import tempfile
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray as Array

from rangenav import preset
from rangenav.inputs import require
from rangenav.studies import extra, parameters, receipts, study_file, units
from rangenav.studies.blocks import Blocks
from rangenav.studies.estimators import ESTIMATORS
from rangenav.studies.metrics import METRICS, Metric
from rangenav.studies.store import FORMAT_VERSION, REASON, RUNS, SOURCE, SUFFIX, UNKNOWN, Store
from rangenav.studies.study import Study


def created(path: Path, study: Study, blocks: Blocks) -> Store:
    """A new store without results, there whole or not at all.

    Raises ValueError if the path cannot be one, and OSError if the disk refuses.
    """
    require(path.suffix == SUFFIX, f"{path}: the name of a store must end in {SUFFIX}")
    require(path.parent.is_dir(), f"{path}: no such folder")
    require(not path.exists(), f"{path}: exists already, and is no store of this study")
    temporary = Path(tempfile.mkdtemp(dir=path.parent, prefix=f"{path.stem}.", suffix=".partial"))
    try:
        temporary.chmod(0o777 & ~_umask())
        _fill(temporary, study, blocks)
        os.rename(temporary, path)
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise
    return Store(path, study, blocks, SOURCE)


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
            {"units": row.unit or "1", "long_name": row.title, **_windows(study, row)},
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
        "source": SOURCE,
        "rangenav_study": FORMAT_VERSION,
        "study": study_file.dumps(file),
        "presets": [preset.dumps(base) for base in study.bases],
        "preset_names": list(study.names),
        "digest": study.digest,
        "points_of_a_part": list(blocks.chunk),
        **({"coordinates": " ".join(inner)} if inner else {}),
    }


def _windows(study: Study, row: Metric) -> dict[str, str]:
    """Of a metric of observability, which windows it comes from."""
    return {"comment": study.file.windows_judged} if row.needs == "analysis" else {}


def _coordinates(study: Study) -> Iterator[tuple[str, tuple[str, ...], Any, dict[str, Any]]]:
    """Name, dimensions, values and attributes of every coordinate."""
    if len(study.bases) > 1:
        yield "preset", ("preset",), _texts(study.names), {"long_name": "preset"}
    for name, values in study.values.items():
        of = study.parameter(name)
        title = parameters.DERIVED.get(of.path, of.path)
        attributes = {"long_name": title, "path": of.path, "scale": parameters.scale(of)}
        unit = units.of(of, next(iter(study.bases)))
        if values.dtype != object and unit is not None:  # CF: "1" is a number without dimension
            attributes["units"] = unit or "1"
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
