"""A plot as a file: a table (CSV) of all samples, or a picture (SVG, PNG, PDF) with the page's axes and
colours.

A file holds every sample. A cell of the table is empty where there is no value: after a curve has ended, or below the
rounding floor. It is "inf" where a window is blind. No viser here.
"""

import csv
import io
import math
import threading
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

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


def picture(panels: Sequence[Panel], kind: PictureFormat) -> bytes:
    """One plot, or two side by side."""
    from matplotlib import rc_context  # takes half a second, so only when a picture is wanted
    from matplotlib.figure import Figure

    buffer, alone = io.BytesIO(), len(panels) == 1
    with _MATPLOTLIB, rc_context(RC_SETTINGS):
        figure = Figure(figsize=SIZE if alone else SIZE_OF_TWO, layout="constrained")
        for k, panel in enumerate(panels):
            axes = figure.add_subplot(1, len(panels), k + 1)
            for i in panel.columns:
                _draw(axes, panel.plot.curves[i], panel.drawing, i)
            _frame(axes, panel.plot, panel.drawing.axis, panel.duration)
            if not alone:
                axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3, frameon=False)
        if alone:
            figure.legend(loc="outside upper right", ncols=4, frameon=False)
        figure.savefig(buffer, format=kind, dpi=DOTS, metadata=METADATA[kind])
    return buffer.getvalue()


def _draw(axes: "Axes", curve: Curve, drawing: Drawing, column: int) -> None:
    time, values, (bottom, top) = drawing.time, drawing.drawn[:, column], drawing.axis
    dashes = (0, curve.dash) if curve.dash else "solid"
    label = curve.label or f"_{curve.name}"  # matplotlib keeps labels that begin with _ out of the legend
    if not np.any((values >= bottom) & (values <= top)):
        label += " (blind)" if np.any(np.isposinf(drawing.values[:, column])) else " (outside)"
    axes.plot(time, values, label=label, color=curve.color, linewidth=curve.width, linestyle=dashes)
    if curve.filled:
        axes.fill_between(time, values, bottom, color=curve.color, alpha=FILL_OPACITY, linewidth=0)


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
    axes.set_ylabel(_joined(unit, LOGARITHMIC) if plot.log else unit)


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
