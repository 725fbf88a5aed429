"""One plot on the page: created once, then assigned. Its axes and curves are described as uPlot expects them."""

from dataclasses import dataclass, field
from operator import attrgetter

import numpy as np
from viser import ClientHandle, GuiHtmlHandle, GuiUplotHandle, uplot

from explorer.charts import comparison_curves, cursor_values, curves, markup
from explorer.charts.comparison_curves import PinnedDrawing
from explorer.charts.plots import Curve, Drawing, Plot
from explorer.model import palette
from explorer.model.comparison import Comparison
from explorer.model.compute import Picture
from explorer.model.drawn import Drawn

OPAQUE = len("#rrggbb")
"""Characters of a colour before its opacity."""


BIG, LARGE = 1.6, 1.4
"""Factors of the width of curves with big type, and in a plot that fills the window."""
COMPUTING = "computing …"
"""In a plot that has not been drawn yet: the first picture may take seconds, while the observers are compiled."""
FONT, BIG_FONT = "12px system-ui, sans-serif", "19px system-ui, sans-serif"


@dataclass(frozen=True, kw_only=True)
class ChartStyle:
    """How a plot is drawn, whatever it shows."""

    height: int = 102
    """px"""
    big: bool = False
    """Big type and thick curves, for a projector."""
    large: bool = False
    """Whether it is the plot of the large view."""
    dark: bool = False
    """Whether the page is dark."""


@dataclass(eq=False)
class Chart:
    """One plot on the page with the numbers that it shows."""

    base: Plot
    style: ChartStyle
    header: GuiHtmlHandle
    handle: GuiUplotHandle
    plot: Plot
    """The base with the curves of the compared runs, if there are any."""
    switched_off: set[int] = field(default_factory=set)
    """Legend entries (their columns) that the visitor has switched off."""
    drawing: Drawing | None = None
    pinned: PinnedDrawing | None = None
    duration: float = 0.0
    """s; the length of the time axis."""
    described: tuple[object, ...] = ()
    """The inputs from which the axes and curves on the page were described. They are described again only when an input
    changes, because each description rebuilds the chart in the browser."""
    bands: tuple[tuple[int, int], ...] = ()
    outdated: bool = True
    """Whether it may show an earlier picture, or none."""
    _drawn: Drawn = field(default_factory=Drawn)
    _legend_drawn: Drawn = field(default_factory=Drawn)
    _legend: list[tuple[str, str]] = field(default_factory=list)

    def draw(self, picture: Picture, comparison: Comparison) -> None:
        """Assign the curves if an input of the plot has changed; axes and legend only when they have changed."""
        self.outdated = False
        if not self._drawn.changed(*self._inputs(picture, comparison)):
            return
        self.pinned = comparison_curves.pinned(self.base, comparison.pinned, self.pinned)
        plot, drawing = comparison_curves.with_comparison(self.base, picture, comparison, self.pinned)
        if plot.curves != self.plot.curves:  # other runs are compared: their columns are new
            self.switched_off.difference_update(range(len(self.base.curves), len(self.plot.curves)))
        self.plot, self.drawing = plot, drawing
        self.duration = float(picture.motion.time[-1])
        time, values = curves.decimate(drawing.time, drawing.drawn)
        data = (time, *np.ascontiguousarray(values.T))
        if len(data) > len(self.handle.series):  # uPlot fails if a chart has more curves than data
            self.handle.data = data
        self._describe(drawing)
        self.handle.data = data

    def _inputs(self, picture: Picture, comparison: Comparison) -> tuple[object, ...]:
        """All that the drawing depends on."""
        own = (picture,) if self.base.inputs is None else (attrgetter(name)(picture) for name in self.base.inputs)
        candidates = (one for baseline in comparison.baselines for one in baseline)
        return picture.motion, *own, comparison.pinned, comparison.seeds, *candidates

    def forget(self) -> None:
        """Draw it anew next time, although its inputs stay."""
        self._drawn.forget()

    def is_among(self, names: frozenset[str] | None) -> bool:
        """Whether it is one of the plots of these names; None stands for all plots."""
        return names is None or self.base.name in names

    def restyle(self, style: ChartStyle) -> None:
        """Draw it in another size."""
        self.style = style
        self.handle.height, self.handle.padding = style.height, markup.padding(style.big)
        if self.drawing is not None:
            self._describe(self.drawing)

    def toggle(self, column: int) -> None:
        """Show or hide a legend entry's curve, and the curves that are linked to it."""
        self.switched_off ^= {column}
        if self.drawing is not None:
            self._describe(self.drawing)

    def not_drawn(self, drawing: Drawing) -> tuple[int, ...]:
        """Columns that are not drawn: hidden by the drawing, or switched off by the visitor."""
        return (*drawing.hidden, *(i for column in sorted(self.switched_off) for i in self.plot.linked(column)))

    def _describe(self, drawing: Drawing) -> None:
        """Assign axes, legend and curves if any of their inputs has changed."""
        switched_off = frozenset(self.switched_off)
        empty = self.plot.reason_if_empty(drawing)
        empty = f"B: {empty}" if empty and self.pinned is not None else empty  # A may have curves
        inputs = (drawing.axis, drawing.hidden, self.duration, switched_off, self.plot.curves, self.style, empty)
        if inputs != self.described:
            self.described = inputs
            if self.plot.bands != self.bands:
                self.bands, self.handle.bands = self.plot.bands, bands(self.plot)
            self.handle.series = series(self.plot.curves, self.not_drawn(drawing), self.style)
            self.handle.scales = scales(self.plot, drawing.axis, self.duration)
            self.handle.axes = axes(self.plot, drawing.axis, self.style)
            self.header.content = markup.header(
                self.plot,
                large=self.style.large,
                empty=empty,
                height=self.style.height,
                big=self.style.big,
                hidden=drawing.hidden,
                switched_off=switched_off,
            )

    def legend_values(self, time: float) -> list[tuple[str, str]]:
        """CSS variable and text of each legend entry at a time (s); a window counts until the next one starts."""
        if self.drawing is None:
            return []
        if not self._legend_drawn.changed(self.drawing, time, frozenset(self.switched_off)):
            return self._legend
        row = cursor_values.row_at(self.drawing, time)
        not_drawn = self.not_drawn(self.drawing)
        drawn = [i for i in self.plot.in_legend if i not in not_drawn]
        self._legend = [(markup.variable(self.plot, i), cursor_values.legend_text(row[i])) for i in drawn]
        return self._legend


