"""The plots in the left dock: created once, then assigned. `plots` turns a Picture into numbers, `markup` into HTML."""

from collections.abc import Callable
from functools import partial

from viser import ClientHandle

from explorer.charts import cursor_values, markup, plot_file, plot_list
from explorer.charts.chart import Chart
from explorer.charts.over_page import OverPage
from explorer.charts.plot_size import PlotSize
from explorer.charts.plot_tabs import PlotPanel
from explorer.charts.plot_text import PlotTexts
from explorer.charts.pointer import Pointer, curve_id
from explorer.model.comparison import NOTHING, Comparison
from explorer.model.compute import Picture
from explorer.model.drawn import Drawn

GROUP_TITLES = {group.title: {plot.name: plot.title for plot in group.plots} for group in plot_list.GROUPS}
"""The titles of the plots by their names, for each group of plots that share a tab."""
PLOTS = {plot.name: plot for group in plot_list.GROUPS for plot in group.plots}
TITLES = {name: plot.title for name, plot in PLOTS.items()}
"""The title of each plot, by the plot's name."""
SLOW = frozenset(plot.name for group in plot_list.GROUPS if group.slow for plot in group.plots)
"""The plots that follow when nothing has changed for a moment."""
EXCITATION = "excitation"
BESIDE = "-beside"
"""Behind the name of a plot: the plot of the pinned run and of the one on the page, side by side."""


def _nothing() -> None:
    """For charts that no session waits for."""


