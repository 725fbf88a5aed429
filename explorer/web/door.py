"""What the browser alone knows: the size of its window, and which buttons of the page's own HTML were pressed.

viser 1.1.1 reports none of it. A script in the page (page.js) writes it into a hidden text box, as if it were typed
there, and brings the style sheet (page.css) along. The text is a query string:

    width=1366&height=768&flags=dark+unfolded&switched=sphere&plots=snap&tabs=motion&query=preset%3Dhover
    &event=1712345678901:repair&link=eNp…&arrival=1    (the link is the text after #s= in the address)

A browser may write anything: what does not have this form is ignored.
"""

import json
import re
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import parse_qs

import viser

from explorer.model import palette
from explorer.web.connection import run_script

LABEL = "page"
MAX_LENGTH, MAX_EVENTS = 16_000, 64
"""Characters of a report, and events stored while the session is busy; beyond that the oldest are dropped."""
SIZE, ARRIVAL, EVENT, NAME, LINK = (
    re.compile(r"[1-9]\d{1,4}"),
    re.compile(r"\d{1,6}", re.ASCII),
    re.compile(r"(\d{1,16}):([a-z][\w-]{0,60})"),
    re.compile(r"[a-z-]{1,30}"),
    re.compile(r"[\w-]{1,15000}", re.ASCII),
)
FOLDER = Path(__file__).parent
COLORS = (
    f":root {{ --rn-dimmed: {palette.SECONDARY_TEXT}; --rn-map-line: {palette.MAP_LINE}; "
    f"--rn-map-edge: {palette.MAP_EDGE}; --rn-map-notice: {palette.WARNING}; }}\n"
)
"""The colours of the style sheet that the browser's theme lacks: viser's own grey of labels is too pale to be read."""
MARK = '<span class="rn-door"></span>'


@dataclass(frozen=True, kw_only=True)
class Window:
    """What the browser has reported."""

    width: int = 1366
    """CSS px."""
    height: int = 768
    """CSS px."""
    flags: frozenset[str] = field(default=frozenset())
    """dark, big, unfolded, welcomed, …: what the visitor, the system or the address has chosen."""
    switched: frozenset[str] = field(default=frozenset())
    """Layers of the scene that the visitor has switched, off or on."""
    plots: frozenset[str] | None = None
    """The names of the plots in sight; None if the browser has not said which."""
    tabs: frozenset[str] | None = None
    """The open tabs by their labels, as "in-depth"; None if the browser has not said which."""
    query: str = ""
    """What follows the question mark in the address."""
    link: str = ""
    """The text of a link, from the fragment of the address."""
    arrival: int = 0
    """Which link this is since the page was loaded: the same one may be opened twice."""
    hidden: bool = False
    """Whether the browser shows another tab, or its window is minimised."""
    answered: bool = False
    """Whether what the address asks for was opened, or refused, before this connection began."""


class Door:
    """The hidden box of one visitor."""

    def __init__(
        self, client: viser.ClientHandle, wake: Callable[[], None], *, welcome: bool = True, style: str = ""
    ) -> None:
        """`wake` is called from viser's threads when something was reported. `welcome`: whether a new visitor is
        welcomed with a card. `style`: rules (CSS) that follow those of page.css."""
        self._client, self._wake, self._lock = client, wake, threading.Lock()
        self._window: Window | None = None
        self._events: deque[str] = deque(maxlen=MAX_EVENTS)
        self._last = 0
        client.gui.add_html(MARK)
        self._box = client.gui.add_text(LABEL, "")
        self._box.on_update(lambda _: self.receive(self._box.value))
        run_script(client, script(welcome=welcome, style=style))

    @property
    def window(self) -> Window | None:
        """What was reported last; None before the first report."""
        return self._window

    def take_events(self) -> list[str]:
        """The names of the buttons that were pressed since the last call, the oldest first."""
        with self._lock:
            events = list(self._events)
            self._events.clear()
        return events

    def switch(self, flag: str) -> None:
        """Switch a flag in the browser, as its button does."""
        run_script(self._client, f"window.rnPage.act('flag', {json.dumps(flag)})")

    def receive(self, text: str) -> None:
        """Store what the script has written; any other text is ignored."""
        said = parse_qs(text[:MAX_LENGTH])
        width, height = (said.get(name, [""])[0] for name in ("width", "height"))
        if not (SIZE.fullmatch(width) and SIZE.fullmatch(height)):
            return
        with self._lock:
            self._window = Window(
                width=int(width),
                height=int(height),
                flags=_names(said.get("flags", [""])[0]),
                switched=_names(said.get("switched", [""])[0]),
                plots=_names(said["plots"][0]) if "plots" in said else None,
                tabs=_names(said["tabs"][0]) if "tabs" in said else None,
                query=said.get("query", [""])[0],
                link=link if LINK.fullmatch(link := said.get("link", [""])[0]) else "",
                arrival=int(number) if ARRIVAL.fullmatch(number := said.get("arrival", [""])[0]) else 0,
                hidden="hidden" in said,
                answered="answered" in said,
            )
            for event in said.get("event", []):
                match = EVENT.fullmatch(event)
                if match is not None and int(match[1]) > self._last:
                    self._last = int(match[1])
                    self._events.append(match[2])
        self._wake()


def copy_link(client: viser.ClientHandle, fragment: str) -> None:
    """Copy the page's address with a fragment."""
    run_script(client, f"window.rnPage.copyLink({json.dumps(fragment)})")


def mark_answered(client: viser.ClientHandle) -> None:
    """Have the browser remember that what its address asks for was opened or refused."""
    run_script(client, "window.rnPage.markAnswered()")


def script(*, welcome: bool, style: str = "") -> str:
    """The script that the browser runs, with the style sheet in it: page.css, and then `style`."""
    sheet = COLORS + (FOLDER / "page.css").read_text(encoding="utf-8") + style
    return (
        (FOLDER / "page.js")
        .read_text(encoding="utf-8")
        .replace("STYLE_SHEET", json.dumps(sheet))
        .replace("SKIP_WELCOME", json.dumps(not welcome))
    )


def _names(text: str) -> frozenset[str]:
    return frozenset(name for name in text.split() if NAME.fullmatch(name))
