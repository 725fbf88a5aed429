"""What can be put on an axis of a map: every number of a preset by its path in the file, and size and time scale.

candidates(preset)      each with its label and its unit
usual(preset, path)     the range that the page offers first
"""

import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import msgspec
import numpy as np

from explorer.model.glossary import TERMS, field_label
from explorer.model.settings import MAX_TIME_SCALE, MIN_TIME_SCALE
from rangenav import field_path
from rangenav.inputs import require_within
from rangenav.motion import DirectionWarning
from rangenav.preset import Preset
from rangenav.studies import units
from rangenav.studies.parameters import SIZE, TIME_SCALE, Linear, Log, Scale

MIN_COUNT, MAX_COUNT, COUNT = 2, 65, 25
"""Points along an axis: the least, the most, and how many are offered first. A map becomes finer by halves of 8 points,
so 25 and 65 have all four edges from the beginning."""
FIRST = (
    *(f"world.anchor.{axis}" for axis in field_path.COMPONENTS),
    SIZE,
    TIME_SCALE,
    "gains.riccati.q",
    "gains.attitude.k1",
)
"""What most maps are about stands first in the menu."""
OMITTED = ("version", "seed", "source", "requirement.mu", "requirement.position_sigma")
"""Keys that change no run, or that the results of a map are compared with."""
DERIVED_LABELS = {SIZE: "size of the path", TIME_SCALE: "time scale"}
OWN_LABELS = {
    "sensors.unmodelled.outlier_probability": "probability of outliers",
    "sensors.unmodelled.dropout_probability": "probability of drop-outs",
}
"""Labels of sliders in per cent, which do not say of what on an axis."""
TIMES = "×"
"""The unit of both: so many times as large as now, so many times slower."""
MAX_ENTRIES = 40
"""Numbers of one list; those of a longer one are a recorded path."""
FACTOR, AROUND, DIGITS = 4.0, 1.0, 3
"""Size, time scale and noise are varied by this factor; what may be zero by so much, at least; digits of the ends."""
WIDE = {"gains.riccati.": 100.0, "gains.attitude.": 16.0}
"""The factors of gains, which matter by their orders of magnitude."""
MAX_HALVINGS = 6
MARGIN, BOX_SAMPLES = 0.75, 200
"""The anchor is varied over the box of the path, with this share of its longer side around it."""


@dataclass(frozen=True)
class Candidate:
    """One parameter."""

    path: str
    """As a study's file names it."""
    label: str
    unit: str = ""

    @property
    def caption(self) -> str:
        """The label with its unit."""
        return f"{self.label} ({self.unit})" if self.unit else self.label


@lru_cache(maxsize=8)
def candidates(preset: Preset) -> tuple[Candidate, ...]:
    """Every number of a preset that a map can vary; what most maps are about first."""
    table = msgspec.json.decode(msgspec.json.encode(preset))
    rows = {path: key for path, key in _numbers(table, "", "") if not key.startswith(OMITTED)}
    of_file = {path: Candidate(path, _label(table, path, key), _unit(preset, path, key)) for path, key in rows.items()}
    known = of_file | {path: Candidate(path, label, TIMES) for path, label in DERIVED_LABELS.items()}
    first = [path for path in FIRST if path in known]
    return tuple(known[path] for path in [*first, *(path for path in known if path not in first)])


def candidate(preset: Preset, path: str) -> Candidate:
    """The parameter of a path. Raises ValueError if the preset has none."""
    for one in candidates(preset):
        if one.path == path:
            return one
    raise ValueError(f"{path}: the preset has no such number")


def parameter(path: str, low: float, high: float, count: int, scale: Scale) -> Linear | Log:
    """A parameter of a study's file. Raises ValueError if the range is none."""
    kind = Log if scale == "log" else Linear
    return kind(path=path, low=low, high=high, count=count)


def refuse_time_scale(name: str, path: str, value: float) -> None:
    """Raise ValueError, with the name of a box, if the page's own time scale does not reach a value."""
    if path == TIME_SCALE:
        require_within(name, value, MIN_TIME_SCALE, MAX_TIME_SCALE)


