"""A plot as a file: a table (CSV) of all samples, or a picture (SVG, PNG, PDF) with the page's axes and
colours.

A file holds every sample. A cell of the table is empty where there is no value: after a curve has ended, or below the
rounding floor. It is "inf" where a window is blind. No viser here.
"""

import csv
import io
import itertools
import math
import textwrap
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy import ndarray as Array

from explorer.charts import curves
from explorer.charts.plots import Curve, Drawing, Plot
from explorer.model import palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PictureFormat = Literal["svg", "png", "pdf"]
PlotFormat = Literal["csv", "svg", "png", "pdf"]
MAX_CELLS = 5_000_000
"""About 100 MB of text; a larger download would block a browser."""
SIZE, SIZE_OF_TWO, DOTS = (7.2, 3.6), (11.0, 3.9), 200
"""Width and height in inches: of one plot, as wide as a column of text, and of two side by side; and dots per inch."""
METADATA: dict[PictureFormat, dict[str, None]] = {"svg": {"Date": None}, "png": {}, "pdf": {"CreationDate": None}}
"""Equal plots are equal bytes: no picture holds its date."""
FILL_OPACITY = int(palette.FILL, 16) / 255
"""Opacity of the area below a filled curve, as on the page."""
LOGARITHMIC = "log axis"
PINNED = "A"
"""What the labels of the pinned run's curves begin with."""
LINE_HEIGHT, COLUMNS, CELL, SENTENCE = 0.19, (0.012, 0.19, 0.6), 62, 165
"""Of the words above two plots: inches of a line, the left ends of its columns by the picture's width, and the most
characters of a cell and of a line of the sentence."""
RC_SETTINGS: dict[Any, Any] = {
    "svg.hashsalt": "rangenav",
    "lines.scale_dashes": False,
    "agg.path.chunksize": 20_000,
    "font.size": 9.0,
}
"""matplotlib's settings. The salt makes equal plots equal bytes. Dashes are lengths in points, not multiples of a
line's width, as on the page. Long curves are drawn in chunks: one of millions of samples would be an error."""
_MATPLOTLIB = threading.Lock()
"""One picture at a time: matplotlib's settings and fonts are shared by all threads."""
Columns = tuple[int, ...]


class Summary(NamedTuple):
    """What a picture of two plots says in words: a head above each plot, rows of figures, and a sentence."""

    heads: tuple[str, str]
    rows: Sequence[tuple[str, str, str]]
    """Name, figure of the first, figure of the second."""
    sentence: str


class Panel(NamedTuple):
    """One plot of a picture: its numbers, the columns that are drawn, and the length of its time axis (s)."""

    plot: Plot
    drawing: Drawing
    columns: Columns
    duration: float


def require_writable(plot: Plot, drawing: Drawing, columns: Columns) -> None:
    """Raise ValueError with one sentence if no curve is shown or the file would be too large."""
    if not columns or not len(drawing.time):
        raise ValueError(f"{plot.title}: no curve of it is shown, so there is nothing to write")
    cells = len(drawing.time) * (1 + len(columns))
    if cells > MAX_CELLS:
        raise ValueError(f"{plot.title}: a file of it would hold {cells} numbers, and may hold {MAX_CELLS}")


def table(plot: Plot, drawing: Drawing, columns: Columns, duration: float) -> bytes:
    """CSV in UTF-8: one line of names with their units, then every sample to the last digit. The names say which values
    the page shows on a logarithmic axis."""
    buffer = io.StringIO()
    axis = LOGARITHMIC if plot.log else ""
    names = (_named(_name(plot.curves[i]), _joined(_unit(plot, plot.curves[i]), axis)) for i in columns)
    csv.writer(buffer, lineterminator="\n").writerow([_named(plot.x_name, "s"), *names])
    values = np.column_stack([drawing.time, drawing.values[:, columns]])
    buffer.writelines(",".join(map(_cell, row)) + "\n" for row in values.tolist())
    return buffer.getvalue().encode()


def svg(plot: Plot, drawing: Drawing, columns: Columns, duration: float) -> bytes:
    """A vector picture."""
    return picture((Panel(plot, drawing, columns, duration),), "svg")


def png(plot: Plot, drawing: Drawing, columns: Columns, duration: float) -> bytes:
    """A picture in pixels."""
    return picture((Panel(plot, drawing, columns, duration),), "png")


def pdf(plot: Plot, drawing: Drawing, columns: Columns, duration: float) -> bytes:
    """A vector picture for LaTeX."""
    return picture((Panel(plot, drawing, columns, duration),), "pdf")


WRITERS: dict[PlotFormat, Callable[[Plot, Drawing, Columns, float], bytes]] = {
    "csv": table,
    "svg": svg,
    "png": png,
    "pdf": pdf,
}


@contextmanager
def drawing_settings() -> Iterator[None]:
    """The settings of every picture that matplotlib draws, for one picture at a time."""
    from matplotlib import rc_context

    with _MATPLOTLIB, rc_context(RC_SETTINGS):
        yield


