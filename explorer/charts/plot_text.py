"""What each plot shows, in sentences: name, axes, their ranges, and from where to where each curve goes."""

import html
from collections.abc import Iterator, Sequence

import numpy as np
from viser import ClientHandle

from explorer.charts import cursor_values, markup
from explorer.charts.chart import Chart
from explorer.charts.plots import Drawing, Plot
from rangenav.number_format import significant

MOST_CURVES = 8
"""Curves that are described one by one; of more, the others are counted."""


def text(plot: Plot, drawing: Drawing, duration: float, not_drawn: Sequence[int] = ()) -> str:
    """The sentences of one plot. duration: the length of its horizontal axis (s); not_drawn: columns."""
    low, high = (significant(end) for end in drawing.axis)
    kind = "logarithmic " if plot.log else ""
    axes = f"{plot.title} ({plot.unit}) over {plot.x_name} from 0 to {significant(duration, 4)} s; "
    axes += f"{kind}axis from {low} to {high}."
    empty = plot.reason_if_empty(drawing)
    curves = [_curve(plot, drawing, column) for column in plot.in_legend if column not in not_drawn]
    more = len(curves) - MOST_CURVES
    rest = (f"And {more} more curves.",) if more > 0 else ()
    return " ".join((axes, *((empty,) if empty else ()), *curves[:MOST_CURVES], *rest))


def _curve(plot: Plot, drawing: Drawing, column: int) -> str:
    curve, values = plot.curves[column], drawing.values[:, column]
    known = np.flatnonzero(~np.isnan(values))
    if not len(known):
        return f"{curve.label}: no values."
    unit = curve.unit if curve.unit is not None else ""
    first, last = known[0], known[-1]
    return f"{curve.label}: " + ", ".join(_course(values[known], drawing.time[[first, last]], unit)) + "."


def _course(values: np.ndarray, ends: np.ndarray, unit: str) -> Iterator[str]:
    """The least and the greatest value, and that at the end."""
    shown = [cursor_values.legend_text(value) for value in (values.min(), values.max(), values[-1])]
    least, greatest, last = (f"{one} {unit}".strip() if one[-1].isdigit() else one for one in shown)
    if least == greatest:
        yield f"{last} throughout"
        return
    yield f"from {least} to {greatest}"
    yield f"at the end, {significant(float(ends[1]), 4)} s, {last}"


class PlotTexts:
    """The texts of the plots in sight: one element that is not seen, and is read to whoever comes upon a plot."""

    def __init__(self, client: ClientHandle) -> None:
        self._handle = client.gui.add_html("")

    def write(self, charts: Sequence[Chart]) -> None:
        """Describe these plots; of two with one name, the first."""
        texts: dict[str, str] = {}
        for chart in charts:
            drawing = chart.drawing
            if drawing is not None and not chart.outdated:
                texts.setdefault(chart.plot.name, text(chart.plot, drawing, chart.duration, chart.not_drawn(drawing)))
        content = "".join(f'<p id="{markup.text_id(name)}">{html.escape(line)}</p>' for name, line in texts.items())
        content = f'<div class="rn-unseen rn-answer" hidden>{content}</div>'
        if content != self._handle.content:
            self._handle.content = content
