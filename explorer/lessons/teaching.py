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
PAGES = ((1, 2, 3, 4, 5), (6, 8, 10, 12))
"""The numbers of the lessons on each page of the worksheet: those of the class, and lesson 3 for whoever is quick."""
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
    """Two pages of A4 to print: each question with its choices to tick, and lines for what came and why."""
    by_number = {lesson.number: lesson for lesson in reversed(lessons)}  # ours, where a teacher has used a number too
    pages = "".join(
        f'<section class="page">{"".join(_exercise(by_number[k]) for k in page if k in by_number)}</section>'
        for page in PAGES
    )
    head = (
        '<header><h1>What can one range tell?</h1><p>Name <span class="line"></span></p>'
        '<p>Date <span class="line short"></span></p></header>'
    )
    style = STYLE.read_text(encoding="utf-8")
    return (
        f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Worksheet</title><style>{style}</style>'
        f"</head><body>{head}{pages}</body></html>"
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
    predicted = ticks or f'I predict <span class="line short"></span> {html.escape(asked.unit)}'
    reached = f"{goal.label}, wanted {goal.wanted}"
    return (
        f'<div class="lesson"><h2>{lesson.number} · {html.escape(lesson.header.title)}</h2>'
        f"<p>{html.escape(text.filled(asked.question, states))}</p>"
        f'<p class="choices">{predicted}</p>'
        f'<p class="write">It came <span class="line"></span></p>'
        f'<p class="write">Because <span class="line"></span></p>'
        f'<p class="write">{html.escape(reached)}; I reached <span class="line"></span></p></div>'
    )
