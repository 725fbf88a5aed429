"""A class in real browsers: a teacher presents, students follow, break away, come back, and the class ends."""

import math
import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from tests.browser.axe import broken
from tests.browser.page import COARSE, Visitor, served, until

WEIGHT = "range weight q (1/(m⁴ s))"
ROWS_OF_TABS = """() => new Set([...document.querySelectorAll('[data-dock-region=right] [role=tab]')]
    .map(tab => Math.round(tab.getBoundingClientRect().y))).size"""
SCREEN = "document.querySelector('.rn-lesson-foot > span')?.textContent"
FRONT = "document.querySelector('[data-dock-region=right] [role=tab][aria-selected=true]').textContent"


class Room:
    """A teacher's page, a student's who typed the code, and the link for one who comes late."""

    def __init__(self, browser: Browser, teachers: str, students: str, page: str, code: str) -> None:
        self.browser, self.students = browser, students
        self.teacher = Visitor(browser, teachers, density=COARSE)
        self.student = Visitor(browser, page, density=COARSE, code=code)
        for tab in (self.teacher, self.student):
            tab.dismiss_notifications()

    def shares(self, label: str, *students: Visitor) -> None:
        """Wait until students' pages show the teacher's number."""
        for student in students or (self.student,):
            until(lambda: student.number(label) == self.teacher.number(label), f"the teacher's {label}")  # noqa: B023


@pytest.fixture(scope="module")
def room(browser: Browser) -> Iterator[Room]:
    with served("--host", "0.0.0.0", "--places", "5") as server:
        said = [server.url, server.next_line(), server.next_line()]
        teachers, students, page, code = re.sub(
            r"//[^:/]+:", "//127.0.0.1:", " ".join((said[0].split()[-1], said[1].split()[-1], *said[2].split()[1::4]))
        ).split()
        room = Room(browser, teachers, students, page, code)
        yield room
        room.student.close()
        room.teacher.close()


def test_a_class_follows_breaks_away_comes_back_and_ends(room: Room):
    teacher, student = room.teacher, room.student
    assert teacher.page.evaluate(FRONT) == "Class"
    assert teacher.page.evaluate(ROWS_OF_TABS) == student.page.evaluate(ROWS_OF_TABS) == 1
    teacher.wait_for_text("On the page: 1 of 5 places")
    assert broken(teacher.page, "[data-dock-region=right]") == set()
    student.tab("Gains")
    student.type_number(WEIGHT, "123")
    student.wait_for_text(f"{WEIGHT} •")  # the session has it

    teacher.press("Present my page")
    student.wait_for_text("You follow the teacher")
    assert student.page.evaluate(FRONT) == "Gains"  # nothing was moved yet: nothing is brought to the front
    student.tab("Motion")
    teacher.tab("Gains")
    teacher.nudge(WEIGHT, times=2)
    until(lambda: student.page.evaluate(FRONT) == "Gains", "the tab of the control that was moved")
    room.shares(WEIGHT)
    teacher.type_number("t (s)", "3")
    room.shares("t (s)")
    teacher.page.locator("[data-rn-flag=camera]").click()
    teacher.press("View from above")
    until(lambda: math.dist(student.camera_position(), teacher.camera_position()) < 0.05, "the teacher's camera")

    student.press("Back to my work")
    until(lambda: student.number(WEIGHT) == "123", "the own work")
    teacher.nudge(WEIGHT)
    student.press("Follow")
    room.shares(WEIGHT)
    student.press("Work on a copy")
    student.wait_for_text("You work on a copy")
    room.shares(WEIGHT)

    teacher.tab("Class")
    teacher.press("Eyes on me")
    student.wait_for_text("Eyes on the teacher")
    assert student.page.get_by_role("button", name="Back to my work").count() == 0
    late = Visitor(room.browser, room.students, density=COARSE)
    late.wait_for_text("Eyes on the teacher")
    late.tab("Gains")
    teacher.tab("Gains")
    room.shares(WEIGHT, late)
    weight = teacher.number(WEIGHT)
    teacher.tab("Class")
    teacher.press("Release all")
    teacher.press("End the presentation")
    for tab in (student, late):
        tab.wait_for_no_text("You follow the teacher")
    teacher.press("Send what I see to all")
    until(lambda: late.number(WEIGHT) == weight, "what was sent")

    teacher.press("Present my page")
    student.wait_for_text("You follow the teacher")
    teacher.press("Open it for all")  # who followed could not work on it
    student.wait_for_text("A drone hovers")
    student.wait_for_no_text("You follow the teacher")
    prediction = student.page.locator("[data-rn-event=lesson-predict-1]")
    while prediction.count() == 0:
        screen = student.page.evaluate(SCREEN)
        student.press("Next ›")
        until(lambda: student.page.evaluate(SCREEN) != screen, "the next screen")  # noqa: B023
    prediction.click()
    teacher.page.locator(".rn-bars progress").first.wait_for()  # the histogram has a bar
    teacher.press("End the class")
    teacher.press("End it now")
    for tab in (student, late):
        tab.page.get_by_label("Code that your teacher shows").wait_for()
        tab.page.get_by_text("The class is over.").wait_for()
    teacher.wait_for_text("No student is on the page yet")
    late.close()
