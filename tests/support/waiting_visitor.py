"""A visitor without a browser who waits: whatever is set, pressed or dragged is taken in before the next.

The fixtures `sessions` and `editing` of tests/conftest.py give a server of a module's own, and a visitor of a test's.
"""

import re
from collections.abc import Callable

from explorer.model.settings import Settings
from explorer.server import SessionServer
from explorer.session import Session
from tests.support.wire import Wire


class Editing:
    """A visitor, and the session that serves them."""

    def __init__(self, tab: Wire, session: Session) -> None:
        self.tab, self.session = tab, session
        self._moment = 0.0

    @property
    def settings(self) -> Settings:
        """What is shown."""
        picture = self.session.picture
        assert picture is not None
        return picture.settings

    def set(self, label: str, value: object) -> None:
        """Set a control, and wait until the session has taken it in."""
        self.tab.set(label, value)
        self.settle()

    def press(self, label: str, option: str | None = None) -> None:
        """Press a button, or one of a row of buttons."""
        self._carried_out(lambda: self.tab.press(label, option))

    def command(self, label: str) -> None:
        """Trigger a command of the palette."""
        self._carried_out(lambda: self.tab.command(label))

    def drag(self, handle: str, place: tuple[float, float, float], *, steps: int = 1) -> None:
        """Drag a handle, once it is there."""
        self.tab.wait_for(lambda: handle in self.tab.nodes, handle)
        self.tab.drag(handle, place, steps=steps)

    def _carried_out(self, ask: Callable[[], None]) -> None:
        """Ask for something, and wait until it was done: presses go through a pool of threads, and may be overtaken."""
        form = self.session.form
        before = form.actions_run
        ask()
        self.tab.wait_for(lambda: form.actions_run > before, "the action")
        self.settle()

    def settle(self) -> None:
        """Until the session has taken in all that was sent: it shows a moment only after what came before."""
        self._moment = round((self._moment + 0.01) % 9.0, 2)
        self.tab.set("t (s)", self._moment)
        self.tab.wait_for_text(f"<b>{self._moment:.2f} s</b>")

    def wait_until_accepted(self) -> None:
        """Until nothing is complained of: what is shown beside a control may come a moment after the rest."""
        self.tab.wait_for(lambda: self.refusals() == [], "no complaint")

    def refusals(self) -> list[str]:
        """The sentences shown beside controls and in the verdict, without their HTML."""
        shown = [p for p in self.tab.elements.values() if p.get("visible", True) and "⚠" in str(p.get("content"))]
        return [re.sub(r"<[^>]+>", " ", p["content"]) for p in shown]


def newest(made: SessionServer, tab: Wire) -> Session:
    """The session of a tab that has just connected, once it has drawn."""
    tab.wait_for_text("of 13</b>, nonlinear")
    return made.sessions[-1]
