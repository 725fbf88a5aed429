"""One plot on the page: created once, then assigned; its axes and curves as uPlot wants them described."""

from dataclasses import dataclass, field

import numpy as np
from viser import ClientHandle, GuiHtmlHandle, GuiUplotHandle, uplot

from explorer.charts import comparison_curves, cursor_values, curves, markup
from explorer.charts.comparison_curves import Pinned
from explorer.charts.plots import Curve, Drawing, Plot
from explorer.model import palette
from explorer.model.comparison import Comparison
from explorer.model.compute import Picture

OPAQUE = len("#rrggbb")
"""Characters of a colour before its opacity."""


@dataclass(eq=False)
class Chart:
    """One plot on the page, and what it shows."""

    base: Plot
    height: int
    header: GuiHtmlHandle
    handle: GuiUplotHandle
    plot: Plot
    """The base with the curves of what stands beside the picture, if anything does."""
    off: set[int] = field(default_factory=set)
    """Named columns that the visitor has switched off."""
    drawing: Drawing | None = None
    pinned: Pinned | None = None
    duration: float = 0.0
    """s, that the time axis spans."""
    looks: tuple[object, ...] = ()
    """What the axes and visible curves were made for: changing those rebuilds the chart in the browser."""
    bands: tuple[tuple[int, int], ...] = ()
    stale: bool = True
    """Whether it shows an earlier picture, or none."""

    def draw(self, picture: Picture, beside: Comparison) -> None:
        """Assign the curves; the axes and the legend only when they differ."""
        self.stale = False
        self.pinned = comparison_curves.pinned(self.base, beside.pinned, self.pinned)
        plot, drawing = comparison_curves.over(self.base, picture, beside, self.pinned)
        if plot.curves != self.plot.curves:  # what stood beside has come or gone, and others have its places
            self.off.difference_update(range(len(self.base.curves), len(self.plot.curves)))
        self.plot, self.drawing = plot, drawing
        self.duration = float(picture.motion.time[-1])
        time, values = curves.decimate(drawing.time, drawing.drawn)
        data = (time, *np.ascontiguousarray(values.T))
        if len(data) > len(self.handle.series):  # a chart must never have more curves than data
            self.handle.data = data
        self._dress(drawing)
        self.handle.data = data

    def toggle(self, column: int) -> None:
        """Show or hide a curve of the legend, and those that go with it."""
        self.off ^= {column}
        if self.drawing is not None:
            self._dress(self.drawing)

    def unseen(self, drawing: Drawing) -> tuple[int, ...]:
        """Columns that are not drawn: there is nothing to show, or the visitor has switched them off."""
        return (*drawing.hidden, *(i for column in sorted(self.off) for i in self.plot.together(column)))

    def _dress(self, drawing: Drawing) -> None:
        """Assign axes and legend, and which curves there are, if they are not as they were."""
        off = frozenset(self.off)
        looks = (drawing.axis, drawing.hidden, self.duration, off, self.plot.curves)
        if looks != self.looks:
            self.looks = looks
            if self.plot.bands != self.bands:
                self.bands, self.handle.bands = self.plot.bands, tinted(self.plot)
            self.handle.series = series(self.plot.curves, self.unseen(drawing))
            self.handle.scales = scales(self.plot, drawing.axis, self.duration)
            self.handle.axes = axes(self.plot, drawing.axis)
            self.header.content = markup.header(self.plot, height=self.height, hidden=drawing.hidden, off=off)

    def values(self, time: float) -> list[tuple[str, str]]:
        """The text of each curve in the legend at a time; a window counts until the next one starts."""
        if self.drawing is None:
            return []
        row = cursor_values.row_at(self.drawing, time)
        unseen = self.unseen(self.drawing)
        return [(markup.variable(self.plot, i), cursor_values.said(row[i])) for i in self.plot.named if i not in unseen]


def add_chart(client: ClientHandle, plot: Plot, height: int, off: set[int]) -> Chart:
    """An empty plot under its header; the first draw gives it numbers."""
    axis = (0.1, 1.0)
    empty = tuple(np.linspace(0.5, 1.0, 2) for _ in range(1 + len(plot.curves)))
    header = client.gui.add_html(markup.header(plot, height=height, hidden=()))
    handle = client.gui.add_uplot(
        empty,
        series(plot.curves, ()),
        scales=scales(plot, axis, 1.0),
        axes=axes(plot, axis),
        legend={"show": False},  # its numbers have three decimals: 1e-6 would read 0
        cursor={"sync": {"key": "t"}, "drag": {"x": False, "y": False}},  # zoomed, the time cursor would lie
        height=height,
        padding=markup.PADDING,
    )
    return Chart(base=plot, plot=plot, height=height, header=header, handle=handle, off=off)


def series(lines: tuple[Curve, ...], hidden: tuple[int, ...]) -> tuple[uplot.Series, ...]:
    """uPlot's description of the curves; the first entry is the time axis."""
    return (uplot.Series(label="t"), *(_line(curve, show=i not in hidden) for i, curve in enumerate(lines)))


def _line(curve: Curve, *, show: bool) -> uplot.Series:
    line = uplot.Series(label=curve.label, stroke=curve.color, width=curve.width, show=show, points={"show": False})
    if curve.dash:
        line["dash"] = curve.dash
    if curve.filled:
        line["fill"] = f"{curve.color}{palette.FILL}"
    return line


def tinted(plot: Plot) -> tuple[uplot.Band, ...] | None:
    """uPlot's description of what is tinted between two curves."""
    fills = ((upper, lower, f"{plot.curves[upper].color[:OPAQUE]}{palette.FILL}") for upper, lower in plot.bands)
    return tuple(uplot.Band(series=(upper + 1, lower + 1), fill=fill) for upper, lower, fill in fills) or None


def scales(plot: Plot, axis: curves.Range, duration: float) -> dict[str, uplot.Scale]:
    """Every time axis runs from 0 to the duration: windows too, so that one cursor fits all."""
    y = uplot.Scale(range=axis, distr=3, log=10) if plot.log else uplot.Scale(range=axis)
    return {"x": uplot.Scale(time=False, range=(0.0, duration)), "y": y}


def axes(plot: Plot, axis: curves.Range) -> tuple[uplot.Axis, uplot.Axis]:
    """Axes of fixed size; labels are made here, because uPlot's would read 1e-6 as 0 and need more room for 1e5."""
    places, labels = curves.decade_ticks(axis) if plot.log else curves.even_ticks(axis)
    y = uplot.Axis(size=markup.AXIS_WIDTH, gap=2, splits=tuple(places), values=tuple(labels))
    return uplot.Axis(size=markup.AXIS_HEIGHT, gap=2), y
