"""The plots in the left dock: created once, then assigned. `plots` has the numbers of a Picture, `markup` the HTML."""

from collections.abc import Callable
from functools import partial

import numpy as np
from viser import ClientHandle

from explorer.charts import cursor_values, markup, plot_file, plot_list
from explorer.charts.chart import Chart
from explorer.charts.plot_tabs import Column
from explorer.charts.pointer import Pointer, curve_id
from explorer.model.comparison import NOTHING, Comparison
from explorer.model.compute import Picture

NARROW_WIDTH, COLUMN_WIDTH = 360, 303
"""px of a single column, and of each of two: a second one always opens at viser's own width, so two keep that."""
HEIGHT, NARROW_HEIGHT = 162, 102
"""px of a plot: four of them fill a column of a screen 1080 or 768 px high."""
TITLES = {plot.name: plot.title for group in plot_list.GROUPS for plot in group.plots}
"""Of all plots, by their names."""


def _nothing() -> None:
    """For charts that nobody watches."""


class Charts:
    """All plots of one visitor: two columns beside each other, or one column of tabs."""

    def __init__(self, client: ClientHandle, *, narrow: bool, wake: Callable[[], None] = _nothing) -> None:
        """`note` is called when the mouse has news; then `cursor` takes it in."""
        self._client, self._pointer = client, Pointer(wake)
        self._narrow = narrow
        self._height = NARROW_HEIGHT if narrow else HEIGHT
        self._picture: Picture | None = None
        self._beside = NOTHING
        self._time = 0.0
        errors, *others = plot_list.GROUPS
        columns = [plot_list.GROUPS] if narrow else [(errors,), tuple(others)]
        # The browser puts each new column outermost, whatever viser's documentation says: so the first comes last.
        columns = [Column(client, groups, self._pointer, height=self._height) for groups in reversed(columns)]
        self._columns = columns[::-1]
        self.width = NARROW_WIDTH if narrow else 2 * COLUMN_WIDTH
        """px that the columns take."""
        if narrow:
            self._columns[0].panel.set_width(NARROW_WIDTH)

    def draw(self, picture: Picture, beside: Comparison = NOTHING) -> None:
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
        fraction, window = float(np.clip(time / duration, 0.0, 1.0)), cursor_values.window_at(picture, time)
        for i, column in enumerate(self._columns):
            said = cursor_values.sentence(picture, time) if i == 0 else ""
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

    def plan(self, name: str, kind: plot_file.PlotFormat) -> Callable[[], bytes]:
        """What makes a file of a plot as it is shown now; it may be called in any thread, and takes its time.

        Raises ValueError with one sentence if there is no such plot, nothing in it, or too much."""
        chart = next((chart for chart in self._all() if chart.plot.name == name), None)
        if chart is None or chart.drawing is None:
            raise ValueError(f"there is no plot {name!r} yet")
        if chart.stale:
            raise ValueError(f"{chart.plot.title}: still shows an earlier state; it follows as soon as nothing moves")
        unseen = chart.unseen(chart.drawing)
        columns = tuple(i for i in range(len(chart.plot.curves)) if i not in unseen)
        plot_file.refuse(chart.plot, chart.drawing, columns)
        return partial(plot_file.WRITERS[kind], chart.plot, chart.drawing, columns, chart.duration)

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

    def _all(self) -> list[Chart]:
        return [chart for column in self._columns for chart in column.charts]
