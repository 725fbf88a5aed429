"""The plots in the left dock: created once, then assigned. `plots` has the numbers of a Picture, `markup` the HTML."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from viser import ClientHandle, GuiHtmlHandle, GuiTabHandle, GuiUplotHandle, Icon, PanelHandle, uplot

from explorer.beside import NOTHING, Beside
from explorer.charts import catalogue, curves, export, markup, overlay
from explorer.charts.catalogue import Group
from explorer.charts.overlay import Pinned
from explorer.charts.plots import Curve, Drawing, Plot
from explorer.charts.pointer import Pointer, curve_id
from explorer.compute import Picture

NARROW_WIDTH, COLUMN_WIDTH = 360, 303
"""px of a single column, and of each of two: a second one always opens at viser's own width, so two keep that."""
HEIGHT, NARROW_HEIGHT = 162, 102
"""px of a plot: four of them fill a column of a screen 1080 or 768 px high."""
BAND_TINT, HEX = "38", len("#rrggbb")
"""Opacity, hexadecimal; and how much of a colour stands before its own."""
TITLES = {plot.name: plot.title for group in catalogue.GROUPS for plot in group.plots}
"""Of all plots, by their names."""
FOLLOWS = "Follows as soon as nothing moves."
ICONS = {"Errors": Icon.CHART_LINE, "Observability": Icon.EYE, "Signals": Icon.WAVE_SINE}
ICONS |= {"In depth": Icon.MICROSCOPE, "Twin": Icon.GHOST}


@dataclass(eq=False)
class _Said:
    """The sentences above the plots of a group."""

    group: Group
    handle: GuiHtmlHandle

    def draw(self, picture: Picture) -> None:
        assert self.group.say is not None
        self._show(self.group.say(picture))

    def wait(self) -> None:
        """What is below belongs to an earlier picture, and says so."""
        self._show((FOLLOWS,))

    def _show(self, sentences: tuple[str, ...]) -> None:
        content = markup.sentences(sentences)
        if content != self.handle.content:
            self.handle.content = content


def _nothing() -> None:
    """For charts that nobody watches."""


@dataclass(eq=False)
class _Chart:
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
    picture: Picture | None = None
    """What it was drawn from."""
    pinned: Pinned | None = None
    duration: float = 0.0
    """s, that the time axis spans."""
    looks: tuple[object, ...] = ()
    """What the axes and visible curves were made for: changing those rebuilds the chart in the browser."""
    bands: tuple[tuple[int, int], ...] = ()

    def draw(self, picture: Picture, beside: Beside) -> None:
        """Assign the curves; the axes and the legend only when they differ."""
        self.pinned = overlay.pinned(self.base, beside.pinned, self.pinned)
        plot, drawing = overlay.over(self.base, picture, beside, self.pinned)
        if plot.curves != self.plot.curves:  # what stood beside has come or gone, and others have its places
            self.off.difference_update(range(len(self.base.curves), len(self.plot.curves)))
        self.plot, self.drawing, self.picture = plot, drawing, picture
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
        row = _read_at(self.drawing, time)
        unseen = self.unseen(self.drawing)
        return [(markup.variable(self.plot, i), said(row[i])) for i in self.plot.named if i not in unseen]


