"""What the page's address asks for, and the link to what the page shows.

    …/?preset=hover    …/?lesson=4      once, when the page is opened
    …/?#s=…            settings in the fragment, which no browser sends to a server: see `explorer.model.share`
What is opened is a step of its own: undo brings back what was there before. Where it would replace work that is not
saved, a question over the scene comes first. The browser remembers that a link was answered, so that no reload asks
again.
"""

import html
from collections.abc import Callable
from urllib.parse import parse_qs

import viser

from explorer.model import share
from explorer.model.settings import Settings
from explorer.panels import saved_page
from explorer.panels.dock import Dock
from explorer.storage.catalog import Catalog
from explorer.web import door
from explorer.web.door import Window
from explorer.widgets.form import Action

MAX_NAME = 60
"""Characters of an address that a sentence repeats."""
UNDO = "What is here now is not saved as a preset; Ctrl+Z brings it back."
LEAVING = "What is here now comes back when you leave the lesson."
QUESTION = (
    '<div class="rn-progress rn-question" role="alertdialog" aria-label="A link"><span>{}</span>'
    '<button type="button" class="rn-button rn-main" data-rn-event="link-open">Open it</button>'
    '<button type="button" class="rn-button" data-rn-event="link-stay">Stay here</button></div>'
)


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
        record: Callable[[Settings], None],
    ) -> None:
        """`lesson`: the number of the lesson that the program was started with, or empty. `record` makes settings a
        step that undo goes back to."""
        self._client, self._dock, self._catalog, self._notify = client, dock, catalog, notify
        self._lesson, self._record, self._read, self._followed = lesson, record, False, ("", 0)
        self._offered: Action | None = None
        """What the question on the page would open; None while there is no question."""
        self._question = client.gui.add_html("", visible=False)

    @property
    def actions(self) -> dict[str, Action]:
        """What the buttons do, by the names that they send."""
        return {"link": self.copy_link, "link-open": self._open_offered, "link-stay": self._answer}

    @property
    def question(self) -> str:
        """The question on the page, as HTML; empty while there is none."""
        return self._question.content if self._question.visible else ""

    def follow(self, window: Window | None) -> None:
        """Open what the address asks for: preset and lesson once, and each other link as soon as it stands there."""
        if window is None:
            return
        if not self._read:
            self._read = True
            if not window.answered:
                self._open_named(window.query)
        if window.link and (window.link, window.arrival) != self._followed:
            self._followed = window.link, window.arrival
            self._open_link(window.link)

    def copy_link(self) -> None:
        """Copy a link to what the page shows. Raises InvalidInputError if that is no valid input."""
        try:
            text = share.link_text(self._dock.read())
        except ValueError as error:
            self._notify("No link", f"{error}.")
            return
        door.copy_link(self._client, f"#{share.KEY}={text}")
        self._notify("Link copied", "It opens what you see now, on any page of this program.")

    def _open_named(self, query: str) -> None:
        asked = parse_qs(query)
        (name,), (number,) = asked.get("preset", [""])[-1:], asked.get("lesson", [self._lesson])[-1:]
        learn, lesson = self._dock.learn, int(number[:4]) if number.isdecimal() else None
        if name and name not in self._catalog.presets:
            self._notify("No such preset", f"There is no preset “{name[:MAX_NAME]}”; the Presets tab lists all.")
            name = ""
        if number and lesson not in learn.titles:
            self._notify("No such lesson", f"There is no lesson “{number[:MAX_NAME]}”; the Learn tab lists all.")
            lesson = None
        if learn.lesson is not None and learn.lesson.number == lesson:
            lesson = None  # the page goes on where it was
        if name == self._dock.origin and learn.lesson is None:
            name = ""
        what = [f"the preset “{name}”"] if name else []
        what += [f"lesson {lesson}, {learn.titles[lesson]}"] if lesson is not None else []
        if what:
            after = UNDO if name else LEAVING
            self._offer(f"Open {' and '.join(what)}? {after}", lambda: self._show_named(name, lesson))

    def _show_named(self, name: str, lesson: int | None) -> None:
        if name:
            self._leave_lesson()
            self._dock.presets.open(name)
        if lesson is not None:
            self._dock.learn.open_number(lesson)

    def _open_link(self, text: str) -> None:
        try:
            settings = share.from_link(text)
        except ValueError as reason:
            self._notify("The link was not opened", str(reason))
            return
        if not self._shows(settings):
            self._offer(f"Open the shared state of “{settings.preset.title}”? {UNDO}", lambda: self._show(settings))

    def _show(self, settings: Settings) -> None:
        self._leave_lesson()
        (known,) = saved_page.with_presets([settings], self._catalog)
        self._dock.write(known)
        self._notify("A link was opened", "Ctrl+Z brings back what was here before.")

    def _leave_lesson(self) -> None:
        """Give back the work from before the lesson, as a step that undo goes back to."""
        if self._dock.learn.lesson is not None:
            self._dock.learn.leave()
            self._record(self._dock.read())

    def _offer(self, question: str, action: Action) -> None:
        """Ask if work would be lost; else do it at once."""
        if self._has_unsaved_work():
            self._offered = action
            self._question.content, self._question.visible = QUESTION.format(html.escape(question)), True
        else:
            self._answer()
            action()

    def _open_offered(self) -> None:
        action = self._offered
        self._answer()
        if action is not None:
            action()

    def _answer(self) -> None:
        """The question is answered, also for a reload of the page."""
        self._offered, self._question.visible = None, False
        door.mark_answered(self._client)

    def _shows(self, settings: Settings) -> bool:
        try:
            return self._dock.learn.lesson is None and settings == self._dock.read()
        except ValueError:
            return False

    def _has_unsaved_work(self) -> bool:
        """Whether a preset was changed and not saved, or a task of a lesson was begun; also what is no valid input."""
        learn = self._dock.learn
        try:
            shown = self._dock.read()
        except ValueError:
            return True
        if learn.lesson is None:
            return self._catalog.has_changed(shown)
        before = learn.learning.before
        begun = shown != learn.lesson.start.settings
        return begun or (before is not None and self._catalog.has_changed(before))
