"""A map of two parameters of the design on the page: its study, and what a cell of it means.

    settings, axes ──study_of──▶ Study ──rangenav.studies.maps──▶ StudyMap, from coarse to fine
    settings, values of a cell ──taken──▶ Settings
The first parameter lies across, the second one upwards.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import msgspec
import numpy as np

from explorer.model.settings import Settings, effective
from explorer.model.study_axes import COUNT, any_length
from rangenav import field_path
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.studies import study
from rangenav.studies.metrics import METRICS, ROWS
from rangenav.studies.parameters import SIZE, TIME_SCALE, Linear, Listed, Log
from rangenav.studies.study import Study
from rangenav.studies.study_file import StudyFile

FLYABLE = "flyable"
Cell = tuple[int, int]
"""Indices of the two parameters' values, from 0."""
Axis = Linear | Log


@dataclass(frozen=True)
class Ready:
    """A map that a button starts."""

    name: str
    question: str
    hint: str
    paths: tuple[str, str]
    metric: str
    count: int = COUNT
    """Points along each axis."""
    runs: int = 1
    """Seeds at each point: the scatter of one would hide what the gains do."""


READY = (
    Ready(
        "anchor",
        "Where may the anchor stand?",
        "Maps the predicted σ of the position over x and y of the anchor, at its present height.",
        ("world.anchor.x", "world.anchor.y"),
        "sigma_lifted",
    ),
    Ready(
        "size",
        "How large and how fast?",
        "Maps σ over the size of the path and its time scale; the menu of metrics also shows μ, and what can be flown.",
        (SIZE, TIME_SCALE),
        "sigma_lifted",
    ),
    Ready(
        "gains",
        "Which gains?",
        "Maps the steady error over q and k1; the menu of metrics also has settling times and the share that settles.",
        ("gains.riccati.q", "gains.attitude.k1"),
        "steady_position",
        count=17,
        runs=4,
    ),
)


MATCHED = (
    "the gains of this design are noise-matched: they follow from the noise, so the range weight q does nothing. "
    "Choose “constant” under Gains first, or map the range noise σ and k1 in axes of your own"
)


def refuse_idle(ready: Ready, preset: Preset) -> None:
    """Raise ValueError if a parameter of a ready map does nothing with the gains of a design."""
    require(not (ready.paths[0].startswith("gains.riccati.") and preset.gains.mode == "noise-matched"), MATCHED)


def metrics_with(metric: str) -> tuple[str, ...]:
    """All metrics that cost nothing more than one of them does, and whether the vehicle can fly the motion."""
    needed = METRICS[metric].needs
    if needed == "run":
        return tuple(row.name for row in ROWS if row.needs in ("motion", "run"))
    also = "analysis" if needed == "verdict" else needed  # a verdict has them on its way
    return tuple(row.name for row in ROWS if row.needs in ("motion", needed, also))


def design(settings: Settings, paths: tuple[str, ...]) -> Preset:
    """The preset that a map varies: the one that is computed, without the page's time scale if an axis has it."""
    return settings.preset if _own_time_scale(settings, paths) else effective(settings)


def study_of(settings: Settings, axes: tuple[Axis, Axis], metric: str, runs: int, *, file: str) -> Study:
    """The study of a map. `file` names the preset in the study's file. Raises ValueError."""
    base = design(settings, (axes[0].path, axes[1].path))
    chosen = StudyFile(
        title=f"{axes[0].path} × {axes[1].path}",
        presets=(file,),
        parameters=axes,
        runs=runs,
        seed=base.seed,
        common_seeds=True,
        metrics=metrics_with(metric),
    )
    return study.of_file(chosen, (base,))


def taken(settings: Settings, values: Mapping[str, float]) -> Settings:
    """The settings with the values of a cell: what they compute is the preset of that cell.

    Raises ValueError if the values do not fit.
    """
    paths = tuple(values)
    of_slider = values.get(TIME_SCALE) if _own_time_scale(settings, paths) else None
    listed = [
        Listed(path=path, values=(value,))
        for path, value in values.items()
        if not (path == TIME_SCALE and of_slider is not None)
    ]
    if of_slider is None and any(path in (SIZE, TIME_SCALE) or path.startswith("path.") for path in paths):
        base = effective(settings)
    else:
        base = settings.preset
    if listed:
        one = StudyFile(title="one cell", presets=("cell",), parameters=tuple(listed), metrics=("mu",))
        with any_length():
            base_of_cell = study.of_file(one, (base,)).preset_at(0)
    else:
        base_of_cell = base
    if of_slider is not None:
        return msgspec.structs.replace(settings, preset=base_of_cell, time_scale=of_slider)
    if base is settings.preset:
        return msgspec.structs.replace(settings, preset=base_of_cell)
    printed = msgspec.structs.replace(settings.printed, initial_values=False)  # the path has both by now
    return msgspec.structs.replace(settings, preset=base_of_cell, time_scale=1.0, printed=printed)


