"""What follows from the visitor's window: the widths of the docks, the sizes of the plots, which plots and tabs are in
sight, dark or light, big type, and the layers of the scene that are shown. The page follows while it changes."""

from dataclasses import replace

import viser

from explorer.charts import Charts
from explorer.charts.plot_size import plot_size
from explorer.model import layers
from explorer.panels import dock_tabs
from explorer.panels.dock import Dock
from explorer.scene import Scene
from explorer.session.display import Display
from explorer.web.door import Window

WIDE = 1200
"""px: from this width of the window on, the dock of controls has its full width."""
NARROW_SHARE, BIG_SHARE = 0.84, 1.37
"""The dock's width in a narrower window, and with big type, by its full width."""
CLASS_SHARE = 1.12
"""The same in a class, whose dock has a tab more: all tabs stay in one row."""


AROUND_SCENE = 140
"""px of the window's height that the verdict and the timeline take from the scene (page.css)."""


ANSWERING = frozenset({"blind", "twin", "sphere", "excitation", "uncertainty"})
"""Layers of the scene that answer a lesson's question: they are shown once its prediction is committed."""


class Appearance:
    """The look of one visitor's page."""

    def __init__(
        self,
        client: viser.ClientHandle,
        controls: Dock,
        charts: Charts,
        scene: Scene,
        display: Display,
        *,
        in_class: bool = False,
    ) -> None:
        """in_class: whether the dock has the tab of a class."""
        self._client, self._controls, self._charts = client, controls, charts
        self._scene, self._display = scene, display
        self._window: Window | None = None
        self._veiled: frozenset[str] = frozenset()
        self._in_class = in_class
        self._dark, self._controls_width = False, dock_tabs.WIDTH

    def follow(self, window: Window | None, *, guest: bool = False) -> None:
        """Take what the browser has reported last. guest: whether the page shows somebody else's work, which keeps
        nothing back from a lesson."""
        if window is None:
            return
        with self._client.atomic():
            self._charts.see(window.plots)
            self._controls.see(window.tabs)
            self._controls.verdict.fold("unfolded" not in window.flags)
        looks = replace(window, plots=None, tabs=None, hidden=False)
        veiled = ANSWERING if self._controls.learn.keeps_answer and not guest else frozenset()
        if (looks, veiled) == (self._window, self._veiled):
            return
        self._window, self._veiled = looks, veiled
        big = "big" in window.flags
        if self._dark != ("dark" in window.flags):
            self._dark = not self._dark
            set_theme(self._client, dark=self._dark)
        width = controls_width(window.width, big=big, in_class=self._in_class)
        if width != self._controls_width:
            self._controls_width = width
            self._client.gui.main_panel.set_width(width)
        height = max(window.height - AROUND_SCENE * (1.4 if big else 1.0), 100.0)
        self._scene.appear(hidden=layers.hidden(window.switched) | veiled, big=big, dark=self._dark, height=height)
        if self._charts.resize(plot_size(window.width, window.height, big=big, dark=self._dark)):
            self._display.redraw()


def set_theme(client: viser.ClientHandle, *, dark: bool) -> None:
    """Dark or light, without viser's own logo and button."""
    client.gui.configure_theme(show_logo=False, show_share_button=False, dark_mode=dark)


def controls_width(width: float, *, big: bool, in_class: bool = False) -> int:
    """px of the dock of controls in a window of this width (CSS px); in a class it has a tab more."""
    full = dock_tabs.WIDTH * (CLASS_SHARE if in_class else 1.0)
    if width < WIDE:
        return round(NARROW_SHARE * full)
    return round(BIG_SHARE * full) if big else round(full)
