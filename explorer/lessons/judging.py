"""Whether a lesson does what it says: its solution passes, all other states do not, and its screens are short.

`python -m explorer.lessons FOLDER` prints this for a teacher's own lessons; the tests ask it for ours.
"""

import math
import re
from collections.abc import Iterator

from explorer.lessons.lesson import Lesson
from explorer.lessons.state import Outcome
from rangenav.number_format import significant

MAX_WORDS = 90
"""Of a screen. An equation and a figure count as one word, and rows of a table as none."""
EQUATION = re.compile(r"\$\$.+?\$\$|\$.+?\$", re.DOTALL)
ROW = re.compile(r"^\|.*$", re.MULTILINE)
WORD = re.compile(r"\w[\w'’.-]*|\{[^}]*\}|∎")


def outcomes(lesson: Lesson) -> dict[str, Outcome]:
    """What the check says of every state of a lesson. Raises ValueError if a file of a state is missing or wrong."""
    first, second = lesson.failing()
    judged = {"start": lesson.start, "solved": lesson.solved, "failing-1": first, "failing-2": second}
    return {name: lesson.check(state) for name, state in judged.items()}


def faults(lesson: Lesson) -> tuple[str, ...]:
    """What is wrong with a lesson, one sentence each."""
    try:
        found = outcomes(lesson)
    except ValueError as error:
        return (str(error),)
    wrong = [
        f"{name} {'does not pass' if name == 'solved' else 'passes'}: {outcome.hint}"
        for name, outcome in found.items()
        if outcome.passed != (name == "solved")
    ]
    wrong += [
        f"{name} passes with a metric of {significant(outcome.metric)}, which misses the goal"
        for name, outcome in found.items()
        if outcome.passed and not reaches(lesson, outcome)
    ]
    return (*wrong, *_long_screens(lesson))


def reaches(lesson: Lesson, outcome: Outcome) -> bool:
    """Whether a metric reaches the goal, so that the bar is full."""
    goal = lesson.header.goal
    return outcome.metric >= goal.value if goal.at_least else outcome.metric <= goal.value


def words(markdown: str) -> int:
    """How many words a screen has."""
    return len(WORD.findall(EQUATION.sub(" ∎ ", ROW.sub("", markdown))))


def table(lessons: tuple[Lesson, ...]) -> str:
    """A table in Markdown: the metric that each state of each lesson reaches."""
    rows = ["| lesson | metric | goal | start | solved | failing-1 | failing-2 |", "|---|---|---|---|---|---|---|"]
    return "\n".join([*rows, *(_row(lesson) for lesson in lessons)])


def _row(lesson: Lesson) -> str:
    goal = lesson.header.goal
    unit = f" ({goal.unit})" if goal.unit else ""
    reached = " | ".join(_reached(outcome) for outcome in outcomes(lesson).values())
    relation = "≥" if goal.at_least else "≤"
    return f"| {lesson.name} | {goal.label}{unit} | {relation} {significant(goal.value)} | {reached} |"


def _reached(outcome: Outcome) -> str:
    number = "none" if math.isnan(outcome.metric) else significant(outcome.metric)
    return f"{number} ✓" if outcome.passed else number


def _long_screens(lesson: Lesson) -> Iterator[str]:
    for name, screens in lesson.sections.items():
        for k, screen in enumerate(screens, 1):
            if words(screen) > MAX_WORDS:
                yield f"{name}, screen {k}, has {words(screen)} words; {MAX_WORDS} are the most"
