"""The Learn tab: the course, and the player of one lesson.

A lesson puts its first state on the page. What was there before comes back when the lesson is left. The check runs on
what the page shows whenever nothing has changed for a moment.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import msgspec
import viser

from explorer.lessons import demonstration, screens
from explorer.lessons.course import Course
from explorer.lessons.lesson import Lesson, Place
from explorer.lessons.state import State
from explorer.model import learning as progress
from explorer.model.compute import Picture
from explorer.model.learning import PREDICTION, Learning
from explorer.model.settings import Settings
from explorer.panels.learn import markup
from explorer.panels.learn.for_teachers import ForTeachers
from explorer.panels.learn.judge import Judge
from explorer.panels.learn.screen_figures import ScreenFigures
from explorer.panels.learn.show import Show
from explorer.widgets import typed_number
from explorer.widgets.form import Action, Form
from explorer.widgets.page import Page
from rangenav.number_format import quantity

EXPORT = (
    "Now export it yourself: on the tab Presets open “Download with certificate”, switch “polynomials” on, and press "
    "“Export as a zip”."
)
COMMIT_HINT = "A committed prediction stays."
NUMBER_HINT = "A number, such as 0.5. It is committed by the button below, and stays."


@dataclass(frozen=True, kw_only=True)
class LearnActions:
    """What only the session can do."""

    pin: Callable[[Settings | None], None]
    """Pins a run A by its settings, or unpins it."""
    pinned: Callable[[], Settings | None]
    rewind: Action
    """Goes to the beginning of the flight."""
    download: Callable[[str, bytes], None]
    """Downloads a file: its name and its content."""
    exported: Callable[[], tuple[str, bytes] | None]
    """The name of the format and the content of the file that was exported last."""
    go_to: Callable[[Place], None]
    """Brings a control into sight."""


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
        self.learning = Learning()
        self._show, self._said = Show(), ""
        self._block = form.gui.add_html("")
        self._strip = strip
        self._number = form.gui.add_text("your prediction", "", visible=False, hint=NUMBER_HINT)
        self._commit = form.button(
            "Commit", lambda: self.predict(self._number.value), hint="A committed prediction stays."
        )
        self._commit.visible = False
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
        return next((one for one in self._course.lessons if one.name == self.learning.lesson), None)

    @property
    def waits_for_prediction(self) -> bool:
        """Whether a lesson is open whose prediction is not committed yet: nothing may answer it."""
        return self.lesson is not None and PREDICTION not in self._given

    @property
    def content(self) -> str:
        """What the tab shows, as HTML."""
        return self._block.content

    @property
    def titles(self) -> dict[int, str]:
        """The titles of all lessons by their numbers."""
        return {lesson.number: lesson.header.title for lesson in self._course.lessons}

    def open(self, lesson: Lesson) -> None:
        """Show a lesson from its beginning, on its first state."""
        self.learning = progress.opened(self.learning, lesson.name, self._page.read())
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
        self.learning = learning
        lesson = self.lesson
        if lesson is not None and self.waits_for_prediction:
            first = [screen.kind for screen in screens.screens(lesson)].index("prediction")
            self.learning = msgspec.structs.replace(learning, screen=min(learning.screen, first))
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
        if self._kind == "task":  # the figures of other screens follow when nothing moves
            self._write()

    def draw_details(self, picture: Picture) -> None:
        """Nothing has changed for a moment: check what the page shows."""
        self._judge.rested(picture)
        lesson = self.lesson
        if lesson is not None:
            self._draw()
            self._judge.check(lesson, self._given, self._take)

    def check_again(self) -> None:
        """Check once more if something else was opened, answered, pinned or exported while the picture stayed."""
        picture = self._judge.picture
        if picture is not None and self._judge.is_behind(self._given):
            self.draw_details(picture)

    @property
    def _given(self) -> dict[str, str]:
        """The answers in the open lesson, by their questions."""
        return progress.answers_of(self.learning, self.learning.lesson)

    def _take(self) -> None:
        outcome = self._judge.outcome
        if outcome is not None and outcome.passed:
            self.learning = progress.passed(self.learning)
        self._draw()

    def _put(self, state: State) -> None:
        """Show a state of the lesson."""
        self._stop_show()
        self._session.pin(state.pinned)
        self._page.write(state.settings)
        self._judge.forget()
        self._draw()

    def _turn(self, by: int) -> None:
        lesson = self.lesson
        if lesson is None or (by > 0 and self._asks_now):
            return
        _, k, count = screens.shown(lesson, self.learning.screen)
        self.learning = msgspec.structs.replace(self.learning, screen=min(max(k + by, 0), count - 1))
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
        self.learning = progress.left(self.learning)
        self._session.pin(None)
        self._draw()

    def _following(self) -> None:
        names = [lesson.name for lesson in self._course.lessons]
        k = names.index(self.learning.lesson) + 1 if self.learning.lesson in names else len(names)
        if k < len(names):
            self.open(self._course.lessons[k])
        else:
            self.leave()

    def _again(self) -> None:
        if self.lesson is not None:
            self._put(self.lesson.start)

    def _say(self, sentence: str) -> None:
        self._said = sentence
        self._draw()

    def _hint(self) -> None:
        self.learning = msgspec.structs.replace(self.learning, hints=self.learning.hints + 1)
        self._draw()

    def _predict(self, k: int) -> None:
        lesson = self.lesson
        if lesson is None or k > len(lesson.header.prediction.choices):
            return
        self._commit_prediction(lesson.header.prediction.choices[k - 1])

    def predict(self, text: str) -> None:
        """Commit a number as a person types it; what is not a number gets a sentence."""
        lesson = self.lesson
        if lesson is None:
            return
        try:
            value = typed_number.parse(text)
        except ValueError as error:
            self._say(f"⚠ Your prediction: {error}")
            return
        self._said = ""
        self._commit_prediction(quantity(value, lesson.header.prediction.unit))

    def _commit_prediction(self, answer: str) -> None:
        """A prediction is committed once."""
        if PREDICTION not in self._given:
            self.learning = progress.answered(self.learning, PREDICTION, answer)
            self._turn(1)

    def _answer(self, k: int, j: int) -> None:
        lesson = self.lesson
        if lesson is None or k > len(lesson.header.answers) or j > len(lesson.header.answers[k - 1].choices):
            return
        asked = lesson.header.answers[k - 1]
        self.learning = progress.answered(self.learning, asked.name, asked.choices[j - 1])
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
        if lesson is not None and not self.waits_for_prediction:
            self._show.begin(demonstration.steps(self._page.read(), lesson.solved.settings), time.monotonic())
            self._said = self._end_of_show(lesson) if self._show.ended else ""
            self._draw()

    def _end_of_show(self, lesson: Lesson) -> str:
        """Give the answers of the solution; a sentence on what remains to be done by hand."""
        for name, answer in lesson.solved.answers.items():
            self.learning = progress.answered(self.learning, name, answer)
        return EXPORT if lesson.solved.exported is not None else "That is a solution."

    def _stop_show(self) -> None:
        self._show.end()
        self._said = ""

    def keep_answers(self) -> None:
        """Give this visitor neither answers nor worksheet: a student of a class."""
        self._teacher = None
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
        self._figures.begin()
        lesson = self.lesson
        if lesson is None:
            guide = None if self._teacher is None else self._teacher.guide
            content = markup.course_list(self._course, self.learning, guide)
        else:
            shown = markup.Shown(
                learning=self.learning,
                states=self._states(lesson),
                read=self._figures.read,
                outcome=self._judge.outcome,
                said=self._said,
                last=lesson is self._course.lessons[-1],
            )
            content = markup.screen(lesson, shown)
        asks_number = lesson is not None and self._asks_number(lesson)
        if asks_number and not self._number.visible:
            self._number.value = ""  # what was typed in another lesson is no answer here
        for handle in (self._number, self._commit):
            if handle.visible != asks_number:
                handle.visible = asks_number
        strip = (
            "" if lesson is None or self._kind not in ("task", "outcome") else markup.strip(lesson, self._judge.outcome)
        )
        if strip != self._strip.content:
            self._strip.content = strip
        if content != self._block.content:
            self._block.content = content

    @property
    def _kind(self) -> screens.Kind | None:
        """What the open screen is; None while the list is shown."""
        lesson = self.lesson
        if lesson is None:
            return None
        return screens.shown(lesson, self.learning.screen)[0].kind

    @property
    def _asks_now(self) -> bool:
        """Whether the open screen asks for the prediction."""
        return self._kind == "prediction" and self.waits_for_prediction

    def _asks_number(self, lesson: Lesson) -> bool:
        return self._asks_now and not lesson.header.prediction.choices

    def _states(self, lesson: Lesson) -> dict[str, State | None]:
        """The states that the text may name; before the first picture what is shown is the lesson's first state."""
        picture = self._judge.picture
        shown = lesson.start if picture is None else self._judge.state(picture.settings, self._given)
        return lesson.states(shown)
