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
HOLD_HINT = (
    "No student's page goes on from a prediction to what answers it, until you show the answers: first discuss the "
    "predictions."
)
HOLD, SHOW = "Keep the answers back", "Show the answers to all"
CSV_HINT = "Names, predictions and passed lessons, for a spreadsheet. Nothing of it is kept when the class ends."
HEAD = ("student", "is at", "passed")
BAR = '<span>{}</span><progress max="{}" value="{}" aria-label="{}"></progress><b>{}</b>'
BARS = '<p>{}</p><div class="rn-bars">{}</div>'
LARGER = '<button type="button" class="rn-button" data-rn-flag="predictions">Show the predictions large</button>'
CARD = (
    '<div class="rn-card rn-predictions" role="dialog" aria-label="The predictions of the class">'
    '<button type="button" class="rn-button" data-rn-flag="predictions" aria-label="Close">✕</button>'
    "<h2>{}</h2>{}</div>"
)
NOBODY = "No student is on the page yet."


class OpensLesson(Protocol):
    """What opens a lesson for all."""

    def __call__(self, number: int) -> None: ...


class BoardPanel:
    """A table of students, the predictions in one lesson, and the buttons of a lesson."""

    def __init__(
        self,
        form: Form,
        classroom: Classroom,
        lessons: Mapping[int, str],
        open_lesson: OpensLesson,
        send: Send,
        card: viser.GuiHtmlHandle,
    ) -> None:
        """lessons: titles by numbers. card: the predictions for the projector, outside all tabs."""
        self._classroom, self._lessons, self._open, self._send = classroom, lessons, open_lesson, send
        self._card = card
        self.students = Section(form, "On the page")
        """The section of the students."""
        with self.students:
            self._table = form.gui.add_html("")
        section = Section(form, "Lessons")
        with section:
            labels = {number: f"{number} · {title}" for number, title in lessons.items()}
            self._lesson = Choice(section, "lesson", labels, hint=LESSON_HINT)
            form.button("Open it for all", self._open_for_all, hint=OPEN_HINT)
            self._hold = form.button(HOLD, self._toggle_hold, hint=HOLD_HINT, quiet=True)
            self._predictions = form.gui.add_html("")
            form.button("Results as CSV", self._download, hint=CSV_HINT, quiet=True)

    def draw(self, inside: Mapping[int, int], places: int) -> None:
        """Show the students. inside: how many tabs each has open, by the visitor's number."""
        members = self._classroom.members
        self.students.caption(f"On the page: {len(inside)} of {places} places")
        rows = [self._row(member, inside.get(number, 0)) for number, member in members.items()]
        _show(self._table, NOTE.format(table(HEAD, rows) if rows else NOBODY))
        label = SHOW if self._classroom.state.answers_wait else HOLD
        if label != self._hold.label:
            self._hold.label = label
        title = self._lessons[self.lesson]
        bars = _bars(histogram(members, title), len(members))
        _show(self._predictions, NOTE.format(bars + LARGER))
        _show(self._card, CARD.format(html.escape(title), bars))

    @property
    def lesson(self) -> int:
        """The number of the chosen lesson."""
        return self._lesson.read()

    def _row(self, member: Member, tabs: int) -> tuple[str, ...]:
        return member.name, _place(member) if tabs else "away", f"{len(member.passed)} of {len(self._lessons)}"

    def _open_for_all(self) -> None:
        self._open(self.lesson)

    def _toggle_hold(self) -> None:
        self._classroom.hold_answers(not self._classroom.state.answers_wait)

    def _download(self) -> None:
        self._send("class.csv", results(self._classroom.members, self._lessons))


def _place(member: Member) -> str:
    """Where a student's page is."""
    if member.following or member.copies:
        return "your page" if member.following else "a copy of your page"
    return f"{member.lesson}, {member.screen + 1} / {member.screens}" if member.lesson else "own work"


def _bars(counted: Mapping[str, int], students: int) -> str:
    """A bar for each prediction, and how many of the students have committed one."""
    made = sum(counted.values())
    escaped = {html.escape(prediction): count for prediction, count in counted.items()}
    bars = [BAR.format(prediction, made, count, prediction, count) for prediction, count in escaped.items()]
    return BARS.format(f"{made} of {students} have predicted.", "".join(bars))


def _show(handle: viser.GuiHtmlHandle, content: str) -> None:
    if content != handle.content:
        handle.content = content
