"""The switches "as printed": one button shows a hover that the printed condition certifies."""

import pytest

from tests.support.waiting_visitor import Editing

pytestmark = pytest.mark.slow


def test_one_button_shows_the_false_certificate_of_a_hover(editing: Editing):
    editing.press("Certify a hover, as printed")
    assert editing.settings.origin == "turning-hover"
    assert editing.settings.printed.excitation
    assert editing.settings.printed.body_axes
    editing.tab.wait_for_text("where the derived one is 0 — a false certificate")
    assert "blind</b>" in editing.tab.text()
