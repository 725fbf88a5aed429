"""The plots in the left dock: created once, then assigned. `plots` turns a Picture into numbers, `markup` into HTML."""

from collections.abc import Callable
from functools import partial

import numpy as np
from viser import ClientHandle

from explorer.charts import cursor_values, markup, plot_file, plot_list
from explorer.charts.chart import Chart
from explorer.charts.plot_tabs import PlotPanel
from explorer.charts.pointer import Pointer, curve_id
from explorer.model.comparison import NOTHING, Comparison
from explorer.model.compute import Picture

NARROW_WIDTH, PANEL_WIDTH = 360, 303
"""px of a single panel, and of each of two. viser opens a second panel at this width of its own."""
HEIGHT, NARROW_HEIGHT = 162, 102
"""px of a plot: four plots fill a panel on a screen 1080 or 768 px high."""
TITLES = {plot.name: plot.title for group in plot_list.GROUPS for plot in group.plots}
"""The title of each plot, by the plot's name."""


def _nothing() -> None:
    """For charts that no session waits for."""


class Charts:
    """All plots of one visitor: two panels side by side, or one panel on a narrow page."""

    def __init__(self, client: ClientHandle, *, narrow: bool, wake: Callable[[], None] = _nothing) -> None:
        """`wake` is called from viser's threads when the mouse has done something; `cursor` then reacts."""
        self._client, self._pointer = client, Pointer(wake)
        self._narrow = narrow
        self._height = NARROW_HEIGHT if narrow else HEIGHT
        self._picture: Picture | None = None
        self._comparison = NOTHING
        self._time = 0.0
        errors, *others = plot_list.GROUPS
        panels = [plot_list.GROUPS] if narrow else [(errors,), tuple(others)]
        # The browser puts each new panel outermost, whatever viser's documentation says: so the first comes last.
        panels = [PlotPanel(client, groups, self._pointer, height=self._height) for groups in reversed(panels)]
        self._panels = panels[::-1]
        self.width = NARROW_WIDTH if narrow else 2 * PANEL_WIDTH
        """px of all panels together."""
        if narrow:
            self._panels[0].panel.set_width(NARROW_WIDTH)

    @property
    def charts(self) -> list[Chart]:
        """The charts of all panels and tabs."""
        return [chart for panel in self._panels for chart in panel.charts]

    def draw(self, picture: Picture, comparison: Comparison = NOTHING) -> None:
        """Show another picture and the runs compared with it; the cursor stays at its time."""
        self._picture, self._comparison = picture, comparison
        for panel in self._panels:
            panel.draw(picture, comparison)
        self.cursor(picture, self._time)

    def draw_details(self, picture: Picture) -> None:
        """Show the slow groups, which take as long to compute as all others together; called when nothing has changed
        for a moment."""
        for panel in self._panels:
            panel.draw_details(picture, self._comparison)
        self.cursor(picture, self._time)

    def cursor(self, picture: Picture, time: float) -> None:
        """Move the time cursor of all plots to a time (s), show or hide the curves whose legend entries were clicked,
        and give the values at the mouse, or else at the cursor. One small message for each panel."""
        self._time = time
        self._toggle_clicked()
        duration, pointed = float(picture.motion.time[-1]), self._pointer.fraction
        hovered = None if pointed is None else (pointed, f"{pointed * duration:.2f} s")
        values_at = time if pointed is None else pointed * duration
        fraction, window = float(np.clip(time / duration, 0.0, 1.0)), cursor_values.window_at(picture, time)
        for i, panel in enumerate(self._panels):
            status = cursor_values.status_line(picture, time) if i == 0 else ""
            values = [entry for chart in panel.charts for entry in chart.legend_values(values_at)]
            panel.live.content = markup.live_style(fraction, window, values, status, hovered)

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

    def file_writer(self, name: str, kind: plot_file.PlotFormat) -> Callable[[], bytes]:
        """A function that writes a plot, as it is shown now, to a file's bytes. It is slow, and may be called in any
        thread.

        Raises ValueError with one sentence if there is no such plot, if no curve is shown, or if the file would be too
        large."""
        chart = next((chart for chart in self.charts if chart.plot.name == name), None)
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
        if self._narrow:
            first.keep_only_first_tab()
            if self._picture is not None:
                self.draw(self._picture, self._comparison)
                self.draw_details(self._picture)

    def _toggle_clicked(self) -> None:
        clicks = self._pointer.take_clicks()
        for chart in self.charts:
            for column in chart.plot.in_legend:
                if clicks.count(curve_id(chart.plot, column)) % 2:
                    chart.toggle(column)
