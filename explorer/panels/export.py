"""The Export tab: any plot as CSV, SVG, PNG or PDF, and the lines of Python that compute the same in a notebook."""

import html
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import PurePath
from typing import Literal

from explorer.model.compute import Picture
from explorer.model.settings import PRINTED_LABELS, Settings
from explorer.storage import preset_file
from explorer.widgets.form import Action, Form
from explorer.widgets.progress import ProgressPanel
from explorer.widgets.section import Section

PlotFormat = Literal["csv", "svg", "png", "pdf"]
FORMATS: tuple[PlotFormat, ...] = ("csv", "svg", "png", "pdf")
PLOT_HINT = "Curves that were switched off by a click on their entry in the legend are left out."
FILE_HINT = (
    "CSV: every sample to the last digit, with units and “log axis” in its first line; empty where there is no value "
    "or only rounding noise, inf where a window is blind. SVG, PNG and PDF: the plot as it is on the page."
)
FLY = "ramps (s)"
"""The label of a control beside the formats of motions."""
FLY_HINT = "Goes to the Presets tab, “Download with certificate”: the motion for a vehicle, with its certificate."
LINES_HINT = "The Python code computes what is on the page from the preset file; both belong in one folder."
NOT_IN_LINES = ("reduced_row", "attitude_rate")
"""Switches “as printed” that change only a number next to their control, and no run or plot."""
PRINTED = (
    'print(f"{result.verdict.word}: rank {result.rank} of 13, μ {result.mu:.4g} m²/s⁷, δ {p.requirement.window:g} s")',
    'print(f"position: settled after (s) {flight.summary.settle_position_s}, '
    'steady error {flight.summary.steady_position:.3g} m (RMS of the last quarter)")',
)
"""The last lines: the key figures."""
STYLE = "font-size:0.8em;line-height:1.45;padding:0 0.9em 0.6em"


@dataclass(frozen=True, kw_only=True)
class ExportActions:
    """What only the session can do."""

    plan_plot: Callable[[str, PlotFormat], Callable[[], bytes]]
    """From a plot as it is now to a function that makes its file in any thread. Raises ValueError with one sentence."""
    settings: Callable[[], tuple[str, Settings]]
    """The name of the preset's file, and the settings."""
    download: Callable[[str, bytes], None]
    """Downloads a file."""
    go_to: Callable[[str], None]
    """Brings the control with a label into sight."""


class ExportPanel:
    """A menu of plots with buttons for the formats, and the lines of Python."""

    def __init__(self, form: Form, titles: dict[str, str], actions: ExportActions) -> None:
        """`titles` of the plots by their names."""
        self._actions, self._jobs = actions, form.new_jobs()
        self._written: Settings | None = None
        """The settings of the lines that are shown."""
        self._plot_names = {title: name for name, title in titles.items()}
        self._plots = Section(form, "A plot as a file")
        with self._plots:
            self._menu = form.gui.add_dropdown("plot", tuple(self._plot_names), hint=PLOT_HINT)
            plot_formats: dict[str, PlotFormat] = {"CSV": "csv", "SVG": "svg", "PNG": "png", "PDF": "pdf"}
            form.buttons(
                "file type",
                {label: partial(self._write_plot, plot_format) for label, plot_format in plot_formats.items()},
                hint=FILE_HINT,
            )
            self._progress = ProgressPanel(form, self._jobs)
        with Section(form, "The motion as a file to fly"):
            form.button("Show the certified files", partial(actions.go_to, FLY), hint=FLY_HINT)
        with Section(form, "The same in Python"):
            form.buttons("", {"Download Python": self._lines, "Download preset": self._preset}, hint=LINES_HINT)
            self._lines_block = form.gui.add_html("")
        form.command("Lines of Python for what is on the page", self._lines)

    @property
    def actions(self) -> dict[str, Action]:
        """What the buttons of a plot's large view and of two runs side by side do, by the names that they send."""
        names = [name for plot in self._plot_names.values() for name in (plot, f"{plot}-beside")]
        return {f"save-{name}-{kind}": partial(self._write, name, kind) for name in names for kind in FORMATS}

    def _write_plot(self, plot_format: PlotFormat) -> None:
        self._write(self._plot_names.get(self._menu.value, ""), plot_format)

    def _write(self, plot: str, plot_format: PlotFormat) -> None:
        """Write a file in a job: a picture takes half a second, a long table longer."""
        with self._plots.catching():
            if self._jobs.running is not None:
                raise ValueError("the file before is still being written; one at a time")
            write = self._actions.plan_plot(plot, plot_format)
        stem = PurePath(self._actions.settings()[0]).stem
        download = partial(self._actions.download, f"{stem}-{plot}.{plot_format}")
        self._progress.start(
            f"{plot}.{plot_format}", lambda _progress, _cancelled: write(), download, self._plots.complaint.say
        )

    def _lines(self) -> None:
        file, settings = self._actions.settings()
        lines = python_lines(settings, file)
        omitted = [PRINTED_LABELS[name] for name in NOT_IN_LINES if getattr(settings.printed, name)]
        note = f" The switches not in these lines: {', '.join(omitted)}." if omitted else ""
        code = f'<pre style="overflow-x:auto;user-select:all">{html.escape(lines)}</pre>'
        text = f"Run these lines in the folder that holds the preset file <b>{html.escape(file)}</b>.{note}"
        self._lines_block.content = f'<div style="{STYLE}">{code}{text}</div>'
        self._written = settings
        self._actions.download(f"{PurePath(file).stem}.py", lines.encode())

    def draw(self, picture: Picture) -> None:
        """Drop the lines when they compute what is not on the page any more."""
        if self._written is not None and picture.settings != self._written:
            self.forget_preset()

    def forget_preset(self) -> None:
        """Drop the lines: they compute a preset that is not on the page any more."""
        self._lines_block.content, self._written = "", None

    def _preset(self) -> None:
        file, settings = self._actions.settings()
        self._actions.download(file, preset_file.document(settings))


def python_lines(settings: Settings, file: str) -> str:
    """A few lines that compute what is on the page from its preset's file, and print its key figures.

    The file holds the time scale and the printed start already; the other printed switches that change a run or a plot
    are arguments here.
    """
    printed = settings.printed
    lines = [
        "from rangenav import analysis, observability, preset, record",
        f"p = preset.load({json.dumps(file, ensure_ascii=False)})",
        "flight = record.run(p" + (', form="printed")' if printed.model else ")"),
        "result = analysis.analyse(p)",
    ]
    if printed.excitation or printed.body_axes:
        switches = f"printed_formula={printed.excitation}, body_axes={printed.body_axes}"
        moved, windows = "flight.truth.motion", "result.windows.start, result.windows.window"
        lines += [
            f"signal = observability.excitation.chosen_signal({moved}, {switches})",
            f"printed = observability.excitation.sampled_eigenvalues(signal, {moved}.time, {windows})",
        ]
    else:
        lines[0] = "from rangenav import analysis, preset, record"
    return "\n".join([*lines, *PRINTED]) + "\n"
