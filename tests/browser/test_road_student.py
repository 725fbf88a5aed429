"""A student's road: a hover, why one range is blind on it, three tones and a nearer anchor, the estimate arrives.

Every click, and every number that is typed, is an action; at most twelve lead there."""

import pytest
from playwright.sync_api import Browser

from tests.browser.page import COARSE, Server, Visitor

MOST = 12


class Student:
    """A visitor who counts."""

    def __init__(self, visitor: Visitor) -> None:
        self._visitor, self.actions = visitor, 0

    def tab(self, label: str) -> None:
        self.actions += 1
        self._visitor.tab(label)

    def choose(self, label: str, option: str) -> None:
        self.actions += 2  # the menu, and the entry
        self._visitor.choose(label, option)

    def press(self, label: str) -> None:
        self.actions += 1
        self._visitor.press(label)

    def type(self, label: str, text: str) -> None:
        self.actions += 1
        self._visitor.type_number(label, text)


@pytest.fixture
def visitor(server: Server, browser: Browser):
    tab = Visitor(browser, server.url, density=COARSE, says="observable")
    tab.dismiss_notifications()
    yield tab
    assert tab.complaints == []
    tab.close()


def test_from_a_blind_hover_to_an_estimate_that_arrives_in_twelve_actions(visitor: Visitor):
    student = Student(visitor)
    student.tab("Presets")
    student.choose("preset", "(hover)")
    visitor.wait_for_text("5 of 13 quantities determined")
    student.press("All answers")
    visitor.wait_for_text("nothing excites x")
    student.tab("Motion")
    place = visitor.page.get_by_role("button", name="+ x").first.bounding_box()
    for axis in ("x", "y", "z"):
        student.press(f"+ {axis}")
        visitor.wait_for_text(f"{axis}: 0.6 m")
    assert visitor.page.get_by_role("button", name="+ x").first.bounding_box() == place  # it stays under the mouse
    text = visitor.text()
    assert all(heading in text for heading in ("x: 0.6 m · sin(4 t)", "y: 0.6 m · sin(6 t)", "z: 0.6 m · sin(3 t)"))
    visitor.wait_for_text("all 13 quantities determined")
    visitor.wait_for_text("wanted ±0.5 m")
    student.tab("World")
    student.type("anchor position (m)", "1")
    visitor.wait_for_text("yes, within 0.3 m from")
    visitor.wait_for_no_text("nothing excites")
    student.press("Play or pause")
    visitor.wait_for_text("playing")
    assert student.actions <= MOST, student.actions
