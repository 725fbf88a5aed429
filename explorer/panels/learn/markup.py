"""The Learn tab as HTML: the list of lessons, and one screen of a lesson with its buttons.

The buttons are the page's own: what they send is the name of an action, `lesson-next`.
"""

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass

from explorer.lessons import screens, teaching, text
from explorer.lessons.course import Course
from explorer.lessons.lesson import Answer, Goal, Lesson
from explorer.lessons.screens import Screen
from explorer.lessons.state import Outcome
from explorer.model.learning import PREDICTION, Learning, answers_of
from explorer.web.accessibility import spoken
from explorer.widgets.html import table

BUTTON = '<button type="button" class="rn-button {}" data-rn-event="{}" {}>{}</button>'
INTRODUCTION = (
    "Each lesson asks a question, has you predict the answer, and lets you try. What is on the page now is kept, and "
    "comes back when you leave the lesson."
)
DECADES, NOT_YET = 3.0, 0.9
"""The bar of a logarithmic metric is empty so many decades from the goal; while something else is missing it shows so
much at most."""
WAITS = "The lesson goes on when your teacher shows the answer to all."
HINT_NAMES = ("a hint", "another hint", "the last hint")


@dataclass(frozen=True, kw_only=True)
class Shown:
    """What one screen needs besides its lesson."""

    learning: Learning
    states: text.States
    read: text.Reader
    """The text of each figure."""
    outcome: Outcome | None = None
    """The check of what is on the page; None until it has been computed."""
    said: str = ""
    """What "show me" is doing, or why a prediction was not taken."""
    waits: bool = False
    """Whether the teacher of a class shows the answer to a committed prediction to all at once, later."""
    last: bool = False
    """Whether it is the last lesson of the course."""


def button(name: str, label: str, kind: str = "", *, pressed: bool | None = None, disabled: bool = False) -> str:
    """One button of this tab."""
    attributes = "" if pressed is None else f'aria-pressed="{str(pressed).lower()}"'
    return BUTTON.format(kind, f"lesson-{name}", "disabled" if disabled else attributes, html.escape(label))


def course_list(course: Course, learning: Learning, guide: Sequence[Sequence[str]] | None) -> str:
    """All lessons, each with its minutes and whether it was passed; and the guide for the teacher, once it is there.

    guide: None for a student of a class."""
    rows = "".join(_row(lesson, learning) for lesson in course.lessons)
    broken = "".join(f'<p class="rn-lesson-broken">{html.escape(reason)}</p>' for reason in course.complaints)
    done = sum(lesson.name in learning.passed for lesson in course.lessons)
    teacher = "" if guide is None else _for_teacher(guide)
    head = f"<p>{INTRODUCTION}</p><p><b>{done} of {len(course.lessons)}</b> lessons passed.</p>"
    return f'<div class="rn-lesson">{head}<ol class="rn-lesson-list">{rows}</ol>{broken}{teacher}</div>'


def _for_teacher(guide: Sequence[Sequence[str]]) -> str:
    return (
        f'<p class="rn-lesson-buttons">For the teacher: {button("answers", "Answers")}'
        f"{button('worksheet', 'Worksheet to print')}</p>{''.join(_answers_to(row) for row in guide)}"
    )


def _answers_to(row: Sequence[str]) -> str:
    """One lesson's row of the guide, unfolded by a click: the dock is too narrow for its columns."""
    title, *texts = row
    lines = (
        f"<p><b>{html.escape(name)}</b>: {html.escape(text)}</p>"
        for name, text in zip(teaching.COLUMNS[1:], texts, strict=True)
    )
    return f"<details><summary>{html.escape(title)}</summary>{''.join(lines)}</details>"


def screen(lesson: Lesson, shown: Shown) -> str:
    """One screen of a lesson, with the buttons to the next and to the previous one."""
    page, k, count = screens.shown(lesson, shown.learning.screen)
    body = {"text": _text, "prediction": _prediction, "task": _task, "outcome": _outcome}[page.kind](
        lesson, page, shown
    )
    head = (
        f'<div class="rn-lesson-head"><span>{lesson.number} · <b>{html.escape(lesson.header.title)}</b></span>'
        f"{button('leave', 'leave')}</div>"
    )
    bar = f'<progress max="{count}" value="{k + 1}" aria-label="screen {k + 1} of {count}"></progress>'
    committed = PREDICTION in answers_of(shown.learning, lesson.name)
    waits = page.kind == "prediction" and (shown.waits or not committed)
    last = k == count - 1
    done = page.kind != "task" or (shown.outcome is not None and shown.outcome.passed)
    onward = (
        button("next", "Next ›" if done else "Skip ›", "rn-main" if done else "", disabled=waits)
        if not last
        else button("following", "To the list ›" if shown.last else "Next lesson ›", "rn-main")
    )
    back = button("back", "‹ Back", disabled=k == 0)
    foot = f'<div class="rn-lesson-foot">{back}<span>{k + 1} / {count}</span>{onward}</div>'
    before = " rn-before" if waits or not committed else ""
    said = spoken("lesson", f"Lesson {lesson.number}, screen {k + 1} of {count}: {page.heading}.")
    heading = f"<h2>{html.escape(page.heading)}</h2>"
    return f'<div class="rn-lesson{before}" {said}>{head}{bar}{heading}{body}{foot}</div>'


def _row(lesson: Lesson, learning: Learning) -> str:
    mark = "✓" if lesson.name in learning.passed else "•" if answers_of(learning, lesson.name) else ""
    label = f"{lesson.number} · {lesson.header.title}"
    return (
        f'<li><span class="rn-lesson-mark" title="{"passed" if mark == "✓" else ""}">{mark}</span>'
        f"{button(f'open-{lesson.name}', label)}<span>{lesson.header.minutes:g} min</span></li>"
    )


