"""For the teacher: what each lesson shows, the answers, the wrong predictions to expect, and a worksheet to print.

All of it is made from the lessons, so that a lesson that is added or changed is in it.
"""

import html
from collections.abc import Sequence
from pathlib import Path

from explorer.lessons import text
from explorer.lessons.lesson import Lesson

CLASS = (1, 2, 5, 4, 6, 8, 10, 12)
"""The numbers of the lessons of a class of 90 minutes, in their order."""
COLUMNS = ("lesson", "minutes", "prediction asked for", "what comes, and why", "other predictions", "task")
STYLE = Path(__file__).with_name("worksheet.css")


def guide(lessons: Sequence[Lesson]) -> list[tuple[str, ...]]:
    """A row for each lesson, in plain text, under COLUMNS."""
    return [_row(lesson) for lesson in lessons]


def markdown(lessons: Sequence[Lesson]) -> str:
    """The rows as a table of a page of the documentation."""
    lines = [COLUMNS, ("---",) * len(COLUMNS), *guide(lessons)]
    return "\n".join(f"| {' | '.join(cell.replace('|', '∣') for cell in line)} |" for line in lines)


def worksheet(lessons: Sequence[Lesson]) -> bytes:
    """Two pages to print: each question with its choices to tick, and lines for what came and why."""
    blocks = "".join(_exercise(lesson) for lesson in lessons)
    head = '<h1>What can one range tell?</h1><p>Name: <span class="line"></span> Date: <span class="line"></span></p>'
    style = STYLE.read_text(encoding="utf-8")
    return (
        f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Worksheet</title><style>{style}</style>'
        f"</head><body>{head}{blocks}</body></html>"
    ).encode()


def _row(lesson: Lesson) -> tuple[str, ...]:
    asked, goal, states = lesson.header.prediction, lesson.header.goal, lesson.states(lesson.start)
    others = [choice for k, choice in enumerate(asked.choices, start=1) if k != asked.right]
    return (
        f"{lesson.number} {lesson.header.title}",
        f"{lesson.header.minutes:g}",
        text.filled(asked.question, states),
        f"{text.came(asked, states)}. {text.filled(asked.because, states)}",
        "; ".join(others) or "any other number",
        f"{goal.label} {goal.wanted}",
    )


def _exercise(lesson: Lesson) -> str:
    asked, goal, states = lesson.header.prediction, lesson.header.goal, lesson.states(lesson.start)
    ticks = "".join(f"<span>☐ {html.escape(choice)}</span>" for choice in asked.choices)
    predicted = ticks or f'I predict <span class="line"></span> {html.escape(asked.unit)}'
    unit = f" ({goal.unit})" if goal.unit else ""
    return (
        f'<div class="lesson"><h2>{lesson.number} · {html.escape(lesson.header.title)}</h2>'
        f"<p>{html.escape(text.filled(asked.question, states))}</p>"
        f'<p class="choices">{predicted}</p>'
        f'<p>It came: <span class="line"></span> Why: <span class="line" style="min-width:95mm"></span></p>'
        f'<p>{html.escape(goal.label)}{html.escape(unit)}: I reached <span class="line"></span></p></div>'
    )
