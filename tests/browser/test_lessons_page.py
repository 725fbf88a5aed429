"""Every lesson is walked on the page as a student walks it: read, predict, change the controls, pass, read what came.

One tab walks the course from its first lesson to its last, by mouse and keyboard. What a student changes in a lesson is
a row of WALKS for each control.
"""

from collections.abc import Iterator
from typing import Literal, NamedTuple

import pytest
from playwright.sync_api import Browser, Page

from explorer.lessons import Lesson, course
from tests.browser.page import COARSE, Server, Visitor

LESSONS = course().lessons
WIDTH, HEIGHT = 1024, 640


class Step(NamedTuple):
    """What is done to one control."""

    control: str
    """Its label."""
    value: str
    """What is typed, chosen, or pressed."""
    way: Literal["type", "choose", "press", "switch", "answer"] = "type"
    axis: int = 0
    """Of a vector: which of its boxes."""


TONE, POINT = Step("add a tone along", "+ z", "press"), "position of the point (m)"
EXPORT = (Step("polynomials", "", "switch"), Step("Export as a zip", "Export as a zip", "press"))
WALKS: dict[int, tuple[Step, ...]] = {
    1: (Step("turn of the twin (°)", "40"),),
    2: (TONE, Step("amplitude z (m)", "0.25"), Step("frequency ω (rad/s)", "4")),
    3: (
        Step("path made of", "waypoints", "choose"),
        Step("chosen point", "1", "choose"),
        Step(POINT, "1.2", axis=2),
        Step("chosen point", "5", "choose"),
        Step(POINT, "0.8", axis=2),
    ),
    4: (Step("amplitude y (rad/s)", "2"), Step("frequency ω (rad/s)", "1")),
    5: (Step("speed (slower ⟷ faster)", "0.33"),),
    6: (TONE, Step("amplitude z (m)", "0.1"), Step("frequency ω (rad/s)", "4")),
    7: tuple(Step("anchor position (m)", text, axis=k) for k, text in enumerate(("0", "0", "-0.5"))),
    8: (Step("range weight q (1/(m⁴ s))", "20000"),),
    9: tuple(
        Step(question, fault, "answer")
        for question, fault in (
            ("What is wrong with record 1?", "a gyro bias"),
            ("What is wrong with record 2?", "the printed model"),
            ("What is wrong with record 3?", "a range bias"),
        )
    ),
    10: (Step("attitude gain k1 (1/s)", "4"),),
    11: (Step("trust in gravity ρ2 (s⁴/m²)", "0.01"),),
    12: (Step("speed (slower ⟷ faster)", "0.185"), *EXPORT),
    13: (
        Step("On which recording does the observer converge?", "recording 2", "answer"),
        Step("Which number decides it?", "the excitation μ", "answer"),
    ),
    14: (
        *(Step("add a tone along", button, "press") for button in ("+ x", "+ y", "+ z")),
        Step("amplitude x (m)", "0.9"),
        Step("amplitude z (m)", "0.9"),
        Step("speed (slower ⟷ faster)", "0.556"),
        *EXPORT,
    ),
}


@pytest.fixture(scope="module")
def student(server: Server, browser: Browser) -> Iterator[Visitor]:
    """One tab for the whole course, with work of its own on the page before."""
    tab = Visitor(browser, server.url, width=WIDTH, height=HEIGHT, density=COARSE, says="quantities determined")
    tab.dismiss_notifications()
    tab.page.get_by_label("Collapse panel area").first.click()  # the plots have tests of their own
    tab.tab("Motion")
    tab.type_number("speed (slower ⟷ faster)", "0.8")
    tab.tab("Learn")
    yield tab
    assert tab.complaints == []
    tab.close()


FOOT = "document.querySelector('.rn-lesson-foot > span')?.textContent ?? 'list'"
"""Which screen of how many is shown. (The text of a screen changes also when its figures have been computed.)"""


