"""The file of a study: base presets, parameters, design, seeds, estimators, metrics and a stopping rule, as TOML.

Errors name file, field and rule: `anchor.toml: parameters.2: low must lie below high, got 3 and -3`.
"""

from pathlib import Path
from typing import Literal, get_args

import msgspec
import numpy as np

from rangenav import preset, toml_limits
from rangenav.inputs import Input, require, require_within
from rangenav.studies import file_errors
from rangenav.studies.estimators import ESTIMATORS
from rangenav.studies.metrics import METRICS
from rangenav.studies.parameters import Choices, Listed, Parameter
from rangenav.studies.stopping import Stop

FORMAT_VERSION = 1
MAX_POINTS = 10_000_000
MAX_RUNS = 10_000
"""Most runs of one point: one task computes all of them."""
MAX_SEED = 2**53
WINDOWS = 101
"""Windows that are judged if the file says nothing."""
RESERVED = ("point", "run", "estimator", "preset", "runs", "reason", "receipts")
"""Names in the store that no parameter may have."""


class Grid(Input, frozen=True, kw_only=True, tag="grid", tag_field="kind"):
    """Every combination of the parameters' values."""


class Sobol(Input, frozen=True, kw_only=True, tag="sobol", tag_field="kind"):
    """A scrambled Sobol sequence (scipy.stats.qmc)."""

    points: int
    """A power of two, for which the sequence is balanced."""

    def __post_init__(self) -> None:
        super().__post_init__()
        _refuse_points(self.points)
        require(self.points & (self.points - 1) == 0, f"points must be a power of two, got {self.points}")


class LatinHypercube(Input, frozen=True, kw_only=True, tag="latin-hypercube", tag_field="kind"):
    """A Latin hypercube (scipy.stats.qmc): the range of each parameter has as many parts as there are points, and each
    part has one point."""

    points: int

    def __post_init__(self) -> None:
        super().__post_init__()
        _refuse_points(self.points)


Design = Grid | Sobol | LatinHypercube


class StudyFile(Input, frozen=True, kw_only=True):
    """Everything that a person chooses for a study."""

    version: Literal[1] = FORMAT_VERSION
    title: str
    presets: tuple[str, ...]
    """Names of shipped presets, or paths of TOML files, taken from the folder of the study's file. Several become a
    dimension."""
    parameters: tuple[Parameter, ...] = ()
    design: Design = Grid()
    runs: int = 1
    """Seeds at each point; with a stopping rule, the most. Not used if no metric is of a run."""
    seed: int = 0
    """The seeds of all runs, and the sample of the points, follow from it."""
    common_seeds: bool = False
    """The runs of every point have the same seeds: neighbouring points share one sampling error, and differ by their
    parameters alone."""
    estimators: tuple[str, ...] = ("cascade",)
    metrics: tuple[str, ...]
    windows: int = WINDOWS
    """So many windows, evenly spaced over the flight; the metrics of observability are those of the worst of them."""
    every_window: bool = False
    """The metrics of observability are those of the worst of all windows, as `analyze` has them."""
    stop: Stop | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        preset.refuse_title(self.title)
        require(len(self.presets) > 0, "presets must name one preset or more")
        require_within("runs", self.runs, 1, MAX_RUNS)
        require(0 <= self.seed < MAX_SEED, f"seed must lie between 0 and 2^53, got {self.seed}")
        require_within("windows", self.windows, 2, 2001)
        for field, names, table in (("metrics", self.metrics, METRICS), ("estimators", self.estimators, ESTIMATORS)):
            require(len(names) > 0, f"{field} must name one or more of {', '.join(table)}")
            require(len(set(names)) == len(names), f"{field} must not name one twice")
            for name in names:
                require(name in table, f"{field}: {file_errors.near(name, table)}")
        self._refuse_places()
        self._refuse_names()
        self._refuse_counts()
        if self.stop is not None:
            known = METRICS.get(self.stop.metric)
            rule = f"stop.metric: {self.stop.metric} is no metric of a run"
            require(known is not None and known.needs == "run", rule)
            rule = f"stop.metric: {self.stop.metric} must be one of the study's metrics, too"
            require(self.stop.metric in self.run_metrics, rule)
            require(
                self.stop.least <= self.runs, f"stop.least must not exceed runs ({self.runs}), got {self.stop.least}"
            )

    def _refuse_places(self) -> None:
        """Two parameters of one number: the point would have the value of one, and the table that of the other."""
        places = [parameter.place for parameter in self.parameters]
        for k, (place, parameter) in enumerate(zip(places, self.parameters, strict=True)):
            if place in places[:k]:
                first = places.index(place)
                other = self.parameters[first].path
                spelled = "" if other == parameter.path else f", as {other}"
                rule = f"parameters.{k + 1}: path {parameter.path} is varied by parameters.{first + 1} already{spelled}"
                raise ValueError(f"{rule}; give the values of both to one of them")

    def _refuse_names(self) -> None:
        names = [parameter.dimension for parameter in self.parameters]
        for k, name in enumerate(names):
            require(name not in names[:k], f"parameters.{k + 1}: the name {name} is taken; `name` gives another")
            taken = name in RESERVED or name in METRICS
            require(not taken, f"parameters.{k + 1}: name must not be {name}, which the store uses")

    def _refuse_counts(self) -> None:
        """A grid needs the number of values of each parameter, and a sample must not have it."""
        grid = isinstance(self.design, Grid)
        require(grid or len(self.parameters) > 0, "a sample needs one parameter or more")
        for k, parameter in enumerate(self.parameters):
            if isinstance(parameter, Listed | Choices):
                continue
            missing, kind = parameter.count is None, type(self.design).__struct_config__.tag
            require(not (grid and missing), f"parameters.{k + 1}: count is missing; a grid needs it")
            require(grid or missing, f"parameters.{k + 1}: count is for a grid; the design {kind} states points")
        require_within("the number of points", self.count, 1, MAX_POINTS)

    @property
    def unused(self) -> tuple[str, ...]:
        """Keys that say something here and decide nothing, with the reason, for a person."""
        needs = {METRICS[name].needs for name in self.metrics}
        without = "no metric is of a run"
        said = {
            "runs": (self.runs != 1 and "run" not in needs, without),
            "common_seeds": (self.common_seeds and "run" not in needs, without),
            "estimators": (self.estimators != ("cascade",) and "run" not in needs, without),
            "windows": (self.windows != WINDOWS and self.every_window, "every_window judges all of them"),
            "every_window": (self.every_window and "analysis" not in needs, "no metric is of windows"),
        }
        return tuple(f"{key}: {why}" for key, (idle, why) in said.items() if idle)

    @property
    def run_metrics(self) -> tuple[str, ...]:
        """Metrics that each run has."""
        return tuple(name for name in self.metrics if METRICS[name].needs == "run")

    @property
    def point_metrics(self) -> tuple[str, ...]:
        """Metrics that each point has once."""
        return tuple(name for name in self.metrics if METRICS[name].needs != "run")

    @property
    def windows_judged(self) -> str:
        """Which windows the metrics of observability come from, for a person."""
        return (
            "worst of all windows"
            if self.every_window
            else f"worst of some windows (sampled; μ and ranks: {self.windows})"
        )

    @property
    def most_runs(self) -> int:
        """Seeds at each point at most: 0 if no metric is of a run."""
        return self.runs if self.run_metrics else 0

    @property
    def count(self) -> int:
        """How many points there are."""
        sizes = [parameter.size or 0 for parameter in self.parameters]
        each = int(np.prod(sizes, dtype=object)) if isinstance(self.design, Grid) else self.design.points
        return each * len(self.presets)