class Charts:
    """All plots of one visitor: two panels side by side, or one panel on a narrow page."""

    def __init__(self, client: ClientHandle, size: PlotSize, wake: Callable[[], None] = _nothing) -> None:
        """`wake` is called from viser's threads when the mouse has done something; `cursor` then reacts."""
        self._client, self._pointer = client, Pointer(wake)
        self._picture: Picture | None = None
        self._comparison = NOTHING
        self._time, self._cursor_drawn = 0.0, Drawn()
        self._in_sight: frozenset[str] | None = None
        self._settled = False
        """Whether the slow groups may be drawn: nothing has changed for a moment."""
        self._switched_off: dict[str, set[int]] = {name: set() for name in TITLES}
        self._pointer.add_to(client.gui)  # outside the panels: one that is folded has nothing in the page
        self._moving, self._values = client.gui.add_html(""), client.gui.add_html("")
        """The elements that change as time moves, also where no plot is in sight: the cursors at every frame, and the
        values seldom enough to be read."""
        self._texts = PlotTexts(client)
        self._over = OverPage(client)
        self._size = size
        self._panels = self._build(size)

    def _build(self, size: PlotSize) -> list[PlotPanel]:
        errors, *others = plot_list.GROUPS
        groups = [(errors,), tuple(others)] if size.two_panels else [plot_list.GROUPS]
        # The browser puts each new panel outermost, whatever viser's documentation says: so the first comes last.
        panels = [PlotPanel(self._client, one, self._switched_off, size.style) for one in groups[::-1]]
        if not size.two_panels:
            panels[0].panel.set_width(size.width)
        if size.folded:
            panels[0].panel.minimize()
        return panels[::-1]

    def resize(self, size: PlotSize) -> bool:
        """Take another size. Returns whether the panels were created anew, and now wait for `draw`."""
        before, self._size = self._size, size
        if before == size:
            return False
        if before.two_panels != size.two_panels:
            for panel in self._panels:
                panel.panel.remove()
            self._panels = self._build(size)
            return True
        if before.width != size.width and not size.two_panels:
            self._panels[0].panel.set_width(size.width)
        if before.folded != size.folded:
            (self._panels[0].panel.minimize if size.folded else self._panels[0].panel.expand)()
        if before.style != size.style:
            for panel in self._panels:
                panel.restyle(size.style)
        return False

    @property
    def charts(self) -> list[Chart]:
        """The charts of all panels and tabs."""
        return [chart for panel in self._panels for chart in panel.charts]

    def see(self, names: frozenset[str] | None) -> None:
        """Draw the plots of these names alone from now on, because no other is in sight; None for all plots. What comes
        into sight is drawn at once."""
        if names == self._in_sight:
            return
        self._in_sight = names
        if self._picture is not None:
            self._draw_in_sight(self._picture)
            self.cursor(self._picture, self._time)
            if self._settled:
                self._write_texts()

    def _take(self, picture: Picture) -> None:
        if picture is not self._picture or not self._settled:
            for panel in self._panels:
                panel.mark_outdated()
        self._picture = picture
        self._draw_in_sight(picture)

    def _draw_in_sight(self, picture: Picture) -> None:
        for panel in self._panels:
            panel.draw(picture, self._comparison, in_sight=self._in_sight, settled=self._settled)
        self._cursor_drawn.forget()

    @property
    def actions(self) -> dict[str, Callable[[], None]]:
        """What the buttons of the plots do, by the names that they send."""
        expand = {f"expand-{name}": partial(self._expand, name) for name in PLOTS}
        beside = {f"beside-{name}": partial(self.show_side_by_side, name) for name in PLOTS}
        return expand | beside | {"close-large": self.close_large}

    def _expand(self, name: str) -> None:
        """Show a plot large."""
        pinned = self._comparison.pinned is not None
        self._over.enlarge(PLOTS[name], self._size, self._switched_off[name], pinned=pinned)
        self._draw_over()

    def show_side_by_side(self, name: str = EXCITATION) -> None:
        """Show a plot of the pinned run and of the one on the page side by side."""
        self._over.open_side_by_side(PLOTS[name], TITLES, self._size)
        self._draw_over()

    def close_large(self) -> None:
        """Close the window over the page, if there is one."""
        self._over.close()

    def _draw_over(self) -> None:
        """Draw the window over the page."""
        if self._over.plot is not None and self._picture is not None:
            self._over.draw(self._picture, self._comparison)
            self._write_texts()
        self._cursor_drawn.forget()

    def draw(self, picture: Picture, comparison: Comparison = NOTHING, *, time: float | None = None) -> None:
        """Show another picture and the runs compared with it; the cursor moves to a time (s), or stays."""
        self._comparison, self._settled = comparison, False
        self._take(picture)
        if self._over.plot is not None and self._over.plot.name not in SLOW:
            self._draw_over()
        self.cursor(picture, self._time if time is None else time)

    def draw_details(self, picture: Picture) -> None:
        """Show the slow groups, which take as long to compute as all others together; called when nothing has changed
        for a moment."""
        self._settled = True
        self._take(picture)
        if self._over.plot is not None:
            self._draw_over()
        self.cursor(picture, self._time)
        self._write_texts()

    def _write_texts(self) -> None:
        """Say in sentences what the plots in sight show."""
        in_sight = (chart for chart in self.charts if chart.is_among(self._in_sight))
        self._texts.write([*in_sight, *self._over.charts])

    def cursor(self, picture: Picture, time: float, *, values: bool = True) -> None:
        """Move the time cursor of all plots to a time (s), show or hide the curves whose legend entries were clicked,
        and give the values at the mouse, or else at the cursor; `values` may stay while time moves."""
        self._time = time
        self._toggle_clicked()
        duration = float(picture.motion.time[-1])
        fraction, window = min(max(time / duration, 0.0), 1.0), cursor_values.window_at(picture, time)
        moving = markup.moving_style(fraction, window)
        if moving != self._moving.content:
            self._moving.content = moving
        if values:
            self._write_values(picture, time)

    def _write_values(self, picture: Picture, time: float) -> None:
        duration, pointed = float(picture.motion.time[-1]), self._pointer.fraction
        if not self._cursor_drawn.changed(picture, time, pointed):
            return
        values_at = time if pointed is None else pointed * duration
        hovered = None if pointed is None else (pointed, f"{pointed * duration:.2f} s")
        in_sight = (chart for chart in self.charts if chart.is_among(self._in_sight))
        beside = self._over.side_by_side
        charts = (*in_sight, *(() if beside is None else beside.charts))
        values = [entry for chart in charts for entry in chart.legend_values(values_at)]
        status = cursor_values.status_line(picture, time)
        self._values.content = markup.values_style(values, status, hovered)

    def take_brush(self) -> tuple[float, float] | None:
        """The part of the time axis that was brushed since the last call: start and end (s), equal for a click."""
        brush = self._pointer.take_brush()
        if brush is None or self._picture is None:
            return None
        duration = float(self._picture.motion.time[-1])
        return brush[0] * duration, brush[1] * duration

    def show_all_curves(self) -> None:
        """Show every curve that the visitor has switched off."""
        for chart in self.charts:
            for column in tuple(chart.switched_off):
                chart.toggle(column)
        self._cursor_drawn.forget()

    def file_writer(self, name: str, kind: plot_file.PlotFormat) -> Callable[[], bytes]:
        """A function that writes a plot, as it is shown now, to a file's bytes. It is slow, and may be called in any
        thread.

        Raises ValueError with one sentence if there is no such plot, if no curve is shown, or if the file would be too
        large."""
        if name.endswith(BESIDE) and kind != "csv":
            beside = self._over.side_by_side
            if beside is None:
                raise ValueError("two runs side by side are not shown: “Show A and B side by side” in the tab Compare")
            return partial(plot_file.picture, beside.panels(), kind, beside.summary())
        chart = next((chart for chart in self.charts if chart.plot.name == name), None)
        if chart is not None and chart.outdated and self._picture is not None and (self._settled or name not in SLOW):
            chart.draw(self._picture, self._comparison)  # it was out of sight
        if chart is None or chart.drawing is None:
            raise ValueError(f"there is no plot {name!r} yet")
        if chart.outdated:
            raise ValueError(f"{chart.plot.title}: still shows an earlier state; it follows as soon as nothing moves")
        not_drawn = chart.not_drawn(chart.drawing)
        columns = tuple(i for i in range(len(chart.plot.curves)) if i not in not_drawn)
        plot_file.require_writable(chart.plot, chart.drawing, columns)
        return partial(plot_file.WRITERS[kind], chart.plot, chart.drawing, columns, chart.duration)

    def show_paper_figures(self) -> None:
        """Bring the errors (paper, fig. 3 and 4) to the front. viser has no command that selects a tab. On a narrow
        page the other tabs are therefore created anew: the browser then selects the one that stayed."""
        first = self._panels[0]
        first.panel.expand()
        if not self._size.two_panels:
            first.keep_only_first_tab()
            if self._picture is not None:
                self.draw(self._picture, self._comparison)
                self.draw_details(self._picture)

    def _toggle_clicked(self) -> None:
        clicks = self._pointer.take_clicks()
        if not clicks:
            return
        for chart in (*self.charts, *self._over.charts):
            for column in chart.plot.in_legend:
                if clicks.count(curve_id(chart.plot, column)) % 2:
                    chart.toggle(column)
                    self._cursor_drawn.forget()
