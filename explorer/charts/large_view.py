"""The large view of one plot: it fills most of the window, with title, legend, units, hover and export."""

import html

from viser import ClientHandle
from viser._gui_handles import GuiModalHandle

from explorer.charts.chart import Chart, ChartStyle, add_chart
from explorer.charts.plots import Plot

SHARE, MIN_HEIGHT = 0.62, 180
"""The plot's share of the window's height, and its least height (px)."""
FORMATS = ("svg", "png", "pdf", "csv")
BUTTON = '<button type="button" class="rn-button" data-rn-event="{}">{}</button>'


class LargeView:
    """A window over the page with one plot."""

    def __init__(self, client: ClientHandle, plot: Plot, window_height: float, switched_off: set[int], *, big: bool):
        self._modal: GuiModalHandle = client.gui.add_modal(plot.title)
        style = ChartStyle(height=max(round(SHARE * window_height), MIN_HEIGHT), big=big, large=True)
        with self._modal:
            saves = "".join(BUTTON.format(f"save-{plot.name}-{kind}", f"{kind.upper()}") for kind in FORMATS)
            close = BUTTON.format("close-large", "✕ close")
            client.gui.add_html(f'<div class="rn-large">save as {saves}<span></span>{close}</div>')
            self.chart: Chart = add_chart(client, plot, style, set(switched_off))
            name = html.escape(f"{plot.x_name} (s)")
            client.gui.add_html(f'<div class="rn-axis-name">{name}</div>')

    def close(self) -> None:
        """Remove it from the page."""
        self._modal.close()