FIELDS = {
    "": {"": StudyFile.__struct_fields__},
    "stop": {"": Stop.__struct_fields__},
    "design": {kind.__struct_config__.tag: kind.__struct_fields__ for kind in get_args(Design)},
    "parameters": {kind.__struct_config__.tag: kind.__struct_fields__ for kind in get_args(Parameter)},
}
"""The fields of each table of a file, by the name of the table, and by its kind."""


def loads(text: str, *, source: str) -> StudyFile:
    """A study's file from TOML text; errors start with `source`. Raises ValueError."""
    try:
        return toml_limits.decode(text, StudyFile)
    except ValueError as error:
        rule = f'{source}: a preset, and no study; a study names it: presets = ["{source}"]'
        require(not _is_preset(text), rule)
        raise ValueError(f"{source}: {file_errors.explained(str(error), text, FIELDS)}") from None


def _is_preset(text: str) -> bool:
    """Whether a text that is no study is a preset."""
    try:
        table = toml_limits.decode(text, dict)
    except ValueError:
        return False
    return "path" in table and "presets" not in table


def dumps(file: StudyFile) -> str:
    """TOML text that `loads` turns into an equal value."""
    table = msgspec.to_builtins(file)
    if file.stop is None:
        del table["stop"]
    if not file.every_window:  # the first files did not have it
        del table["every_window"]
    for parameter in table["parameters"]:
        for name in [name for name, entry in parameter.items() if entry is None or entry == ""]:
            del parameter[name]
    return msgspec.toml.encode(table).decode()


def read(path: Path) -> StudyFile:
    """The file of a study. Raises ValueError with one sentence."""
    try:
        content = path.read_bytes()
        require(len(content) <= toml_limits.MAX_BYTES, f"{path.name}: larger than {toml_limits.MAX_BYTES} bytes")
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path.name}: not UTF-8 text (byte {error.start})") from None
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror}") from None
    return loads(text, source=path.name)


def _refuse_points(points: int) -> None:
    require_within("points", points, 1, MAX_POINTS)
