"""What the page's address asks for, and the link to what the page shows.

    …/?preset=hover    …/?lesson=4      once, when the page is opened
    …/?#s=…            settings in the fragment, which no browser sends to a server: see `explorer.model.share`
What is opened is a step of its own: undo brings back what was there before.
"""

from collections.abc import Callable
from urllib.parse import parse_qs

import viser

from explorer.model import share
from explorer.panels import saved_page
from explorer.panels.dock import Dock
from explorer.storage.catalog import Catalog
from explorer.web import door
from explorer.web.door import Window

MAX_NAME = 60
"""Characters of an address that a sentence repeats."""


class Address:
    """The address of one visitor's page."""

    def __init__(
        self,
        client: viser.ClientHandle,
        dock: Dock,
        catalog: Catalog,
        notify: Callable[[str, str], None],
        *,
        lesson: str,
    ) -> None:
        """`lesson`: the number of the lesson that the program was started with, or empty."""
        self._client, self._dock, self._catalog, self._notify = client, dock, catalog, notify
        self._lesson, self._read, self._link = lesson, False, ""

    def follow(self, window: Window | None) -> None:
        """Open what the address asks for: preset and lesson once, and each other link as soon as it stands there."""
        if window is None:
            return
        if not self._read:
            self._read = True
            self._open_named(window.query)
        if window.link and window.link != self._link:
            self._link = window.link
            self._open_link(window.link)

    def copy_link(self) -> None:
        """Copy a link to what the page shows. Raises InvalidInputError if that is no valid input."""
        try:
            text = share.link_text(self._dock.read())
        except ValueError as error:
            self._notify("No link", f"{error}.")
            return
        self._link = text
        door.copy_link(self._client, f"#{share.KEY}={text}")
        self._notify("Link copied", "It opens what you see now, on any page of this program.")

    def _open_named(self, query: str) -> None:
        asked = parse_qs(query)
        (name,), (number,) = asked.get("preset", [""])[-1:], asked.get("lesson", [self._lesson])[-1:]
        if name in self._catalog.presets:
            if name != self._dock.origin:
                self._dock.presets.open(name)
        elif name:
            self._notify("No such preset", f"There is no preset “{name[:MAX_NAME]}”; the Presets tab lists all.")
        learn = self._dock.learn
        if number.isdecimal() and int(number[:4]) in learn.titles:
            if learn.lesson is None or learn.lesson.number != int(number[:4]):  # a reload goes on where it was
                learn.open_number(int(number[:4]))
        elif number:
            self._notify("No such lesson", f"There is no lesson “{number[:MAX_NAME]}”; the Learn tab lists all.")

    def _open_link(self, text: str) -> None:
        try:
            (settings,) = saved_page.with_presets([share.from_link(text)], self._catalog)
        except ValueError as reason:
            self._notify("The link was not opened", str(reason))
            return
        if settings != self._dock.read():
            self._dock.write(settings)
            self._notify("A link was opened", "Ctrl+Z brings back what was here before.")
