"""What a visitor chooses for a map: its axes, its metric, and how many seeds each point has."""

import msgspec

from explorer.model import study_axes
from explorer.model.chosen_map import MAX_RUNS, ChosenMap
from explorer.model.glossary import STUDIES
from explorer.model.study_map import READY, Axis, Ready, refuse_idle
from explorer.panels.studies.axis_controls import AxisControls
from explorer.widgets.complaint import all_of
from explorer.widgets.controls import Choice, Number
from explorer.widgets.form import Action, Form
from explorer.widgets.html import NOTE, escaped
from explorer.widgets.section import Section
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.studies.metrics import ROWS

COMPUTE = "Compute the map"
COMPUTE_HINT = "Computes every point, coarse ones first. The page stays usable; nothing on it changes."
Options = tuple[tuple[Axis, Axis], str, int]
"""Axes, metric and seeds at each point."""


class MapChoice:
    """The section below the map."""

    def __init__(self, form: Form, first: Preset, start: Action) -> None:
        """first: a preset whose parameters are offered at first."""
        self.section = section = Section(form, "Axes and metric")
        metrics = {row.name: f"{row.title} ({row.unit})" if row.unit else row.title for row in ROWS}
        seeds = STUDIES["seeds per point"]
        with section:
            self.metric = Choice(section, STUDIES["metric"].caption, metrics, hint=STUDIES["metric"].hint)
            across, upwards = READY[0].paths
            self.axes = (
                AxisControls(section, "across", first, across),
                AxisControls(section, "upwards", first, upwards),
            )
            self._paths = form.gui.add_html("")
            self.runs = Number(section, seeds.caption, hint=seeds.hint)
            self.metric.write(READY[0].metric, None)
            self.runs.write(1.0, None)
            form.button(COMPUTE, start, hint=COMPUTE_HINT)
        section.check(self._checked)

    def read(self) -> Options:
        """What is chosen. Raises ReasonsError with the reason of each box that cannot be used."""
        first, second, metric, runs = all_of(self.axes[0].read, self.axes[1].read, self.metric.read, self._runs)
        require(first.path != second.path, "upwards must be another parameter than across")
        return (first, second), metric, runs

    def _runs(self) -> int:
        runs, label = self.runs.read(), STUDIES["seeds per point"].label
        whole = runs == int(runs) and 1 <= runs <= MAX_RUNS
        require(whole, f"{label} must be a whole number between 1 and {MAX_RUNS}, got {runs:g}")
        return int(runs)

    def restore(self, chosen: ChosenMap, design: Preset) -> None:
        """Choose what was chosen in an earlier visit; an axis that the design has not stays as it is."""
        self.offer(design)
        offered = {one.path for one in study_axes.candidates(design)}
        for controls, axis in zip(self.axes, (chosen.across, chosen.upwards), strict=True):
            if axis.path in offered:
                controls.write(axis)
        self.metric.write(chosen.metric, None)
        self.runs.write(float(chosen.runs), None)

    def write_ready(self, ready: Ready, design: Preset) -> None:
        """Choose a ready map of a design. Raises ValueError if the design has not its parameters."""
        refuse_idle(ready, design)
        for controls, path in zip(self.axes, ready.paths, strict=True):
            controls.write(msgspec.structs.replace(study_axes.usual(design, path), count=ready.count))
        self.metric.write(ready.metric, None)
        self.runs.write(float(ready.runs), None)

    def put_across(self, label: str, design: Preset) -> None:
        """Put the parameter whose label begins so on the axis across. Raises ValueError if there is none."""
        rows = study_axes.candidates(design)
        path = next((one.path for one in rows if label and one.label.startswith(label)), None)
        if path is None:
            raise ValueError(f"“{label}” is no number that a map can vary" if label else "no control was moved yet")
        self.axes[0].write(study_axes.usual(design, path))

    def offer(self, design: Preset) -> None:
        """Offer the parameters of a design."""
        for controls in self.axes:
            controls.offer(design)

    def _checked(self) -> None:
        """Offer the usual range of another parameter, and check everything. Raises ValueError with the reason."""
        for controls in self.axes:
            controls.refresh()
        (first, second), _, _ = self.read()
        keys = f"Keys of a study's file: → <code>{escaped(first.path)}</code>, ↑ <code>{escaped(second.path)}</code>"
        if NOTE.format(keys) != self._paths.content:
            self._paths.content = NOTE.format(keys)
