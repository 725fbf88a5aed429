"""The class board: who is where in which lesson, what was predicted, and the results as a file."""

import html
from collections.abc import Mapping
from typing import Protocol

import viser

from explorer.model.classroom import Classroom, Member, histogram, results
from explorer.storage.bundle import Send
from explorer.widgets.controls import Choice
from explorer.widgets.form import Form
from explorer.widgets.html import NOTE, table
from explorer.widgets.section import Section

LESSON_HINT = "The lesson whose predictions are shown here, and that is opened on every student's page by the button."
OPEN_HINT = (
    "Opens it on every student's page, also on those of students who come later, and ends a presentation. Leaving it "
    "gives back their work."
)
CSV_HINT = "Names, predictions and passed lessons, for a spreadsheet. Nothing of it is kept when the class ends."
HEAD = ("student", "is at", "passed")
BAR = (
    '<div style="display:grid;grid-template-columns:1fr 2fr 2em;gap:.5em;align-items:center">'
    '<span>{}</span><progress max="{}" value="{}" style="width:100%"></progress><b>{}</b></div>'
)
NOBODY, NOTHING = "No student is on the page yet.", "Nobody has committed a prediction in this lesson yet."


class OpensLesson(Protocol):
    """What opens a lesson for all."""

    def __call__(self, number: int) -> None: ...


class BoardPanel:
    """A table of students, the predictions in one lesson, and two buttons."""

    def __init__(
        self, form: Form, classroom: Classroom, lessons: Mapping[int, str], open_lesson: OpensLesson, send: Send
    ) -> None:
        """lessons: titles by numbers."""
        self._classroom, self._lessons, self._open, self._send = classroom, lessons, open_lesson, send
        self._section = Section(form, "On the page")
        with self._section:
            self._table = form.gui.add_html("")
        section = Section(form, "Lessons")
        with section:
            labels = {number: f"{number} · {title}" for number, title in lessons.items()}
            self._lesson = Choice(section, "lesson", labels, hint=LESSON_HINT)
            form.button("Open it for all", self._open_for_all, hint=OPEN_HINT)
            self._predictions = form.gui.add_html("")
            form.button("Results as CSV", self._download, hint=CSV_HINT, quiet=True)

    def draw(self, inside: Mapping[int, int], places: int) -> None:
        """Show the students. inside: how many tabs each has open, by the visitor's number."""
        members = self._classroom.members
        self._section.caption(f"On the page: {len(inside)} of {places} places")
        rows = [self._row(member, inside.get(number, 0)) for number, member in members.items()]
        _show(self._table, NOTE.format(table(HEAD, rows) if rows else NOBODY))
        _show(self._predictions, NOTE.format(self._histogram(members)))

    @property
    def lesson(self) -> int:
        """The number of the chosen lesson."""
        return self._lesson.read()

    def _row(self, member: Member, tabs: int) -> tuple[str, ...]:
        where = f"{member.lesson}, {member.screen + 1}" if member.lesson else "the course" if tabs else "away"
        where = "your page" if member.following and tabs else where
        return member.name, where, f"{len(member.passed)} of {len(self._lessons)}"

    def _histogram(self, members: Mapping[int, Member]) -> str:
        counted = histogram(members, self._lessons[self.lesson])
        if not counted:
            return NOTHING
        most = max(counted.values())
        return "".join(BAR.format(html.escape(answer), most, count, count) for answer, count in counted.items())

    def _open_for_all(self) -> None:
        self._open(self.lesson)

    def _download(self) -> None:
        self._send("class.csv", results(self._classroom.members, self._lessons))


def _show(handle: viser.GuiHtmlHandle, content: str) -> None:
    if content != handle.content:
        handle.content = content
