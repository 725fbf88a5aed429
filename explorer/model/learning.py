"""Where one visitor is in the course: the lesson, the screen, the answers, and the work that was there before.

The names of the fields are part of the file format of saved work.
"""

import msgspec

from explorer.model.settings import Settings
from rangenav.inputs import Input, require

PREDICTION = "prediction"
"""The name of a lesson's prediction among its answers."""
MAX_ANSWERS, MAX_TEXT = 200, 200


class LessonAnswer(Input, frozen=True, kw_only=True):
    """What was answered to one question."""

    lesson: str
    """The name of its folder."""
    question: str
    answer: str

    def __post_init__(self) -> None:
        super().__post_init__()
        require(len(self.answer) <= MAX_TEXT, f"an answer must have at most {MAX_TEXT} characters")


class Learning(Input, frozen=True, kw_only=True):
    """The progress of one visitor."""

    lesson: str = ""
    """The name of the open lesson; empty while the list is shown."""
    screen: int = 0
    hints: int = 0
    """How many hints of the open lesson have been shown."""
    answers: tuple[LessonAnswer, ...] = ()
    passed: tuple[str, ...] = ()
    """The names of the lessons that were passed."""
    before: Settings | None = None
    """What was on the page before the first lesson was opened; leaving the course gives it back."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self.screen >= 0, f"screen must not be negative, got {self.screen}")
        require(self.hints >= 0, f"hints must not be negative, got {self.hints}")
        require(len(self.answers) <= MAX_ANSWERS, f"at most {MAX_ANSWERS} answers are kept, got {len(self.answers)}")


def answers_of(learning: Learning, lesson: str) -> dict[str, str]:
    """The answers in one lesson, by their questions."""
    return {answer.question: answer.answer for answer in learning.answers if answer.lesson == lesson}


def answered(learning: Learning, question: str, text: str) -> Learning:
    """The same with an answer in the open lesson; an earlier answer to the question is replaced."""
    new = LessonAnswer(lesson=learning.lesson, question=question, answer=text)
    others = tuple(a for a in learning.answers if (a.lesson, a.question) != (new.lesson, new.question))
    return msgspec.structs.replace(learning, answers=(*others, new)[-MAX_ANSWERS:])


def opened(learning: Learning, lesson: str, before: Settings) -> Learning:
    """The same with a lesson open at its first screen. What was on the page is kept, unless a lesson was open."""
    kept = before if learning.before is None else learning.before
    return msgspec.structs.replace(learning, lesson=lesson, screen=0, hints=0, before=kept)


def left(learning: Learning) -> Learning:
    """The same with no lesson open; what was on the page before has been given back."""
    return msgspec.structs.replace(learning, lesson="", screen=0, hints=0, before=None)


def passed(learning: Learning) -> Learning:
    """The same with the open lesson passed."""
    if learning.lesson in learning.passed or not learning.lesson:
        return learning
    return msgspec.structs.replace(learning, passed=(*learning.passed, learning.lesson))
