"""What a teacher gets is made from the lessons: every question, every answer, and a worksheet without answers."""

import html

from explorer.lessons import course, teaching
from explorer.lessons.teaching import CLASS

LESSONS = course().lessons


def test_the_guide_has_each_lesson_with_its_right_answer_and_the_wrong_ones():
    for lesson, row in zip(LESSONS, teaching.guide(LESSONS), strict=True):
        asked, (title, _, _, came, others, _) = lesson.header.prediction, row
        assert title == f"{lesson.number} {lesson.header.title}"
        right = asked.choices[asked.right - 1] if asked.choices else ""
        assert came.startswith(right)
        assert all(choice in others for choice in asked.choices if choice != right)


def test_the_worksheet_asks_and_does_not_answer():
    sheet = teaching.worksheet(LESSONS).decode()
    assert set(CLASS) <= {number for page in teaching.PAGES for number in page}
    for lesson in (one for one in LESSONS if any(one.number in page for page in teaching.PAGES)):
        asked = lesson.header.prediction
        assert html.escape(asked.question.partition("{")[0]) in sheet
        assert all(f"☐ {html.escape(choice)}" in sheet for choice in asked.choices)
        assert html.escape(asked.because) not in sheet


def test_the_class_of_ninety_minutes_is_made_of_lessons_that_exist_and_fit():
    by_number = {lesson.number: lesson.header.minutes for lesson in LESSONS}
    assert sum(by_number[number] for number in CLASS) <= 90
