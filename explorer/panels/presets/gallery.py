"""All presets at a glance: a tile for each with its path and the shape of its badge; a click on it opens the preset.

viser has no picture that can be clicked. So every tile has a hidden button in a row of its own, and a click on the
tile presses the button. Nothing is sent to the browser before the gallery is shown.
"""

import html
from collections.abc import Callable
from functools import lru_cache, partial

import numpy as np

from explorer.panels.presets.card import DIMMED, badge, picture
from explorer.storage.catalog import Catalog, marked
from explorer.web.in_order import in_order
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.preset import Preset

SIDE, POINTS = 70, 120
"""px of a drawing, of which four fit in a row of the dock; and the number of points along it."""
MAX_TILES = 60
"""More tiles would make the page slow; the menu has all presets."""
CACHED_DRAWINGS = 2 * MAX_TILES
FROM_A_CORNER = np.array([(0.82, -0.57), (0.40, 0.57), (0.0, 0.82)])
"""From this direction no two shipped paths look alike; from the top, a circle and a tilted one do."""
HIDE_BUTTONS = ':has(> * > * > label[for="{}"]){{display:none}}'
"""Hides the row of buttons. If viser builds its rows in another way, the buttons are visible and still work."""
PRESS_BUTTON = (
    "let row = document.querySelector('label[for=&quot;{}&quot;]'); while (row && !row.querySelector('button'))"
    " row = row.parentElement; row?.querySelectorAll('button')[{}]?.click()"
)
TILE = (
    '<button class="tile" onclick="{press}" title="{title}" style="all:unset;cursor:pointer;width:{side}px;'
    'font-size:max(0.72em, var(--rn-least, 0px));line-height:1.25;text-align:center;overflow-wrap:anywhere">{drawing}'
    '<div style="font-weight:{weight}"><span style="color:{colour}">{shape}</span> {name}</div></button>'
)
TILES = (
    '<div class="tiles" style="display:flex;flex-wrap:wrap;gap:0.6em 0.7em;align-items:flex-start;padding:0.3em 0.9em">'
    "{}</div><style>{}</style>"
    f'<div style="{DIMMED};font-size:max(0.75em, var(--rn-least, 0px));padding:0.2em 1.1em 0.6em">'
    "● certified observable, ▲ weak, ✕ unobservable; ◌ not certified, or not yet{}</div>"
)
OPEN_HINT = "The same as a click on its picture. Ctrl+Z brings back what was on the page."


class Gallery:
    """Tiles of the presets, shown and hidden by a button."""

    def __init__(self, form: Form, catalog: Catalog, open_preset: Callable[[str], None]) -> None:
        self._form, self._catalog, self._open = form, catalog, open_preset
        self._visible = False
        self._labels: tuple[str, ...] = ("",)
        with Section(form):
            self._tiles = form.gui.add_html("", visible=False)
            self._row = form.gui.add_button_group("open", self._labels, hint=OPEN_HINT, visible=False)
        self._row.on_click(in_order(lambda event: form.do(partial(self._open_labelled, event.target.value))))

    def toggle(self, open_name: str) -> None:
        """Show or hide it."""
        self._visible = not self._visible
        self.draw(open_name)
        self._tiles.visible = self._row.visible = self._visible

    def draw(self, open_name: str) -> None:
        """Update the tiles, if they are visible."""
        if not self._visible:
            return
        names = list(self._offered)
        labels = tuple(marked(name) for name in names)
        if labels != self._labels:
            self._labels = self._row.options = labels
        left_out = len(self._catalog.labels(open_name)) - len(names)
        more = f". {left_out} more are in the menu" if left_out > 0 else ""
        offered = enumerate(self._offered.items())
        tiles = "".join(self._tile(k, name, preset, name == open_name) for k, (name, preset) in offered)
        content = TILES.format(tiles, HIDE_BUTTONS.format(self._row._impl.uuid), more)
        if content != self._tiles.content:
            self._tiles.content = content

    @property
    def _offered(self) -> dict[str, Preset]:
        return dict(list(self._catalog.offered.items())[:MAX_TILES])

    def _tile(self, number: int, name: str, preset: Preset, open_name: bool) -> str:
        shape, colour, text = badge(preset, self._catalog.badge(name, preset, self._form.wake))
        return TILE.format(
            press=PRESS_BUTTON.format(self._row._impl.uuid, number),
            title=html.escape(f"{preset.title}: {text.lower()}"),
            side=SIDE,
            drawing=_drawing(preset),
            weight=700 if open_name else 400,
            colour=colour,
            shape=shape,
            name=html.escape(marked(name)),
        )

    def _open_labelled(self, label: str) -> None:
        for name in self._offered:
            if marked(name) == label:
                self._open(name)
                return


@lru_cache(maxsize=CACHED_DRAWINGS)
def _drawing(open_name: Preset) -> str:
    return picture(open_name, FROM_A_CORNER, SIDE, POINTS, "the path, seen from a corner")
