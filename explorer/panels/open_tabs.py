"""What is drawn in the tabs that are open: a closed tab is drawn when it is opened, with the newest picture."""

from collections.abc import Callable, Mapping

from explorer.model.compute import Picture


class OpenTabs:
    """The tabs whose panels take a while to draw, and the picture that each closed one is to show."""

    def __init__(self, panels: Mapping[str, tuple[Callable[[Picture], None], ...]]) -> None:
        """panels: what draws the panels of a tab, by the tab's name."""
        self._panels = panels
        self._open: frozenset[str] | None = None
        self._behind: dict[str, Picture] = {}
        """The newest picture of each tab that shows an earlier one."""

    def draw(self, picture: Picture) -> None:
        """Show a picture in the open tabs now, and in the others when they are opened."""
        self._behind = dict.fromkeys(self._panels, picture)
        self._draw_open()

    def see(self, tabs: frozenset[str] | None) -> None:
        """Draw in these tabs alone from now on, in newly opened ones at once; None for all tabs."""
        self._open = tabs
        self._draw_open()

    def _draw_open(self) -> None:
        for tab in [tab for tab in self._behind if self._open is None or tab in self._open]:
            picture = self._behind.pop(tab)
            for draw in self._panels[tab]:
                draw(picture)
