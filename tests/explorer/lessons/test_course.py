"""Our lessons: each says what it does, its text can be shown, and its numbers exist."""

import dataclasses
import math
import re
from xml.etree import ElementTree

import pytest
from msgspec.structs import replace

from explorer.charts import TITLES
from explorer.lessons import Lesson, course, judging, text
from explorer.lessons.lesson import SECTIONS
from rangenav import preset

COURSE = course()
lesson = pytest.mark.parametrize("lesson", COURSE.lessons, ids=lambda one: one.name)
MATH = re.compile(r"<math .*?</math>", re.DOTALL)


def _texts(one: Lesson) -> list[str]:
    """Every text of a lesson that a student reads, in Markdown."""
    asked = one.header.prediction
    screens = [screen for screens in one.sections.values() for screen in screens]
    return [asked.question, asked.because, *one.header.hints, *screens]


def test_there_are_fourteen_lessons_and_all_can_be_read():
    assert COURSE.complaints == ()
    assert [one.number for one in COURSE.lessons] == list(range(1, 15))


@lesson
def test_the_solution_passes_no_other_state_does_and_every_screen_is_short(lesson: Lesson):
    assert judging.faults(lesson) == ()


@lesson
def test_a_check_is_pure(lesson: Lesson):
    assert repr(lesson.check(lesson.solved)) == repr(lesson.check(lesson.solved))


@lesson
def test_what_the_solution_changes_is_no_more_than_the_page_can_change(lesson: Lesson):
    """A student starts from the start: world, sensors and vehicle that no control reaches must be the same already."""
    start, solved = lesson.start.settings, lesson.solved.settings
    assert start.origin == solved.origin
    for part in ("requirement", "vehicle", "seed"):
        assert getattr(start.preset, part) == getattr(solved.preset, part)
    assert lesson.start.answers == {}
    assert lesson.start.exported is None


@lesson
def test_every_text_is_html_without_a_brace_a_dollar_or_a_missing_number(lesson: Lesson):
    states = lesson.states(lesson.solved)
    for markdown in _texts(lesson):
        shown = MATH.sub("", text.to_html(markdown, states))
        assert not set(shown) & set("{}$\\"), shown
        assert text.MISSING not in shown


@lesson
def test_every_equation_is_mathml_without_leftovers_of_latex(lesson: Lesson):
    for markdown in _texts(lesson):
        for found in MATH.findall(text.to_html(markdown, {})):
            for element in ElementTree.fromstring(found).iter():
                assert "\\" not in (element.text or ""), found
                assert element.text != "None"


@lesson
def test_a_prediction_has_an_answer_and_a_task_has_answers_that_the_check_accepts(lesson: Lesson):
    asked = lesson.header.prediction
    if not asked.choices:
        shown = text.filled(f"{{{asked.figure}}}", lesson.states(lesson.solved))
        assert math.isfinite(float(re.match(r"[\d.]+", shown)[0]))  # type: ignore[index]
    assert set(lesson.solved.answers) == {answer.name for answer in lesson.header.answers}
    for answer in lesson.header.answers:
        assert lesson.solved.answers[answer.name] in answer.choices


@lesson
def test_what_is_shown_as_plain_text_has_no_markdown_and_no_equation(lesson: Lesson):
    asked, answers = lesson.header.prediction, lesson.header.answers
    choices = [choice for one in answers for choice in one.choices]
    for plain in (asked.question, asked.because, *asked.choices, *lesson.header.hints, *choices):
        assert not set(plain) & set("$*`\\#"), plain


@lesson
def test_the_plots_of_a_lesson_exist_and_its_start_is_a_shipped_preset(lesson: Lesson):
    assert set(lesson.header.plots) <= set(TITLES)
    assert lesson.header.plots
    assert lesson.start.settings.origin in preset.shipped()


@lesson
def test_a_hint_is_no_repetition_and_every_section_has_a_screen(lesson: Lesson):
    assert len(set(lesson.header.hints)) == 3
    assert tuple(lesson.sections) == SECTIONS


@pytest.mark.parametrize("number", [3, 6, 7, 8, 10, 11, 12, 14])
def test_a_solution_with_better_sensors_than_those_of_the_task_does_not_pass(number: int):
    one = COURSE.lesson(number)
    assert one is not None
    settings = one.solved.settings
    before = settings.preset.sensors
    sensors = replace(before, noise=replace(before.noise, range=1e-3))
    better = replace(settings, preset=replace(settings.preset, sensors=sensors))
    other = dataclasses.replace(one.solved, settings=better)
    outcome = one.check(other)
    assert not outcome.passed
    assert outcome.hint == "Put back what is part of the task: the sensors."


def test_the_table_has_a_row_for_every_lesson():
    rows = judging.table(COURSE.lessons[:1]).splitlines()
    assert len(rows) == 3
    assert rows[-1].count("✓") == 1
