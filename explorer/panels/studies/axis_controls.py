"""One axis of a map: its parameter, the ends of its range, how many points it has and how they are spaced."""

import math
from functools import partial

from explorer.model import study_axes
from explorer.model.glossary import STUDIES
from explorer.model.study_axes import MAX_COUNT, MIN_COUNT
from explorer.model.study_map import Axis
from explorer.widgets.complaint import all_of
from explorer.widgets.controls import Choice, Number
from explorer.widgets.section import Section
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.studies.parameters import Scale, scale

SPACINGS: dict[Scale, str] = {"linear": "equal steps", "log": "equal factors"}


class AxisControls:
    """The controls of one axis; `name` is the term of the axis, which all labels end with."""

    def __init__(self, section: Section, name: str, preset: Preset, path: str) -> None:
        term, self.name, self._preset = STUDIES[name], name, preset
        self._labels = _labels(preset)
        self.parameter = Choice(section, term.caption, self._labels, hint=term.hint)
        self.low = Number(section, f"lowest {name}", hint=STUDIES["lowest"].hint)
        self.high = Number(section, f"highest {name}", hint=STUDIES["highest"].hint)
        self.count = Number(section, f"points {name}", hint=STUDIES["points"].hint)
        self.spacing = Choice(section, f"spacing {name}", SPACINGS, hint=STUDIES["spacing"].hint)
        self._written = path
        """The parameter that the ends of the range belong to."""
        self.write(study_axes.usual(preset, path))

    def read(self) -> Axis:
        """The parameter with its range. Raises ReasonsError: a sentence for each box that cannot be used, which begins
        with its label."""
        path, spacing, low, high, count = all_of(
            self.parameter.read, self.spacing.read, self.low.read, self.high.read, self._count
        )
        all_of(
            partial(self._check_ends, spacing, low, high),
            partial(study_axes.refuse_time_scale, self.low.name, path, low),
            partial(study_axes.refuse_time_scale, self.high.name, path, high),
        )
        return study_axes.parameter(path, low, high, count, spacing)

    def _count(self) -> int:
        count = self.count.read()
        whole = math.isfinite(count) and count == int(count) and MIN_COUNT <= count <= MAX_COUNT
        rule = f"{self.count.name} must be a whole number between {MIN_COUNT} and {MAX_COUNT}"
        require(whole, f"{rule}, got {count:g}")
        return int(count)

    def _check_ends(self, spacing: Scale, low: float, high: float) -> None:
        positive = spacing == "linear" or low > 0
        require(positive, f"{self.low.name} must be positive where points are spaced by equal factors, got {low:g}")
        require(low < high, f"{self.high.name} must be larger than {self.low.name}, got {high:g} and {low:g}")

    def write(self, axis: Axis) -> None:
        """Show a parameter with its range."""
        self._written = axis.path
        self.parameter.write(axis.path, None)
        self.low.write(axis.low, None)
        self.high.write(axis.high, None)
        self.count.write(float(axis.count or 0), None)
        self.spacing.write(scale(axis), None)

    def refresh(self) -> None:
        """Offer the usual range of a parameter that was chosen a moment ago. Raises ValueError."""
        path = self.parameter.read()
        if path != self._written:
            self.write(study_axes.usual(self._preset, path))

    def offer(self, preset: Preset) -> None:
        """Offer the parameters of a preset; one that it has not is replaced by the first."""
        self._preset = preset
        labels = _labels(preset)
        if labels != self._labels:
            self._labels = labels
            self.parameter.offer(labels)
            if self._written not in labels:
                self.write(study_axes.usual(preset, next(iter(labels))))


def _labels(preset: Preset) -> dict[str, str]:
    """The captions of all parameters by their paths. Each ends with its path: the menu finds it by that, too."""
    return {one.path: f"{one.caption}: {one.path}" for one in study_axes.candidates(preset)}
