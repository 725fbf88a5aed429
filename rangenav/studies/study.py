"""A study that can be computed: its file, its base presets, its points, and the preset and the seeds of each point."""

import difflib
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from jaxtyping import Int, Shaped
from numpy import ndarray as Array

from rangenav import field_path, preset, signals
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.studies import file_errors, parameter_paths, study_file
from rangenav.studies.parameters import DERIVED, SIZE, TIME_SCALE, Parameter
from rangenav.studies.study_file import Grid, Sobol, StudyFile

PRESET, POINT = "preset", "point"
"""Names of dimensions."""
SEED_BITS = 53
"""The largest seed of a run: a preset takes it, too."""
BOX_SAMPLES = 401
FOLDER = Path(__file__).parent / "shipped"


@dataclass(frozen=True)
class Study:
    """A study's file with its base presets; points are counted in the order of the dimensions, the last one fastest."""

    file: StudyFile
    bases: tuple[Preset, ...]
    names: tuple[str, ...]
    """Of the bases."""

    @cached_property
    def dimensions(self) -> tuple[str, ...]:
        """`preset` if there are several, then each parameter of a grid, or `point` of a sample."""
        several = (PRESET,) if len(self.bases) > 1 else ()
        inner = tuple(p.dimension for p in self.file.parameters) if self._grid else (POINT,)
        return (*several, *inner) or (POINT,)

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """How long each dimension is."""
        several = (len(self.bases),) if len(self.bases) > 1 else ()
        inner = tuple(len(values) for values in self.values.values()) if self._grid else (self._sampled,)
        return (*several, *inner) or (1,)

    @property
    def count(self) -> int:
        """How many points there are."""
        return int(np.prod(self.shape, dtype=object))

    @cached_property
    def values(self) -> Mapping[str, Shaped[Array, "n"]]:
        """The values of each parameter by the name of its dimension: of a grid along it, of a sample at each point."""
        parameters = self.file.parameters
        if self._grid:
            return {one.dimension: one.grid() for one in parameters}
        share = _shares(self.file)
        return {one.dimension: one.quantile(share[:, k]) for k, one in enumerate(parameters)}

    @cached_property
    def digest(self) -> str:
        """The SHA-256 of all that decides the results: a study of the same digest goes on in the same store."""
        content = [study_file.dumps(self.file), *self.names, *map(preset.dumps, self.bases)]
        return hashlib.sha256("\0".join(content).encode()).hexdigest()

    @property
    def watched(self) -> str | None:
        """The metric whose interval the progress shows: the stopping rule's, else the first of a run; None without."""
        file = self.file
        return file.stop.metric if file.stop is not None else next(iter(file.run_metrics), None)

    def parameter(self, dimension: str) -> Parameter:
        """The parameter of a dimension."""
        (one,) = (one for one in self.file.parameters if one.dimension == dimension)
        return one

    def at(self, index: int) -> dict[str, float | str]:
        """The values of the parameters at a point, by their paths."""
        place = self._place(index)
        count = len(self.file.parameters)
        inner = place[len(place) - count :] if self._grid else place[-1:] * count
        return {
            parameter.path: _plain(values[k])
            for parameter, values, k in zip(self.file.parameters, self.values.values(), inner, strict=True)
        }

    def place(self, index: int) -> dict[str, float | str]:
        """A point for a person: its number, its preset if there are several, and the values of its parameters."""
        base = {PRESET: self.names[int(self.base_of(np.array([index]))[0])]} if len(self.bases) > 1 else {}
        return {POINT: index, **base, **self.at(index)}

    def base_of(self, indices: Int[Array, "n"]) -> Int[Array, "n"]:
        """The number of each point's base preset, from 0."""
        return indices // (self.count // len(self.bases))

    def preset_at(self, index: int) -> Preset:
        """The preset of a point. Raises ValueError with one sentence if the values do not fit."""
        base = self.bases[int(self.base_of(np.array([index]))[0])]
        values = self.at(index)
        changed = {path: value for path, value in values.items() if path not in DERIVED}
        of = field_path.replaced(base, changed) if changed else base
        for name in DERIVED:
            if name in values:
                of = _with_path(of, name, float(values[name]))
        return of

    def seed(self, index: int, run: int) -> int:
        """The seed of a run: it depends on nothing but the study's seed and on both indices, or on `run` alone."""
        key = (run,) if self.file.common_seeds else (index, run)
        sequence = np.random.SeedSequence(self.file.seed, spawn_key=key)
        return int(sequence.generate_state(1, np.uint64)[0]) >> (64 - SEED_BITS)

    def _place(self, index: int) -> tuple[int, ...]:
        return tuple(int(k) for k in np.unravel_index(index, self.shape))

    @property
    def _grid(self) -> bool:
        return isinstance(self.file.design, Grid)

    @property
    def _sampled(self) -> int:
        assert not isinstance(self.file.design, Grid)
        return self.file.design.points


