"""The progress in the course: a prediction is committed once per question, and the work from before is kept."""

from explorer.model import learning
from explorer.model.learning import Learning
from explorer.model.settings import Settings
from rangenav import preset

HOVER = Settings(origin="hover", preset=preset.load("hover"))
SOFT = Settings(origin="soft", preset=preset.load("soft"))


def test_the_work_from_before_the_first_lesson_is_kept_while_lessons_follow_each_other():
    first = learning.opened(Learning(), "01-a", HOVER)
    second = learning.opened(first, "02-b", SOFT)
    assert (second.lesson, second.before) == ("02-b", HOVER)
    assert learning.left(second).before is None


def test_an_answer_replaces_the_earlier_one_to_the_same_question_of_the_same_lesson_only():
    begun = learning.opened(Learning(), "01-a", HOVER)
    twice = learning.answered(learning.answered(begun, "q", "yes"), "q", "no")
    other = learning.answered(learning.opened(twice, "02-b", HOVER), "q", "maybe")
    assert learning.answers_of(other, "01-a") == {"q": "no"}
    assert learning.answers_of(other, "02-b") == {"q": "maybe"}


def test_a_lesson_is_passed_once():
    begun = learning.opened(Learning(), "01-a", HOVER)
    assert learning.passed(learning.passed(begun)).passed == ("01-a",)
