"""How the panels of plots fit into a window: one panel or two, their width, the height of a plot, folded or not."""

from dataclasses import dataclass, field

from explorer.charts.chart import ChartStyle

WIDTH = 360
"""px of a single panel. viser opens each of two at a width of its own, 303 px."""
TWO_PANELS = 1570
"""px: a wider window has room for two panels."""
FOLDED, BIG_FOLDED = 1000, 1600
"""px, and with big type: in a narrower window the panel of plots is folded to a bar, which a click unfolds."""
USUAL_HEIGHT, OF_WINDOW, GROWTH = 102, 768, 0.19
"""px: four plots of this height fill a panel in a window of that height; and by how much each grows with it."""
MIN_HEIGHT, MAX_HEIGHT = 90, 320
"""px of a plot."""


@dataclass(frozen=True, kw_only=True)
class PlotSize:
    """How the panels of plots fit into a window."""

    two_panels: bool = False
    folded: bool = False
    width: int = WIDTH
    """px of a single panel."""
    style: ChartStyle = field(default_factory=ChartStyle)
    window_height: float = OF_WINDOW
    """px"""


def plot_size(width: float, height: float, *, big: bool = False, dark: bool = False) -> PlotSize:
    """For a window of this width and height (CSS px), for `big` type and for a `dark` page."""
    two_panels = width >= TWO_PANELS and not big
    plot_height = min(max(USUAL_HEIGHT + GROWTH * (height - OF_WINDOW), MIN_HEIGHT), MAX_HEIGHT)
    plot_height = round(1.4 * plot_height if big else plot_height)
    panel_width = WIDTH if width >= 1200 else round(0.8 * WIDTH)
    return PlotSize(
        two_panels=two_panels,
        folded=width < (BIG_FOLDED if big else FOLDED),
        width=round(1.25 * WIDTH) if big and width >= 1200 else panel_width,
        style=ChartStyle(height=plot_height, big=big, dark=dark),
        window_height=height,
    )