class Charts:
    """All plots of one visitor: two columns beside each other, or one column of tabs."""

    def __init__(self, client: ClientHandle, *, narrow: bool, note: Callable[[], None] = _nothing) -> None:
        """`note` is called when the mouse has news; then `cursor` takes it in."""
        self._client, self._pointer = client, Pointer(note)
        self._narrow = narrow
        self._height = NARROW_HEIGHT if narrow else HEIGHT
        self._picture: Picture | None = None
        self._beside = NOTHING
        self._time = 0.0
        errors, *others = catalogue.GROUPS
        columns = [catalogue.GROUPS] if narrow else [(errors,), tuple(others)]
        # The browser puts each new column outermost, whatever viser's documentation says: so the first comes last.
        columns = [_Column(client, groups, self._pointer, height=self._height) for groups in reversed(columns)]
        self._columns = columns[::-1]
        self.width = NARROW_WIDTH if narrow else 2 * COLUMN_WIDTH
        """px that the columns take."""
        if narrow:
            self._columns[0].panel.set_width(NARROW_WIDTH)

    def draw(self, picture: Picture, beside: Beside = NOTHING) -> None:
        """Show another picture and what stands beside it; the cursor stays at its time."""
        self._picture, self._beside = picture, beside
        for column in self._columns:
            column.draw(picture, beside)
        self.cursor(picture, self._time)

    def draw_later(self, picture: Picture) -> None:
        """Show what takes as long as all else together; for when nothing moves."""
        for column in self._columns:
            column.draw_later(picture, self._beside)
        self.cursor(picture, self._time)

    def cursor(self, picture: Picture, time: float) -> None:
        """Move the shared time cursor, and say the values there, or where the mouse is: one small message for each
        column. Curves whose legend entries were clicked come and go."""
        self._time = time
        clicked = self._pointer.clicked()
        for chart in self._all():
            for column in chart.plot.named:
                if clicked.count(curve_id(chart.plot, column)) % 2:
                    chart.toggle(column)
        duration, place = float(picture.motion.time[-1]), self._pointer.place
        hovered = None if place is None else (place, f"{place * duration:.2f} s")
        moment = time if place is None else place * duration
        fraction, window = float(np.clip(time / duration, 0.0, 1.0)), window_at(picture, time)
        for i, column in enumerate(self._columns):
            said = sentence(picture, time) if i == 0 else ""
            values = [entry for chart in column.charts for entry in chart.values(moment)]
            column.live.content = markup.live(fraction, window, values, said, hovered)

    def brushed(self) -> tuple[float, float] | None:
        """Where a plot was brushed since the last call (s): from when to when, equal for a click."""
        found = self._pointer.brushed()
        if found is None or self._picture is None:
            return None
        duration = float(self._picture.motion.time[-1])
        return found[0] * duration, found[1] * duration

    def show_all(self) -> None:
        """Bring back every curve that was switched off."""
        for chart in self._all():
            for column in tuple(chart.off):
                chart.toggle(column)

    def plan(self, name: str, kind: export.Kind) -> Callable[[], bytes]:
        """What makes a file of a plot as it is shown now; it may be called in any thread, and takes its time.

        Raises ValueError with one sentence if there is no such plot, nothing in it, or too much."""
        chart = next((chart for chart in self._all() if chart.plot.name == name), None)
        if chart is None or chart.drawing is None:
            raise ValueError(f"there is no plot {name!r} yet")
        if chart.picture is not self._picture:
            raise ValueError(f"{chart.plot.title}: still shows an earlier state; it follows as soon as nothing moves")
        unseen = chart.unseen(chart.drawing)
        columns = tuple(i for i in range(len(chart.plot.curves)) if i not in unseen)
        export.refuse(chart.plot, chart.drawing, columns)
        return partial(export.WRITERS[kind], chart.plot, chart.drawing, columns, chart.duration)

    def show_paper_figures(self) -> None:
        """Bring the errors (paper, fig. 3 and 4) to the front. viser has no command that selects a tab, so in the
        narrow page the other tabs are made anew: the browser then falls back to the one that stayed."""
        first = self._columns[0]
        first.panel.expand()
        if self._narrow:
            first.keep_only_first_tab()
            if self._picture is not None:
                self.draw(self._picture, self._beside)
                self.draw_later(self._picture)

    def _all(self) -> list[_Chart]:
        return [chart for column in self._columns for chart in column.charts]


