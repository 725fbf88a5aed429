"""The large view of one plot: it fills most of the window, with title, legend, units, hover and export."""

import html
from collections.abc import Sequence
from dataclasses import replace

from viser import ClientHandle
from viser._gui_handles import GuiModalHandle

from explorer.charts.chart import Chart, ChartStyle, add_chart
from explorer.charts.plots import Plot
from explorer.model.comparison import Comparison
from explorer.model.compute import Picture

AROUND, BIG_AROUND, MIN_HEIGHT = 190, 285, 180
"""px of the window's height that the plot leaves to title, legend and buttons, and with big type; its least height."""
FORMATS = ("svg", "png", "pdf", "csv")
BUTTON = '<button type="button" class="rn-button" data-rn-event="{}">{}</button>'


def save_buttons(name: str, formats: Sequence[str]) -> str:
    """One button for each format of a file."""
    buttons = "".join(BUTTON.format(f"save-{name}-{kind}", kind.upper()) for kind in formats)
    return f'<div class="rn-saves">save as {buttons}</div>'


class LargeView:
    """A window over the page with one plot."""

    def __init__(
        self,
        client: ClientHandle,
        plot: Plot,
        window_height: float,
        switched_off: set[int],
        of_page: ChartStyle,
        *,
        pinned: bool = False,
    ):
        """`of_page`: the style of the other plots. `pinned`: whether a run is pinned, to be seen side by side."""
        self.plot = plot
        self._modal: GuiModalHandle = client.gui.add_modal(plot.title)
        height = max(round(window_height) - (BIG_AROUND if of_page.big else AROUND), MIN_HEIGHT)
        style = replace(of_page, height=height, large=True)
        with self._modal:
            saves = save_buttons(plot.name, FORMATS)
            beside = BUTTON.format(f"beside-{plot.name}", "A and B side by side") if pinned else ""
            close = BUTTON.format("close-large", "✕ close")
            client.gui.add_html(f'<div class="rn-large">{saves}{beside}<span></span>{close}</div>')
            self.charts: tuple[Chart, ...] = (add_chart(client, plot, style, set(switched_off)),)
            name = html.escape(f"{plot.x_name} (s)")
            client.gui.add_html(f'<div class="rn-axis-name">{name}</div>')

    def draw(self, picture: Picture, comparison: Comparison) -> None:
        """Show a picture and what it is compared with."""
        self.charts[0].draw(picture, comparison)

    def close(self) -> None:
        """Remove it from the page."""
        self._modal.close()
