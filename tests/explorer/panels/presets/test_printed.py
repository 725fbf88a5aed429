"""The switches "as printed": one button shows the printed condition beside the derived one on a hover."""

import pytest

from explorer.model.settings import Printed
from tests.support.waiting_visitor import Editing

pytestmark = pytest.mark.slow


def test_one_button_shows_the_printed_condition_beside_the_derived_one(editing: Editing):
    editing.press("Printed against derived, on a hover")
    assert editing.settings.origin == "turning-hover"
    assert editing.settings.printed == Printed()
    editing.tab.wait_for_text(
        "Settings that differ (A → B): Printed signal φ: on → off; Excitation in body axes: on → off"
    )
    text = editing.tab.text()
    unit = " m²/s⁷ (required: 1)"
    assert f"<td>✓ holds: printed μ 16{unit}, so it calls this motion observable</td>" in text
    assert f"<td>✕ fails: derived μ 0{unit}</td>" in text
    assert "not steady: " in text  # both observers have diverged
    assert "<td>5 of 13</td><td>5 of 13</td>" in text
    pinned = editing.session.dock.compare.pinned
    assert pinned is not None
    assert pinned.settings.printed == Printed(excitation=True, body_axes=True)
    editing.command("Unpin A")
    editing.tab.wait_for_text("No run is pinned. “Pin this run as A” in the tab Compare keeps the run on the page.")
