"""The Learn tab: the course, and the player of one lesson.

A lesson puts its first state on the page. What was there before comes back when the lesson is left. The check runs on
what the page shows whenever nothing has changed for a moment.
"""

import time
from functools import partial

import viser

from explorer.lessons import demonstration
from explorer.lessons.course import Course
from explorer.lessons.lesson import Lesson
from explorer.lessons.state import State
from explorer.model.compute import Picture
from explorer.model.learning import Learning
from explorer.panels.learn.actions import LearnActions
from explorer.panels.learn.elements import Elements
from explorer.panels.learn.for_teachers import ForTeachers
from explorer.panels.learn.judge import Judge
from explorer.panels.learn.open_lesson import OpenLesson
from explorer.panels.learn.screen_figures import ScreenFigures
from explorer.panels.learn.show import Show
from explorer.widgets.form import Action, Form
from explorer.widgets.page import Page

EXPORT = (
    "Now export it yourself: on the tab Presets open “Download with certificate”, switch “polynomials” on, and press "
    "“Export as a zip”."
)


class LearnPanel:
    """The list of lessons, or one screen of a lesson."""

    def __init__(
        self, form: Form, course: Course, page: Page, actions: LearnActions, strip: viser.GuiHtmlHandle
    ) -> None:
        """`strip` lies over the scene: it shows how far a task is done while its controls are on another tab."""
        self._form, self._course, self._page, self._session = form, course, page, actions
        self._judge = Judge(form.new_jobs(), pinned=actions.pinned, exported=actions.exported)
        self._teacher: ForTeachers | None = ForTeachers(form.new_jobs(), course.lessons, actions.download)
        self._figures = ScreenFigures(form.new_jobs())
        self._opened = OpenLesson(course)
        self._show, self._said = Show(), ""
        self._elements = Elements(form, strip, commit=self.predict)
        self._draw()

    @property
    def actions(self) -> dict[str, Action]:
        """What the buttons do, by the names that they send."""
        named: dict[str, Action] = {
            "next": lambda: self._turn(1),
            "back": lambda: self._turn(-1),
            "leave": self.leave,
            "following": self._following,
            "hint": self._hint,
            "show": self._demonstrate,
            "again": self._again,
            "answers": self._give_answers,
            "worksheet": self._give_worksheet,
        }
        for lesson in self._course.lessons:
            named[f"open-{lesson.name}"] = partial(self.open, lesson)
        most = range(1, 10)
        named |= {f"predict-{k}": partial(self._predict, k) for k in most}
        named |= {f"control-{k}": partial(self._go_to, k) for k in most}
        named |= {f"case-{k}": partial(self._open_case, k) for k in most}
        named |= {f"answer-{k}-{j}": partial(self._answer, k, j) for k in most for j in most}
        return {f"lesson-{name}": action for name, action in named.items()}

    @property
    def lesson(self) -> Lesson | None:
        """The open lesson; None while the list is shown, or if the lesson is no longer there."""
        return self._opened.lesson

    @property
    def learning(self) -> Learning:
        """Where the visitor is in the course; saved with the visitor's work."""
        return self._opened.learning

    @property
    def keeps_answer(self) -> bool:
        """Whether a lesson is open whose prediction is not committed yet, or waits for the class."""
        return self._opened.keeps_answer

    @property
    def content(self) -> str:
        """What the tab shows, as HTML."""
        return self._elements.content

    @property
    def titles(self) -> dict[int, str]:
        """The titles of all lessons by their numbers."""
        return {lesson.number: lesson.header.title for lesson in self._course.lessons}

    def open(self, lesson: Lesson) -> None:
        """Show a lesson from its beginning, on its first state."""
        self._opened.open(lesson, before=self._page.read())
        self._judge.begin()
        self._session.rewind()
        self._put(lesson.start)

    def open_number(self, number: int) -> None:
        """Open a lesson by its number, which must be one of `titles`."""
        lesson = self._course.lesson(number)
        if lesson is not None:
            self.open(lesson)

    def restore(self, learning: Learning) -> None:
        """Take over where the visitor was before a reload, but not beyond a prediction that is not committed."""
        self._opened.restore(learning)
        self._draw()

    def wait(self, now: float) -> float | None:
        """How long (s) until the next step of "show me"; None if it does not play."""
        return self._show.wait(now)

    def play_if_due(self, now: float) -> None:
        """Do the next step of "show me" when it is due."""
        step, lesson = self._show.take(now), self.lesson
        if step is None or lesson is None:
            return
        self._form.do(partial(self._page.write, step.settings))
        end = f" {self._end_of_show(lesson)}" if self._show.ended else ""
        self._said = f"Shown: {step.label}.{end}"
        self._draw()

    def draw(self, picture: Picture) -> None:
        """The page shows another picture: the old outcome is that of something else."""
        self._judge.moved(picture)
        if self._opened.kind == "task":  # the figures of other screens follow when nothing moves
            self._write()

    def draw_details(self, picture: Picture) -> None:
        """Nothing has changed for a moment: check what the page shows."""
        self._judge.rested(picture)
        lesson = self.lesson
        if lesson is not None:
            self._draw()
            self._judge.check(lesson, self._opened.answers, self._take)

    def check_again(self) -> None:
        """Check once more if something else was opened, answered, pinned or exported while the picture stayed."""
        picture = self._judge.picture
        if picture is not None and self._judge.is_behind(self._opened.answers):
            self.draw_details(picture)

    def _take(self) -> None:
        outcome = self._judge.outcome
        if outcome is not None and outcome.passed:
            self._opened.passed()
        self._draw()

    def _put(self, state: State) -> None:
        """Show a state of the lesson."""
        self._stop_show()
        self._session.pin(state.pinned)
        self._page.write(state.settings)
        self._judge.forget()
        self._draw()

    def _turn(self, by: int) -> None:
        if self._opened.turn(by):
            self._draw()

    def leave(self) -> None:
        """Back to the list, and to what was on the page before."""
        before = self.learning.before
        self.close()
        if before is not None:
            self._page.write(before)

    def close(self) -> None:
        """Back to the list; what is on the page stays, and is the visitor's own work from now on."""
        self._stop_show()
        self._opened.leave()
        self._session.pin(None)
        self._draw()

    def _following(self) -> None:
        following = self._opened.following
        if following is not None:
            self.open(following)
        else:
            self.leave()

    def _again(self) -> None:
        if self.lesson is not None:
            self._put(self.lesson.start)

    def _say(self, sentence: str) -> None:
        self._said = sentence
        self._draw()

    def _hint(self) -> None:
        self._opened.show_hint()
        self._draw()

    def _predict(self, k: int) -> None:
        if self._opened.predict_choice(k):
            self._draw()

    def predict(self, text: str) -> None:
        """Commit a number as a person types it; what is not a number gets a sentence."""
        try:
            self._opened.predict_number(text)
        except ValueError as error:
            self._say(f"⚠ Your prediction: {error}")
            return
        self._say("")

    def _answer(self, k: int, j: int) -> None:
        if self._opened.choose(k, j):
            self._draw()

    def _open_case(self, k: int) -> None:
        lesson = self.lesson
        if lesson is not None and k <= len(lesson.cases):
            self._put(lesson.cases[k - 1])

    def _go_to(self, k: int) -> None:
        lesson = self.lesson
        if lesson is not None and k <= len(lesson.header.controls):
            self._session.go_to(lesson.header.places[k - 1])

    def _demonstrate(self) -> None:
        lesson = self.lesson
        if lesson is not None and not self.keeps_answer:
            self._show.begin(demonstration.steps(self._page.read(), lesson.solved.settings), time.monotonic())
            self._said = self._end_of_show(lesson) if self._show.ended else ""
            self._draw()

    def _end_of_show(self, lesson: Lesson) -> str:
        """Give the answers of the solution; a sentence on what remains to be done by hand."""
        for name, answer in lesson.solved.answers.items():
            self._opened.answer(name, answer)
        return EXPORT if lesson.solved.exported is not None else "That is a solution."

    def _stop_show(self) -> None:
        self._show.end()
        self._said = ""

    def keep_answers(self) -> None:
        """Give this visitor neither answers nor worksheet: a student of a class."""
        self._teacher = None
        self._draw()

    def hold_answer(self, wait: bool) -> None:
        """Have a committed prediction wait until the teacher of a class shows its answer to all, or go on."""
        if wait != self._opened.answer_waits:
            self._opened.answer_waits = wait
            self._draw()

    def _give_answers(self) -> None:
        if self._teacher is not None:
            self._teacher.answers(self._draw, self._say)

    def _give_worksheet(self) -> None:
        if self._teacher is not None:
            self._teacher.worksheet(self._say)

    def _draw(self) -> None:
        """Show the list, or the open screen; what is not known of its figures follows."""
        self._write()
        self._figures.compute(self._write, self._say)

    def _write(self) -> None:
        """Show what is known."""
        guide = None if self._teacher is None else self._teacher.guide
        self._elements.show(self._opened, self._judge, self._figures, said=self._said, guide=guide)
