"""The pinned run A and the run B on the page side by side: numbers above, and the same plot of both on the same axes.

Both plots have the time axis of B, so that one cursor and one mouse position serve both.
"""

from collections.abc import Sequence
from dataclasses import replace

from viser import ClientHandle
from viser._gui_handles import GuiModalHandle

from explorer.charts import comparison_curves, plot_file
from explorer.charts.chart import Chart, ChartStyle, add_chart
from explorer.charts.large_view import BUTTON, save_buttons
from explorer.charts.plots import Drawing, Plot
from explorer.model import differences, side_by_side
from explorer.model.comparison import NOTHING, Comparison
from explorer.model.compute import Picture
from explorer.widgets.html import escaped

AROUND, BIG_AROUND, MIN_HEIGHT = 370, 570, 190
"""px of the window's height that the plots leave to numbers, legends and buttons, and with big type; their least
height."""
OFFERED = ("excitation", "gramian", "predicted", "position", "attitude")
"""The plots that a button shows instead; any other one is reached from its large view."""
FORMATS: tuple[plot_file.PictureFormat, ...] = ("svg", "png", "pdf")
NO_RUN = "No run is pinned. “Pin this run as A” in the tab Compare keeps the run on the page."
RUNS = "AB"
OTHER_PLOT = '<button type="button" class="rn-button rn-switch" data-rn-event="{}" aria-pressed="{}">{}</button>'


class SideBySide:
    """A window over the page with both runs."""

    def __init__(
        self, client: ClientHandle, plot: Plot, titles: dict[str, str], window_height: float, of_page: ChartStyle
    ) -> None:
        """`titles` of the plots by their names; `of_page`: the style of the other plots."""
        self.plot = plot
        self._modal: GuiModalHandle = client.gui.add_modal("A and B side by side")
        height = max(round(window_height) - (BIG_AROUND if of_page.big else AROUND), MIN_HEIGHT)
        style = replace(of_page, height=height, large=True)
        self._drawings: dict[str, Drawing] = {}
        self._titles: tuple[str, str] = ("", "")
        self._summary: plot_file.Summary | None = None
        with self._modal:
            client.gui.add_html(_head(plot, titles))
            self._numbers = client.gui.add_html("")
            self.charts = tuple(add_chart(client, self._of_run(plot, run), style, set()) for run in RUNS)

    def _of_run(self, plot: Plot, run: str) -> Plot:
        """The plot of one run, which shows what `draw` has computed for this run."""
        return replace(
            plot,
            name=f"{plot.name}-{run.lower()}",
            title=f"{run} · {plot.title}",
            draw=lambda _: self._drawings[run],
            inputs=None,
            pinned_curves=(),
        )

    def draw(self, picture: Picture, comparison: Comparison) -> None:
        """Show the pinned run and a picture; without a pinned run, say so."""
        a = comparison.pinned
        if a is not None:
            a = a.judged_on(len(picture.analysis.windows.start))
        self._summary = None if a is None else _summary(a, picture)
        self._numbers.content = _numbers(self._summary)
        for chart in self.charts:
            chart.header.visible = chart.handle.visible = a is not None
        if a is None:
            return
        self._titles = side_by_side.title(a, picture), side_by_side.title(picture, a)
        self._drawings = dict(zip(RUNS, on_same_axes(self.plot, a, picture), strict=True))
        for chart in self.charts:
            chart.forget()
            chart.draw(picture, NOTHING)

    def panels(self) -> tuple[plot_file.Panel, ...]:
        """Both plots as they are shown, for a file. Raises ValueError with one sentence if no run is pinned."""
        if not self._drawings:
            raise ValueError(NO_RUN)
        shown = zip(self.charts, self._drawings.values(), self._titles, strict=True)
        return tuple(_panel(chart, drawing, title) for chart, drawing, title in shown)

    def summary(self) -> plot_file.Summary:
        """The numbers above the plots as they are shown, for a file; `panels` comes before."""
        assert self._summary is not None, "panels comes before summary"
        return self._summary

    def close(self) -> None:
        """Remove it from the page."""
        self._modal.close()


def on_same_axes(plot: Plot, a: Picture, b: Picture) -> tuple[Drawing, Drawing]:
    """The plot of both runs at the times of B, on an axis that holds both."""
    first, second = plot.draw(a), plot.draw(b)
    time = second.time
    values, drawn = (comparison_curves.sampled_at(first.time, one, time) for one in (first.values, first.drawn))
    axis = min(first.axis[0], second.axis[0]), max(first.axis[1], second.axis[1])
    moved = replace(first, time=time, values=values, drawn=drawn)
    first_drawn, second_drawn = (
        comparison_curves.onto_axis(one.values, one.drawn, one.axis, axis) if plot.log else one.drawn
        for one in (moved, second)
    )
    return replace(moved, drawn=first_drawn, axis=axis), replace(second, drawn=second_drawn, axis=axis)


def _panel(chart: Chart, drawing: Drawing, title: str) -> plot_file.Panel:
    not_drawn = chart.not_drawn(drawing)
    columns = tuple(i for i in range(len(chart.plot.curves)) if i not in not_drawn)
    named = replace(chart.plot, title=f"{chart.plot.title} · {title}")
    return plot_file.Panel(named, drawing, columns, chart.duration)


def _head(plot: Plot, titles: dict[str, str]) -> str:
    names = OFFERED if plot.name in OFFERED else (*OFFERED, plot.name)
    others = "".join(
        OTHER_PLOT.format(f"beside-{name}", str(name == plot.name).lower(), titles[name]) for name in names
    )
    one, close = BUTTON.format(f"expand-{plot.name}", "A and B in one plot"), BUTTON.format("close-large", "✕ close")
    saves = save_buttons(f"{plot.name}-beside", FORMATS)
    return f'<div class="rn-large rn-beside">{others}<span></span>{one}{saves}{close}</div>'


def _summary(a: Picture, b: Picture) -> plot_file.Summary:
    """The heads and figures of both runs, and the settings that differ."""
    heads = f"A · {side_by_side.title(a, b)}", f"B · {side_by_side.title(b, a)}"
    chosen = differences.chosen(a, b)
    sentence = f"Settings that differ (A → B): {'; '.join(chosen)}." if chosen else "A and B have the same settings."
    return plot_file.Summary(heads, side_by_side.rows(a, b), sentence)


def _numbers(summary: plot_file.Summary | None) -> str:
    """The table of figures, and the settings that differ."""
    if summary is None:
        return f'<div class="rn-numbers">{NO_RUN}</div>'
    lines = _line("th", ("", *summary.heads)) + "".join(_line("td", row) for row in summary.rows)
    return f'<div class="rn-numbers"><table>{lines}</table><p>{escaped(summary.sentence)}</p></div>'


def _line(tag: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{tag}>{escaped(cell)}</{tag}>" for cell in cells) + "</tr>"
