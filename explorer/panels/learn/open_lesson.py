"""Where a visitor is in the course: the open lesson and its screen, what was answered, and what is asked now."""

import msgspec

from explorer.lessons import screens
from explorer.lessons.course import Course
from explorer.lessons.lesson import Lesson
from explorer.model import learning as progress
from explorer.model.learning import PREDICTION, Learning
from explorer.model.settings import Settings
from explorer.widgets import typed_number
from rangenav.number_format import quantity


class OpenLesson:
    """The open lesson, or none while the list of lessons is shown."""

    def __init__(self, course: Course) -> None:
        self.course = course
        self.learning = Learning()
        self.answer_waits = False
        """Whether the teacher of a class shows the answer to a committed prediction to all at once, later."""

    @property
    def lesson(self) -> Lesson | None:
        """The open lesson; None while the list is shown, or if the lesson is no longer there."""
        return next((one for one in self.course.lessons if one.name == self.learning.lesson), None)

    @property
    def following(self) -> Lesson | None:
        """The lesson after the open one; None after the last."""
        names = [lesson.name for lesson in self.course.lessons]
        k = names.index(self.learning.lesson) + 1 if self.learning.lesson in names else len(names)
        return self.course.lessons[k] if k < len(names) else None

    @property
    def answers(self) -> dict[str, str]:
        """The answers in the open lesson, by their questions."""
        return progress.answers_of(self.learning, self.learning.lesson)

    @property
    def kind(self) -> screens.Kind | None:
        """What the open screen is; None while the list is shown."""
        lesson = self.lesson
        return None if lesson is None else screens.shown(lesson, self.learning.screen)[0].kind

    @property
    def waits_for_prediction(self) -> bool:
        """Whether a lesson is open whose prediction is not committed yet: nothing may answer it."""
        return self.lesson is not None and PREDICTION not in self.answers

    @property
    def keeps_answer(self) -> bool:
        """Whether nothing may answer the question of the open lesson: its prediction is not committed yet, or waits for
        the class."""
        return self.waits_for_prediction or (self.kind == "prediction" and self.answer_waits)

    @property
    def asks_now(self) -> bool:
        """Whether the open screen asks for the prediction."""
        return self.kind == "prediction" and self.waits_for_prediction

    @property
    def asks_number(self) -> bool:
        """Whether the open screen asks for a number to be typed."""
        lesson = self.lesson
        return lesson is not None and self.asks_now and not lesson.header.prediction.choices

    def open(self, lesson: Lesson, before: Settings) -> None:
        """Open a lesson at its first screen. `before`: what is on the page."""
        self.learning = progress.opened(self.learning, lesson.name, before)

    def restore(self, learning: Learning) -> None:
        """Take over where the visitor was before a reload, but not beyond a prediction that is not committed."""
        self.learning = learning
        lesson = self.lesson
        if lesson is not None and self.waits_for_prediction:
            first = [screen.kind for screen in screens.screens(lesson)].index("prediction")
            self.learning = msgspec.structs.replace(learning, screen=min(learning.screen, first))

    def turn(self, by: int) -> bool:
        """Go so many screens on, or back, but not beyond a prediction that is asked for, or that waits for the class.

        Returns whether it went."""
        lesson = self.lesson
        if lesson is None or (by > 0 and self.kind == "prediction" and self.keeps_answer):
            return False
        _, k, count = screens.shown(lesson, self.learning.screen)
        self.learning = msgspec.structs.replace(self.learning, screen=min(max(k + by, 0), count - 1))
        return True

    def answer(self, question: str, text: str) -> None:
        """Keep an answer in the open lesson; it replaces an earlier one."""
        self.learning = progress.answered(self.learning, question, text)

    def choose(self, k: int, j: int) -> bool:
        """Answer question k by its choice j, both from 1. Returns whether the open lesson has them."""
        lesson = self.lesson
        if lesson is None or k > len(lesson.header.answers) or j > len(lesson.header.answers[k - 1].choices):
            return False
        asked = lesson.header.answers[k - 1]
        self.answer(asked.name, asked.choices[j - 1])
        return True

    def predict_choice(self, k: int) -> bool:
        """Commit choice k, from 1, as the prediction. Returns whether the open lesson has it."""
        lesson = self.lesson
        if lesson is None or k > len(lesson.header.prediction.choices):
            return False
        self._commit(lesson.header.prediction.choices[k - 1])
        return True

    def predict_number(self, text: str) -> None:
        """Commit a number as a person types it. Raises ValueError for what is no number."""
        lesson = self.lesson
        if lesson is not None:
            self._commit(quantity(typed_number.parse(text), lesson.header.prediction.unit))

    def _commit(self, prediction: str) -> None:
        """A prediction is committed once; the next screen follows."""
        if PREDICTION not in self.answers:
            self.answer(PREDICTION, prediction)
            self.turn(1)

    def show_hint(self) -> None:
        """Show one more hint."""
        self.learning = msgspec.structs.replace(self.learning, hints=self.learning.hints + 1)

    def passed(self) -> None:
        """The task of the open lesson is done."""
        self.learning = progress.passed(self.learning)

    def leave(self) -> None:
        """Back to the list."""
        self.learning = progress.left(self.learning)