def picture(panels: Sequence[Panel], kind: PictureFormat, summary: Summary | None = None) -> bytes:
    """One plot, or two side by side below a summary in words."""
    from matplotlib.figure import Figure  # takes half a second, so only when a picture is wanted

    buffer, alone = io.BytesIO(), len(panels) == 1
    lines = [] if summary is None else _lines(summary)
    width, plot_height = SIZE if alone else SIZE_OF_TWO
    above = LINE_HEIGHT * (len(lines) + 1) if lines else 0.0
    with drawing_settings():
        figure = Figure(figsize=(width, plot_height + above), layout="constrained")
        for k, panel in enumerate(panels):
            axes = figure.add_subplot(1, len(panels), k + 1)
            _draw_panel(axes, panel)
            if not alone:
                axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3, frameon=False)
        if alone:
            figure.legend(loc="outside upper right", ncols=4, frameon=False)
        if lines:
            engine = figure.get_layout_engine()
            assert engine is not None
            share = above / (plot_height + above)
            engine.set(rect=(0.0, 0.0, 1.0, 1.0 - share))  # pyright: ignore[reportCallIssue]
            for k, line in enumerate(lines):
                y = 1.0 - share * (k + 1) / (len(lines) + 1)
                for x, text in zip(COLUMNS, line, strict=False):
                    weight = "bold" if k == 0 else "normal"
                    figure.text(x, y, text, va="center", fontweight=weight).set_in_layout(False)
        figure.savefig(buffer, format=kind, dpi=DOTS, metadata=METADATA[kind])
    return buffer.getvalue()


def _lines(summary: Summary) -> list[tuple[str, ...]]:
    """The summary in lines of up to three texts, each of which has room in its column."""
    lines: list[tuple[str, ...]] = []
    for row in (("", *summary.heads), *summary.rows):
        wrapped = [textwrap.wrap(text, CELL) for text in row]
        lines += itertools.zip_longest(*wrapped, fillvalue="")
    return [*lines, *((line,) for line in textwrap.wrap(summary.sentence, SENTENCE))]


def _draw_panel(axes: "Axes", panel: Panel) -> None:
    """One plot. Curves of which nothing can be seen share one entry of the legend, with the reason."""
    plot, drawing = panel.plot, panel.drawing
    missing: dict[str, list[str]] = {}
    for i in panel.columns:
        reason = _draw(axes, plot.curves[i], drawing, i)
        if reason and plot.curves[i].label:
            missing.setdefault(reason, []).append(plot.curves[i].label)
    for reason, labels in missing.items():
        axes.plot([], [], linestyle="none", label=f"{', '.join(labels)}: {reason}")
    empty = plot.reason_if_empty(drawing)
    if empty:
        axes.text(0.5, 0.6, empty, transform=axes.transAxes, ha="center", va="center")
    _frame(axes, plot, drawing.axis, panel.duration)


def _draw(axes: "Axes", curve: Curve, drawing: Drawing, column: int) -> str:
    """Draw a curve. Returns why nothing of it can be seen; empty if it can."""
    time, values, (bottom, top) = drawing.time, drawing.drawn[:, column], drawing.axis
    dashes = (0, curve.dash) if curve.dash else "solid"
    reason = "" if np.any((values >= bottom) & (values <= top)) else _why_unseen(drawing.values[:, column])
    label = _in_legend(curve.label) if curve.label and not reason else f"_{curve.name}"  # with _ it is in no legend
    axes.plot(time, values, label=label, color=curve.color, linewidth=curve.width, linestyle=dashes)
    if curve.filled:
        axes.fill_between(time, values, bottom, color=curve.color, alpha=FILL_OPACITY, linewidth=0)
    return reason


def _in_legend(label: str) -> str:
    """A label for who has the file alone: the page says what A is, and the file must."""
    return f"{label} (pinned run)" if label.split()[0] == PINNED else label


def _why_unseen(values: Array) -> str:
    """Why nothing of a curve lies inside the axes."""
    if np.any(np.isposinf(values)):
        return "blind"
    return "zero" if np.all((values == 0) | np.isneginf(values)) else "outside the axes"


def _frame(axes: "Axes", plot: Plot, axis: curves.Range, duration: float) -> None:
    """The page's axes, with names and units."""
    if plot.log:
        axes.set_yscale("log")
    places, labels = curves.decade_ticks(axis) if plot.log else curves.even_ticks(axis)
    axes.set_yticks(places, labels)
    axes.set_yticks([], minor=True)
    axes.set_xlim(0.0, duration)
    axes.set_ylim(*axis)
    axes.grid(color=palette.PLOT_GRID, linewidth=0.6)
    axes.set_title(plot.title, loc="left", fontsize="medium", fontweight="bold")
    axes.set_xlabel(_named(plot.x_name, "s"))
    unit = plot.unit.partition(f", by {plot.x_name}")[0]
    axes.set_ylabel(_named(unit, LOGARITHMIC) if plot.log else unit)


def _name(curve: Curve) -> str:
    return curve.name or curve.label


def _unit(plot: Plot, curve: Curve) -> str:
    return plot.unit.partition(",")[0] if curve.unit is None else curve.unit


def _named(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name


def _joined(*parts: str) -> str:
    return "; ".join(part for part in parts if part)


def _cell(value: float) -> str:
    return "" if math.isnan(value) or value == -math.inf else repr(value)