def shipped() -> dict[str, Path]:
    """The files of all shipped studies by name."""
    return {file.stem: file for file in sorted(FOLDER.glob("*.toml"))}


def find(name_or_path: str | Path) -> Path:
    """The file behind a shipped name or a path. Raises ValueError with the shipped names if there is none."""
    path = Path(name_or_path)
    rule = f"{path}: a store; study show reads it, and study run and plan take a study's file"
    require(path.suffix != ".zarr" or path.is_file(), rule)
    if path.suffix == ".toml" or path.parent != Path("."):
        require(path.exists(), f"{path}: no such file")
        require(path.is_file(), f"{path}: a folder, and no study's file")
        return path
    there = shipped()
    beside = [one for one in (path.with_suffix(".toml"), path.with_suffix(".zarr")) if one.exists() and one != path]
    likely = [*map(str, beside), *difflib.get_close_matches(path.name, there, 1)]
    meant = f"did you mean {' or '.join(likely)}? Shipped" if likely else "shipped"
    require(path.name in there or not path.is_dir(), f"{path}: a folder, and no study's file")
    require(path.name in there, f"{path}: no such study; {meant} are {', '.join(there)}")
    return there[path.name]


def load(name_or_path: str | Path) -> Study:
    """A shipped study by its name, or any study by the path of its file.

    Raises ValueError in one sentence that names file, field and rule.
    """
    path = find(name_or_path)
    file = study_file.read(path)
    try:
        bases = tuple(_base(name, path) for name in file.presets)
        return of_file(file, bases, tuple(Path(name).stem for name in file.presets))
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from None


def of_file(file: StudyFile, bases: tuple[Preset, ...], names: tuple[str, ...] | None = None) -> Study:
    """A study of presets that are values already. Raises ValueError if a parameter names nothing in one of them."""
    names = file.presets if names is None else names
    require(len(set(names)) == len(names), f"presets must have different names, got {', '.join(names)}")
    parameter_paths.refuse_unknown(file.parameters, bases)
    return Study(file=file, bases=bases, names=names)


def _base(name: str, path: Path) -> Preset:
    """A shipped preset, or one whose file is named from the folder of the study's file. Raises ValueError."""
    if name.endswith(".toml") or Path(name).parent != Path("."):
        try:
            return preset.load(path.parent / name)
        except ValueError as error:
            raise ValueError(f"presets: {error}") from None
    there = path.parent / f"{name}.toml"
    known = [file.stem for file in preset.shipped_files()]
    rule = f'presets: no shipped preset is named {name}; to use the file beside this one, write "{there.name}"'
    require(name in known or not there.is_file(), rule)
    require(name in known, f"presets: {file_errors.near(name, known)}")
    return preset.load(name)


def _with_path(of: Preset, name: str, factor: float) -> Preset:
    """The preset with its whole path run slower, or made larger. Raises ValueError."""
    try:
        if name == TIME_SCALE:
            return msgspec.structs.replace(of, path=signals.slowed(of.path, factor))
        assert name == SIZE
        require(factor > 0, "must be positive")
        places = of.path(np.linspace(0, of.duration, BOX_SAMPLES))
        x, y, z = ((places.max(axis=0) + places.min(axis=0)) / 2).tolist()
        return msgspec.structs.replace(of, path=signals.scaled(of.path, factor, about=(x, y, z)))
    except ValueError as error:
        raise ValueError(f"{name} = {factor:g}: {error}") from None


def _shares(file: StudyFile) -> Array:
    """Points in the unit cube, a row for each."""
    from scipy.stats import qmc  # takes 0.3 s to load, and a map needs none of it

    rng = np.random.default_rng(file.seed)
    dimensions = len(file.parameters)
    assert not isinstance(file.design, Grid)
    make: Any = qmc.Sobol if isinstance(file.design, Sobol) else qmc.LatinHypercube
    return make(dimensions, seed=rng).random(file.design.points)  # scipy calls it rng only from 1.15 on


def _plain(value: object) -> float | str:
    return value if isinstance(value, str) else float(value)  # pyright: ignore[reportArgumentType]
