"""A visitor without a browser who waits until the session has taken over each change before making the next.

The fixtures `sessions` and `editing` of tests/conftest.py give a module its own server, and a test its own visitor.
"""

import re
from collections.abc import Callable

from explorer.model.settings import Settings
from explorer.server import SessionServer
from explorer.session import Session
from explorer.widgets.vector import AXES, box_label
from tests.support.wire import Storage, Wire


class Editing:
    """A visitor, and the session that serves them."""

    def __init__(self, tab: Wire, session: Session) -> None:
        self.tab, self.session = tab, session
        self._moment = 0.0

    @property
    def settings(self) -> Settings:
        """The settings of the picture on the page."""
        picture = self.session.picture
        assert picture is not None
        return picture.settings

    def set(self, label: str, value: object) -> None:
        """Set a control, and wait until the session has taken it over; of a vector one box after the other, because
        the news of three boxes may overtake each other."""
        if isinstance(value, list | tuple):
            for axis, entry in zip(AXES, value, strict=True):
                self.set(box_label(label, axis), str(entry))
            return
        self.tab.set(label, value)
        self.settle()

    def press(self, label: str, option: str | None = None) -> None:
        """Press a button, or one of a row of buttons."""
        self.run(lambda: self.tab.press(label, option))

    def command(self, label: str) -> None:
        """Trigger a command of the palette."""
        self.run(lambda: self.tab.command(label))

    def drag(self, handle: str, position: tuple[float, float, float], *, steps: int = 1) -> None:
        """Drag a handle, once it exists."""
        self.tab.wait_for(lambda: handle in self.tab.nodes, handle)
        self.tab.drag(handle, position, steps=steps)

    def run(self, trigger: Callable[[], None]) -> None:
        """Trigger an action, and wait until it has run: viser's threads may deliver it after a later change."""
        form = self.session.form
        before = form.actions_run
        trigger()
        self.tab.wait_for(lambda: form.actions_run > before, "the action")
        self.settle()

    def settle(self) -> None:
        """Wait until the session has taken over all changes: it shows a moment of the run only after them."""
        self._moment = round((self._moment + 0.01) % 9.0, 2)
        shown = f"<b>{self._moment:.2f} s</b>"
        self.tab.set("t (s)", self._moment)
        self.tab.wait_for_text(shown)

    def wait_until_accepted(self) -> None:
        """Wait until no complaint is shown; those below controls may disappear a moment after the rest."""
        self.tab.wait_for(lambda: self.refusals() == [], "no complaint")

    def refusals(self) -> list[str]:
        """The complaints below controls and in the verdict, without their HTML."""
        shown = [
            p for p in self.tab.elements.values() if p.get("visible", True) and 'role="alert"' in str(p.get("content"))
        ]
        return [re.sub(r"<[^>]+>", " ", p["content"]) for p in shown]


def newest(server: SessionServer, tab: Wire) -> Session:
    """The session of a tab that has just connected, once it has drawn."""
    tab.wait_for_text("of 13</b>, nonlinear")
    return server.sessions[-1]


def arrived(sessions: tuple[int, SessionServer], storage: Storage | None = None) -> Editing:
    """A new visitor of a server, with the storage of a browser, once the first picture is on the page."""
    port, server = sessions
    tab = Wire(port, storage=storage)
    tab.wait_for(lambda: tab.counts.get("GuiSetPanelWidthMessage"), "the docks")
    session = server.sessions[-1]
    tab.wait_for(lambda: session.picture is not None and "t (s)" in str(tab.elements), "the first picture")
    return Editing(tab, session)


def save_as(page: Editing, title: str) -> None:
    """Save what is on the page as a preset of the library, under a title."""
    page.set("title", title)
    page.press("keep", "save as")
    page.tab.wait_for_text("saved as")


def drawn(tab: Wire) -> str:
    """The verdict block."""
    return next(p["content"] for p in tab.elements.values() if "of 13</b>" in str(p.get("content")))


def proven(tab: Wire) -> str:
    """The verdict block once it rests on all windows: on a busy machine that replaces the sampled one much later."""
    tab.wait_for(lambda: "≈" not in drawn(tab), "the verdict on all windows")
    return drawn(tab)