def add_chart(client: ClientHandle, plot: Plot, style: ChartStyle, switched_off: set[int]) -> Chart:
    """A plot without curves under its header, which says that they are being computed; the first draw fills it."""
    axis = (0.1, 1.0)
    time, unknown = np.array([0.0, 1.0]), np.full(2, np.nan)
    header = client.gui.add_html(
        markup.header(plot, height=style.height, big=style.big, large=style.large, empty=COMPUTING, hidden=())
    )
    handle = client.gui.add_uplot(
        (time, *(unknown for _ in plot.curves)),
        series(plot.curves, (), style),
        scales=scales(plot, axis, 1.0),
        axes=axes(plot, axis, style),
        legend={"show": False},  # its numbers have three decimals: 1e-6 would be 0
        cursor={
            "sync": {"key": "t" if plot.along_flight else plot.x_name},
            "drag": {"x": False, "y": False},
        },  # a zoom would displace the time cursor
        height=style.height,
        padding=markup.padding(style.big),
    )
    return Chart(base=plot, plot=plot, style=style, header=header, handle=handle, switched_off=switched_off)


def series(lines: tuple[Curve, ...], hidden: tuple[int, ...], style: ChartStyle) -> tuple[uplot.Series, ...]:
    """uPlot's description of the curves; the first entry is the time axis."""
    factor = (BIG if style.big else 1.0) * (LARGE if style.large else 1.0)
    return (
        uplot.Series(label="t"),
        *(_line(curve, factor * curve.width, show=i not in hidden) for i, curve in enumerate(lines)),
    )


def _line(curve: Curve, width: float, *, show: bool) -> uplot.Series:
    line = uplot.Series(label=curve.label, stroke=curve.color, width=width, show=show, points={"show": False})
    if curve.dash:
        line["dash"] = curve.dash
    if curve.filled:
        line["fill"] = f"{curve.color}{palette.FILL}"
    return line


def bands(plot: Plot) -> tuple[uplot.Band, ...] | None:
    """uPlot's description of the tinted bands between two curves."""
    fills = ((upper, lower, f"{plot.curves[upper].color[:OPAQUE]}{palette.FILL}") for upper, lower in plot.bands)
    return tuple(uplot.Band(series=(upper + 1, lower + 1), fill=fill) for upper, lower, fill in fills) or None


def scales(plot: Plot, axis: curves.Range, duration: float) -> dict[str, uplot.Scale]:
    """Every time axis runs from 0 to the duration, also for windows, so that one cursor serves all plots."""
    y = uplot.Scale(range=axis, distr=3, log=10) if plot.log else uplot.Scale(range=axis)
    return {"x": uplot.Scale(time=False, range=(0.0, duration)), "y": y}


def axes(plot: Plot, axis: curves.Range, style: ChartStyle) -> tuple[uplot.Axis, uplot.Axis]:
    """Axes of fixed size. The labels are written here: uPlot would write 1e-6 as 0, and 1e5 needs more room there."""
    positions, labels = curves.decade_ticks(axis) if plot.log else curves.even_ticks(axis)
    width, height = markup.axis_sizes(style.big)
    font = BIG_FONT if style.big else FONT
    grid = uplot.Axis_Grid(stroke=palette.PAGE_GRID)  # viser's own cannot be seen on a dark page
    y = uplot.Axis(size=width, gap=2, font=font, splits=tuple(positions), values=tuple(labels), grid=grid)
    x = uplot.Axis(size=height, gap=2, font=font, grid=grid)
    if not plot.along_flight:  # another quantity than the time of the flight
        color = palette.OTHER_AXIS[style.dark]
        x["stroke"], x["grid"] = color, {"stroke": f"{color}{palette.FILL}", "dash": (2, 4)}
    return x, y