def values_at(of: Study, cell: Cell) -> dict[str, float]:
    """The values of both parameters at a cell, by their paths."""
    first, second = of.values.values()
    paths = (parameter.path for parameter in of.file.parameters)
    return dict(zip(paths, (float(first[cell[0]]), float(second[cell[1]])), strict=True))


def index_of(axis: Axis, value: float) -> float | None:
    """Where a value lies between those of an axis, as an index; None if it lies outside."""
    low, high = axis.low, axis.high
    if isinstance(axis, Log):
        if value <= 0:
            return None
        low, high, value = (float(np.log(one)) for one in (low, high, value))
    count = axis.count or 2
    index = (value - low) / (high - low) * (count - 1)
    tolerance = 1e-6 * count
    return min(max(index, 0.0), count - 1.0) if -tolerance <= index <= count - 1 + tolerance else None


class Place:
    """Where the design on the page lies on a map, and whether the map is of it at all.

    A map is of the design as long as nothing but its two parameters has changed. The size of a path is no number of a
    preset: the paths that cells of the map have led to are known, each with its values.
    """

    def __init__(self, settings: Settings, of: Study) -> None:
        self._settings = settings
        self.axes: tuple[Axis, Axis] = of.file.parameters[:2]  # pyright: ignore[reportAttributeAccessIssue]
        self._paths = (self.axes[0].path, self.axes[1].path)
        numbers = [path for path in self._paths if path not in (SIZE, TIME_SCALE)]
        self._first = {path: field_path.value(design(settings, self._paths), path) for path in numbers}
        self._known: dict[object, Mapping[str, float]] = {self._path(settings): self._first | {SIZE: 1.0}}
        self._key = self._without_axes(settings)

    def take(self, settings: Settings, values: Mapping[str, float]) -> Settings:
        """The settings on the page with the values of a cell. A size is a multiple of what the map began with.

        Raises ValueError if the values do not fit.
        """
        cell, now = taken(self._settings, values), settings.preset
        preset = msgspec.structs.replace(cell.preset, title=now.title, story=now.story, expect=now.expect)
        printed = msgspec.structs.replace(settings.printed, initial_values=cell.printed.initial_values)
        result = msgspec.structs.replace(settings, preset=preset, time_scale=cell.time_scale, printed=printed)
        if SIZE in values:
            self._known[self._path(result)] = values
        return result

    def values(self, settings: Settings) -> tuple[float, float] | None:
        """The values of both parameters on the page; None if the map is of another design."""
        try:
            if self._without_axes(settings) != self._key:
                return None
            first, second = (self._value(settings, path) for path in self._paths)
        except ValueError:  # a parameter that this design has not
            return None
        return None if first is None or second is None else (first, second)

    def _value(self, settings: Settings, path: str) -> float | None:
        if path == SIZE or (SIZE in self._paths and path.startswith("path.")):
            return self._known.get(self._path(settings), {}).get(path)
        if path == TIME_SCALE:
            return settings.time_scale if _own_time_scale(settings, self._paths) else 1.0
        return field_path.value(design(settings, self._paths), path)

    def _path(self, settings: Settings) -> object:
        return design(settings, self._paths).path

    def _without_axes(self, settings: Settings) -> Preset:
        """The design with the values that both parameters had first: only what else has changed makes a difference."""
        of = design(settings, self._paths)
        if SIZE in self._paths and of.path in self._known:
            of = msgspec.structs.replace(of, path=design(self._settings, self._paths).path)
        of = msgspec.structs.replace(of, title="map", story="", expect="observable")
        with any_length():
            return field_path.replaced(of, self._first) if self._first else of


def _own_time_scale(settings: Settings, paths: tuple[str, ...]) -> bool:
    """Whether the page's own time scale is the axis: it then moves with the cell that is taken."""
    return TIME_SCALE in paths and not settings.printed.initial_values