def usual(preset: Preset, path: str) -> Linear | Log:
    """The range that is offered first: around the present value, or around the path for the anchor.

    Raises ValueError if the preset has no number at the path.
    """
    if path in DERIVED_LABELS:
        return Log(path=path, low=1 / FACTOR, high=FACTOR, count=COUNT)
    value = field_path.value(preset, path)
    if path in ("world.anchor.x", "world.anchor.y", "world.anchor.z"):
        low, high = _around_path(preset, field_path.COMPONENTS[path[-1]])
        return Linear(path=path, low=_rounded(low), high=_rounded(high), count=COUNT)
    if value > 0 and path.startswith(("gains.", "sensors.")):
        wide = next((factor for begin, factor in WIDE.items() if path.startswith(begin)), FACTOR)
        low, high = (_allowed(preset, path, value, end, log=True) for end in (value / wide, value * wide))
        return Log(path=path, low=low, high=high, count=COUNT)
    about = max(abs(value) / 2, AROUND)
    ends = value / 2 if value > 0 else value - about, value + about
    low, high = (_allowed(preset, path, value, end, log=False) for end in ends)
    return Linear(path=path, low=low, high=high, count=COUNT)


def _allowed(preset: Preset, path: str, value: float, end: float, *, log: bool) -> float:
    """The end of a range; half the way to it, or a quarter, if the preset cannot have it."""
    for _ in range(MAX_HALVINGS):
        rounded = _rounded(end)
        try:
            with any_length():
                field_path.replaced(preset, {path: rounded})
        except ValueError:
            end = math.sqrt(value * end) if log else (value + end) / 2
        else:
            return rounded
    return _rounded(end)


@contextmanager
def any_length() -> Iterator[None]:
    """Within it nobody is warned of a direction that is no unit vector: a map varies its components."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DirectionWarning)
        yield


def _around_path(preset: Preset, axis: int) -> tuple[float, float]:
    places = preset.path(np.linspace(0.0, preset.duration, BOX_SAMPLES))
    low, high = places.min(axis=0), places.max(axis=0)
    margin = MARGIN * max(float((high - low).max()), AROUND)
    return float(low[axis]) - margin, float(high[axis]) + margin


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _numbers(entry: Any, path: str, key: str) -> Iterator[tuple[str, str]]:
    """The path and the key, with entries in brackets, of every number that need not be whole."""
    if isinstance(entry, float):
        yield path, key
    elif isinstance(entry, dict):
        for name, inner in entry.items():
            yield from _numbers(inner, f"{path}.{name}".lstrip("."), f"{key}.{name}".lstrip("."))
    elif isinstance(entry, list) and len(entry) <= MAX_ENTRIES:
        vector = len(entry) == len(field_path.COMPONENTS) and all(isinstance(one, float) for one in entry)
        for k, inner in enumerate(entry):
            part = tuple(field_path.COMPONENTS)[k] if vector else str(k + 1)
            yield from _numbers(inner, f"{path}.{part}", f"{key}.{part}" if vector else f"{key}[{part}]")


def _label(table: Any, path: str, key: str) -> str:
    """What the page calls the number; of a tone with its axis."""
    if path in OWN_LABELS:
        return OWN_LABELS[path]
    vector, _, axis = key.rpartition(".")
    if axis in field_path.COMPONENTS:
        return f"{field_label(vector)} {axis}"
    label, axis = field_label(key), _axis(table, path)
    begin, comma, last = label.rpartition(", ")
    word = "about" if path.startswith("angular_velocity") else "along"
    return f"{begin} {word} {axis}{comma}{last}" if axis else label


def _axis(table: Any, path: str) -> str:
    """The axis that the entry of a list acts on, such as that of a tone; empty for any other number."""
    *parts, _ = path.split(".")
    if not parts or not parts[-1].isdecimal():
        return ""
    for part in parts:
        table = table[int(part) - 1] if part.isdecimal() else table[part]
    return str(table.get("axis", "")) if isinstance(table, dict) else ""


def _unit(preset: Preset, path: str, key: str) -> str:
    """The SI unit: as the library documents it, or else as the page's table of terms does."""
    documented = units.of(Linear(path=path, low=0.0, high=1.0), preset)
    field = key.rpartition(".")[0] if key.rpartition(".")[2] in field_path.COMPONENTS else key
    known = next((term.unit for term in TERMS.values() if field in term.fields), "")
    return documented or ("" if known in ("%", "°") else known)