def press(page: Page, label: str) -> None:
    """Press a button of the lesson that leads to another screen, and wait for it."""
    before = page.evaluate(FOOT)
    page.locator(".rn-lesson button", has_text=label).first.click()
    page.wait_for_function(f"before => document.querySelector('.rn-lesson') && ({FOOT}) !== before", arg=before)


def begin(student: Visitor, lesson: Lesson) -> None:
    """Open a lesson: from the end of the last one by its button, else from the list."""
    page = student.page
    following = page.locator(".rn-lesson button", has_text="Next lesson ›")
    if lesson.number > 1 and following.is_visible() and LESSONS[lesson.number - 2].header.title in student.text():
        press(page, "Next lesson ›")
    else:
        if page.locator(".rn-lesson button", has_text="leave").is_visible():
            press(page, "leave")
        press(page, f"{lesson.number} · {lesson.header.title}")
    student.wait_for_text(f"{lesson.number} · {lesson.header.title}")


def predict(student: Visitor, lesson: Lesson) -> None:
    """Commit the last choice, or a number."""
    asked = lesson.header.prediction
    if asked.choices:
        press(student.page, asked.choices[-1])
    else:
        student.type_text("your prediction", "1.5")
        student.press("Commit")
        student.page.locator("h2", has_text="Your prediction").wait_for(state="detached")


def do(student: Visitor, lesson: Lesson, step: Step) -> None:
    """One change, at the control that the lesson leads to."""
    page = student.page
    if step.way == "answer":
        question = page.get_by_text(step.control)
        question.locator("xpath=following-sibling::p[1]").get_by_role("button", name=step.value).click()
        return
    if step.control not in [place.label for place in lesson.header.places]:
        student.type_number(step.control, step.value)  # it has come into sight by the step before
        return
    student.tab("Learn")
    page.locator(".rn-lesson button", has_text=step.control).click()  # opens its tab and folder, and focuses it
    page.locator(".rn-lesson").wait_for(state="hidden")
    if step.way == "press":
        page.get_by_role("button", name=step.value, exact=True).first.click()
        return
    focus = f"document.activeElement?.getAttribute('aria-label')?.startsWith({step.control!r})"
    page.wait_for_function(focus)
    if step.way == "choose":
        student.choose(step.control, step.value)
    elif step.way == "switch":
        if not page.locator(":focus").is_checked():
            page.keyboard.press("Space")
    else:
        slider = page.evaluate("document.activeElement.getAttribute('role') === 'slider'")
        for _ in range(1 if slider else step.axis):
            page.keyboard.press("Tab")
        page.keyboard.press("Control+a")
        page.keyboard.type(step.value)
        page.keyboard.press("Enter")


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda one: one.name)
def test_a_lesson_is_walked_from_its_question_to_passed(student: Visitor, lesson: Lesson):
    page, asked = student.page, lesson.header.prediction
    begin(student, lesson)
    while "Your prediction" not in page.locator(".rn-lesson h2").inner_text():
        press(page, "Next ›")
    predict(student, lesson)
    while not page.get_by_text("Stuck?").is_visible():
        press(page, "Next ›")
    for step in WALKS[lesson.number]:
        do(student, lesson, step)
    page.locator(".rn-task", has_text="✓ Lesson").wait_for()
    student.tab("Learn")
    assert page.locator(".rn-lesson-bar").get_attribute("value") == "1.000"
    outcome = page.locator(".rn-lesson", has_text="You predicted")
    while not outcome.is_visible():
        press(page, "Next ›")
    outcome.filter(has_text=asked.choices[-1] if asked.choices else "1.5").wait_for()
    while not page.get_by_text("Next lesson ›").or_(page.get_by_text("To the list ›")).is_visible():
        press(page, "Next ›")


def test_a_reload_keeps_the_place_and_leaving_gives_back_the_work(student: Visitor):
    begin(student, LESSONS[0])
    press(student.page, "Next ›")
    student.reload()
    student.tab("Learn")
    student.wait_for_text("Your prediction")
    press(student.page, "leave")
    student.wait_for_text(f"of {len(LESSONS)} lessons passed")
    student.tab("Motion")
    assert student.number("speed (slower ⟷ faster)") == "0.8"