class _Column:
    """One dock panel, with a tab for each group."""

    def __init__(self, client: ClientHandle, groups: tuple[Group, ...], pointer: Pointer, *, height: int) -> None:
        self._client, self._groups, self._height = client, groups, height
        self._off: dict[str, set[int]] = {plot.name: set() for group in groups for plot in group.plots}
        self.panel: PanelHandle = client.gui.add_panel()
        self._tabs: list[GuiTabHandle] = []
        self._charts: list[list[_Chart]] = []
        self._said: list[list[_Said]] = []
        self._add_tab(groups[0])
        with self._tabs[0]:
            pointer.add_to(client.gui)
            self.live = client.gui.add_html("", order=-1.0)
        for group in groups[1:]:
            self._add_tab(group)
        self.panel.dock_left()

    def draw(self, picture: Picture, beside: Beside) -> None:
        for group, charts, said in zip(self._groups, self._charts, self._said, strict=True):
            if group.later:
                for sentences in said:
                    sentences.wait()
            else:
                self._draw_group(picture, beside, charts, said)

    def draw_later(self, picture: Picture, beside: Beside) -> None:
        for group, charts, said in zip(self._groups, self._charts, self._said, strict=True):
            if group.later:
                self._draw_group(picture, beside, charts, said)

    def _draw_group(self, picture: Picture, beside: Beside, charts: list[_Chart], said: list[_Said]) -> None:
        for chart in charts:
            chart.draw(picture, beside)
        for sentences in said:
            sentences.draw(picture)

    def keep_only_first_tab(self) -> None:
        """Remove all tabs but the first, and add them again behind it."""
        for tab in self._tabs[1:]:
            tab.remove()
        del self._tabs[1:], self._charts[1:], self._said[1:]
        for group in self._groups[1:]:
            self._add_tab(group)

    @property
    def charts(self) -> list[_Chart]:
        """Of all tabs."""
        return [chart for charts in self._charts for chart in charts]

    def _add_tab(self, group: Group) -> None:
        tab = self.panel.add_tab(group.title, ICONS[group.title])
        self._tabs.append(tab)
        with tab:
            self._said.append([_Said(group, self._client.gui.add_html(""))] if group.say else [])
            self._charts.append(
                [_add_chart(self._client, plot, self._height, self._off[plot.name]) for plot in group.plots]
            )


def _add_chart(client: ClientHandle, plot: Plot, height: int, off: set[int]) -> _Chart:
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
    return _Chart(base=plot, plot=plot, height=height, header=header, handle=handle, off=off)


def series(lines: tuple[Curve, ...], hidden: tuple[int, ...]) -> tuple[uplot.Series, ...]:
    """uPlot's description of the curves; the first entry is the time axis."""
    return (uplot.Series(label="t"), *(_line(curve, show=i not in hidden) for i, curve in enumerate(lines)))


def _line(curve: Curve, *, show: bool) -> uplot.Series:
    line = uplot.Series(label=curve.label, stroke=curve.color, width=curve.width, show=show, points={"show": False})
    if curve.dash:
        line["dash"] = curve.dash
    if curve.filled:
        line["fill"] = f"{curve.color}38"
    return line


def tinted(plot: Plot) -> tuple[uplot.Band, ...] | None:
    """uPlot's description of what is tinted between two curves."""
    fills = ((upper, lower, f"{plot.curves[upper].color[:HEX]}{BAND_TINT}") for upper, lower in plot.bands)
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


def said(value: float) -> str:
    """A value in a legend: a number, or why there is none."""
    if np.isinf(value):
        return "blind" if value > 0 else "< floor"
    return curves.number(float(value))


def sentence(picture: Picture, time: float) -> str:
    """What the 3-D picture shows, in one line."""
    motion, errors = picture.motion, picture.errors
    k = int(np.clip(np.searchsorted(motion.time, time - 1e-9), 0, len(motion.time) - 1))
    distance = float(np.linalg.norm(motion.position[k] - np.asarray(picture.preset.world.anchor)))
    position, attitude = curves.number(float(errors.position[k])), curves.number(float(np.degrees(errors.attitude[k])))
    return (
        f"<b>{time:.2f} s</b> · {curves.number(distance)} m from the anchor · "
        f"estimate off by <b>{position} m</b>, <b>{attitude}°</b>"
    )


def window_at(picture: Picture, time: float) -> tuple[float, float]:
    """Start and length, as shares of the duration, of the window that starts at a time, or of the last one before."""
    duration, length = float(picture.motion.time[-1]), picture.preset.requirement.window
    return float(np.clip(time, 0.0, duration - length)) / duration, length / duration


def _read_at(drawing: Drawing, time: float) -> np.ndarray:
    """The row at a time; NaN after the last window has started, and where no range has ever come."""
    if not len(drawing.time):
        return np.full(drawing.read.shape[1], np.nan)
    step = drawing.time[1] - drawing.time[0] if len(drawing.time) > 1 else 0.0
    if time > drawing.time[-1] + step:
        return np.full(drawing.read.shape[1], np.nan)
    return drawing.read[max(int(np.searchsorted(drawing.time, time + 1e-9)) - 1, 0)]