def _text(lesson: Lesson, page: Screen, shown: Shown) -> str:
    return text.to_html(page.markdown, shown.states, shown.read)


def _prediction(lesson: Lesson, page: Screen, shown: Shown) -> str:
    """The question, and its choices; a number is typed into a box below. A committed prediction stays."""
    asked, given = lesson.header.prediction, answers_of(shown.learning, lesson.name).get(PREDICTION)
    body = f"<p>{html.escape(text.filled(asked.question, shown.states, shown.read))}</p>"
    if given is not None:
        follows = WAITS if shown.waits else "What came is shown after the task."
        return f'{body}<p role="status">You predicted: <b>{html.escape(given)}</b>. {follows}</p>'
    choices = "".join(f"<li>{button(f'predict-{k}', choice)}</li>" for k, choice in enumerate(asked.choices, start=1))
    asks = f'<ul class="rn-lesson-choices">{choices}</ul>' if choices else "<p>Type a number below.</p>"
    return f"{body}{asks}{_status(shown.said)}"


def _status(said: str) -> str:
    return f'<p role="status">{html.escape(said)}</p>' if said else ""


def _task(lesson: Lesson, page: Screen, shown: Shown) -> str:
    """What to do, how far it is done, where the controls are, and help."""
    passed = lesson.name in shown.learning.passed
    controls = "".join(button(f"control-{k}", place.label) for k, place in enumerate(lesson.header.places, start=1))
    hints = "".join(f"<li>{html.escape(hint)}</li>" for hint in lesson.header.hints[: shown.learning.hints])
    more = shown.learning.hints < len(lesson.header.hints)
    help_row = [button("hint", HINT_NAMES[shown.learning.hints])] if more else []
    help_row += [button("show", "show me"), button("again", "start again")]
    cases = "".join(button(f"case-{k}", f"open {name}") for k, name in enumerate(lesson.header.cases, start=1))
    questions = "".join(
        _question(k, asked, lesson, shown.learning) for k, asked in enumerate(lesson.header.answers, start=1)
    )
    parts = [
        _text(lesson, page, shown),
        f'<p class="rn-lesson-buttons">{cases}</p>' if cases else "",
        questions,
        _meter(lesson.header.goal, shown.outcome, passed=passed),
        f'<p class="rn-lesson-buttons">The controls: {controls}</p>' if controls else "",
        f"<ul>{hints}</ul>" if hints else "",
        f'<p class="rn-lesson-buttons">Stuck? {"".join(help_row)}</p>',
        _status(shown.said),
    ]
    return "".join(parts)


def _outcome(lesson: Lesson, page: Screen, shown: Shown) -> str:
    """The outcome, next to what was predicted."""
    asked, given = lesson.header.prediction, answers_of(shown.learning, lesson.name).get(PREDICTION, "nothing")
    because = text.filled(asked.because, shown.states, shown.read)
    rows = (("You predicted", given), ("It came", text.came(asked, shown.states, shown.read)), ("Because", because))
    return f"{table((), rows)}{_text(lesson, page, shown)}"


def _question(k: int, asked: Answer, lesson: Lesson, learning: Learning) -> str:
    given = answers_of(learning, lesson.name).get(asked.name)
    choices = "".join(
        button(f"answer-{k}-{j}", choice, pressed=choice == given) for j, choice in enumerate(asked.choices, start=1)
    )
    return f'<p>{html.escape(asked.question)}</p><p class="rn-lesson-buttons">{choices}</p>'


def strip(lesson: Lesson, outcome: Outcome | None) -> str:
    """One line over the scene: the task's metric and its goal, for whoever moves a control on another tab."""
    goal = lesson.header.goal
    now = "…" if outcome is None else goal.reading(outcome.metric)
    sign = "✓ " if outcome is not None and outcome.passed else ""
    text = f"{sign}Lesson {lesson.number} · {html.escape(goal.label)}: <b>{now}</b>, wanted {goal.wanted}"
    hint = "" if outcome is None or outcome.passed else f"<br>{html.escape(outcome.hint)}"
    return f'<div class="rn-task" role="status">{text}{hint}</div>'


def _meter(goal: Goal, outcome: Outcome | None, *, passed: bool) -> str:
    """A bar from nothing to the goal, and the number with its unit."""
    if outcome is None:
        return '<p role="status">The check is being computed …</p>'
    share = 1.0 if outcome.passed else min(reached(goal, outcome.metric), NOT_YET)
    sign = "✓" if outcome.passed else "…"
    now = goal.reading(outcome.metric)
    earlier = "" if outcome.passed or not passed else " You have passed this lesson before."
    return (
        f'<p class="rn-lesson-goal">{html.escape(goal.label)}: <b>{now}</b>, wanted {goal.wanted}</p>'
        f'<progress class="rn-lesson-bar" max="1" value="{share:.3f}" aria-label="how near the goal is"></progress>'
        f'<p role="status">{sign} {html.escape(outcome.hint)}{earlier}</p>'
    )


def reached(goal: Goal, metric: float) -> float:
    """How much of the way to the goal is done, from 0 to 1."""
    if not math.isfinite(metric):
        return 0.0
    if goal.log:
        if metric <= 0:
            return 0.0 if goal.at_least else 1.0
        decades = math.log10(metric / goal.value) * (1 if goal.at_least else -1)
        return min(max(1 + decades / DECADES, 0.0), 1.0)
    ratio = metric / goal.value if goal.at_least else goal.value / metric if metric > 0 else 1.0
    return min(max(ratio, 0.0), 1.0)
