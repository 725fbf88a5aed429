"""The window over the page: one plot large, or the pinned run and the run on the page side by side; or no window."""

from viser import ClientHandle

from explorer.charts.chart import Chart
from explorer.charts.large_view import LargeView
from explorer.charts.plot_size import PlotSize
from explorer.charts.plots import Plot
from explorer.charts.side_by_side import SideBySide
from explorer.model.comparison import Comparison
from explorer.model.compute import Picture


class OverPage:
    """At most one window lies over the page of a visitor."""

    def __init__(self, client: ClientHandle) -> None:
        self._client = client
        self._window: LargeView | SideBySide | None = None

    @property
    def plot(self) -> Plot | None:
        """The plot that the window shows; None without a window."""
        return None if self._window is None else self._window.plot

    @property
    def side_by_side(self) -> SideBySide | None:
        """The window if it shows two runs side by side."""
        return self._window if isinstance(self._window, SideBySide) else None

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts in the window."""
        return () if self._window is None else self._window.charts

    def enlarge(self, plot: Plot, size: PlotSize, switched_off: set[int], *, pinned: bool) -> None:
        """Open a plot large. pinned: whether a run is pinned, to be seen side by side."""
        self.close()
        self._window = LargeView(self._client, plot, size.window_height, switched_off, size.style, pinned=pinned)

    def open_side_by_side(self, plot: Plot, titles: dict[str, str], size: PlotSize) -> None:
        """Open a plot of two runs side by side; `titles` of all plots by their names."""
        self.close()
        self._window = SideBySide(self._client, plot, titles, size.window_height, size.style)

    def draw(self, picture: Picture, comparison: Comparison) -> None:
        """Show a picture and what it is compared with, if there is a window."""
        if self._window is not None:
            self._window.draw(picture, comparison)

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None
