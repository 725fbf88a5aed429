"""The Learn tab: a lesson puts its state on the page, is passed by what the page shows, and gives back the work."""

import threading
import time

import pytest

from explorer.lessons import course, figures
from explorer.lessons.lesson import Goal
from explorer.model.compute import compute
from explorer.model.learning import Learning
from explorer.panels.dock import Dock
from explorer.panels.learn import markup, screen_figures

COURSE = course()
PATIENCE = 20.0
"""s for a check."""


@pytest.fixture
def learning(dock: Dock):
    yield dock
    if dock.learn.lesson is not None:
        dock.learn.actions["lesson-leave"]()
    dock.learn.restore(Learning())


def show(dock: Dock) -> None:
    """What the session does after a change, and when nothing has changed for a moment."""
    picture = compute(dock.read())
    dock.draw(picture)
    dock.learn.draw_details(picture)
    dock.learn.check_again()


def run(dock: Dock) -> None:
    """Run the actions that were queued."""
    dock.form.run_actions()


def wait_for(dock: Dock, text: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while text not in dock.learn.content:
        assert time.monotonic() < deadline, dock.learn.content
        dock.form.deliver()
        time.sleep(0.01)


def test_a_lesson_shows_its_state_and_leaving_gives_back_what_was_there(learning: Dock):
    before = learning.read()
    learning.learn.open(COURSE.lessons[0])
    assert learning.read().preset == COURSE.lessons[0].start.settings.preset
    learning.learn.open(COURSE.lessons[-1])
    learning.learn.actions["lesson-leave"]()
    assert learning.read() == before
    assert "lessons passed" in learning.learn.content


def test_the_prediction_comes_before_what_follows_it_and_is_committed_once(learning: Dock):
    lesson, press = COURSE.lessons[0], learning.learn.actions
    learning.learn.open(lesson)
    while "Your prediction" not in learning.learn.content:
        press["lesson-next"]()
    assert 'data-rn-event="lesson-next" disabled' in learning.learn.content
    press["lesson-next"]()  # a browser may send what its page does not offer
    assert "Your prediction" in learning.learn.content
    press["lesson-predict-1"]()
    press["lesson-back"]()
    press["lesson-predict-2"]()
    assert f"You predicted: <b>{lesson.header.prediction.choices[0]}</b>" in learning.learn.content


def test_a_committed_prediction_waits_while_the_class_discusses_it(learning: Dock):
    learning.learn.hold_answer(True)
    learning.learn.open(COURSE.lessons[0])
    predict(learning)
    assert "when your teacher shows the answer" in learning.learn.content
    assert "rn-before" in learning.learn.content
    learning.learn.actions["lesson-next"]()  # a browser may send what its page does not offer
    assert learning.learn.keeps_answer
    learning.learn.hold_answer(False)
    learning.learn.actions["lesson-next"]()
    assert "Your prediction" not in learning.learn.content
    assert not learning.learn.keeps_answer


def predict(dock: Dock) -> None:
    """Go on to the prediction of the open lesson, and commit one."""
    while "Your prediction" not in dock.learn.content:
        dock.learn.actions["lesson-next"]()
    dock.learn.actions["lesson-predict-1"]()
    dock.learn.predict("1")


def test_saved_work_does_not_lead_beyond_a_prediction_that_is_missing(learning: Dock):
    learning.learn.restore(Learning(lesson=COURSE.lessons[0].name, screen=6))
    assert "Your prediction" in learning.learn.content
    assert learning.learn.keeps_answer


@pytest.mark.parametrize("lesson", COURSE.lessons, ids=lambda lesson: lesson.name)
def test_show_me_waits_for_the_prediction_and_then_leads_to_the_solution_of_each_lesson(learning: Dock, lesson):
    learning.learn.open(lesson)
    learning.learn.actions["lesson-show"]()  # a browser may send what its page does not offer
    assert learning.learn.wait(time.monotonic()) is None
    assert learning.read() == lesson.start.settings
    assert learning.learn.learning.answers == ()
    predict(learning)
    learning.learn.actions["lesson-show"]()
    while learning.learn.wait(time.monotonic()) is not None:
        learning.learn.play_if_due(time.monotonic() + 60.0)
        run(learning)
    shown = learning.read()
    assert shown.preset.path == lesson.solved.settings.preset.path
    assert (shown.preset.gains, shown.preset.world) == (
        lesson.solved.settings.preset.gains,
        lesson.solved.settings.preset.world,
    )


def test_the_check_judges_what_the_page_shows_and_a_passed_lesson_stays_passed(learning: Dock):
    lesson = COURSE.lessons[0]
    learning.learn.open(lesson)
    while "Task" not in learning.learn.content:
        learning.learn.actions["lesson-next"]()
        learning.learn.actions["lesson-predict-1"]()
    show(learning)
    wait_for(learning, "turn it farther")
    learning.write(lesson.solved.settings)
    show(learning)
    wait_for(learning, "✓")
    learning.learn.actions["lesson-again"]()
    show(learning)
    wait_for(learning, "You have passed this lesson before.")


def test_what_is_answered_pinned_or_opened_while_the_picture_stays_is_checked_again(learning: Dock):
    asked = next(one for one in COURSE.lessons if one.header.answers)
    learning.learn.open(asked)
    predict(learning)
    while "Task" not in learning.learn.content:
        learning.learn.actions["lesson-next"]()
    show(learning)
    wait_for(learning, "Name the fault of every record.")
    for k, answer in enumerate(asked.header.answers, start=1):
        right = answer.choices.index(asked.solved.answers[answer.name]) + 1
        learning.learn.actions[f"lesson-answer-{k}-{right}"]()
    learning.learn.check_again()
    wait_for(learning, "✓")
    learning.learn.actions["lesson-again"]()  # nothing on the page changes
    learning.learn.check_again()
    wait_for(learning, "✓")


def test_the_bar_is_full_at_the_goal_and_empty_far_from_it():
    at_least, at_most = Goal(label="x", value=2.0), Goal(label="x", value=2.0, at_least=False)
    decades = Goal(label="x", value=1.0, log=True)
    assert [markup.reached(at_least, x) for x in (0.0, 1.0, 2.0, 9.0)] == [0.0, 0.5, 1.0, 1.0]
    assert [markup.reached(at_most, x) for x in (8.0, 2.0, 1.0)] == [0.25, 1.0, 1.0]
    assert [markup.reached(decades, x) for x in (1e-3, 10**-1.5, 1.0, 10.0)] == [0.0, pytest.approx(0.5), 1.0, 1.0]
    assert markup.reached(at_least, float("nan")) == 0.0


def test_a_number_is_predicted_as_a_person_types_it_and_nonsense_gets_a_sentence(learning: Dock):
    lesson = next(one for one in COURSE.lessons if not one.header.prediction.choices)
    learning.learn.open(lesson)
    while "Your prediction" not in learning.learn.content:
        learning.learn.actions["lesson-next"]()
    learning.learn.predict("a lot")
    assert "“a lot” is not a number" in learning.learn.content
    learning.learn.predict("1e1")
    learning.learn.actions["lesson-back"]()
    assert "You predicted: <b>10" in learning.learn.content


def test_the_answers_for_the_teacher_are_computed_when_they_are_asked_for(learning: Dock):
    asked = COURSE.lessons[0].header.prediction.because
    assert asked not in learning.learn.content
    learning.learn.actions["lesson-answers"]()
    wait_for(learning, "what comes, and why")
    assert markup.html.escape(asked) in learning.learn.content


def test_the_figures_of_a_screen_are_computed_aside_and_its_text_says_so(learning: Dock, monkeypatch):
    lesson, allowed, compute_now = COURSE.lessons[0], threading.Event(), figures.text

    def slow(name, state):
        allowed.wait(PATIENCE)
        return compute_now(name, state)

    monkeypatch.setattr(figures, "text", slow)
    learning.learn.open(lesson)
    while "It came" not in learning.learn.content:
        learning.learn.actions["lesson-next"]()
        learning.learn.actions["lesson-predict-1"]()
    assert screen_figures.COMPUTING in learning.learn.content
    allowed.set()
    deadline = time.monotonic() + PATIENCE
    while screen_figures.COMPUTING in learning.learn.content:
        assert time.monotonic() < deadline
        learning.form.deliver()
        time.sleep(0.01)
    learning.learn.actions["lesson-back"]()
    learning.learn.actions["lesson-next"]()
    assert screen_figures.COMPUTING not in learning.learn.content
