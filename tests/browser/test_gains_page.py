"""The Gains tab in a real Chromium: two languages, half turns by a button, nonsense in a physical box."""

import time

from tests.browser.page import Visitor, until

LETTERS, WORDS = "the paper's letters", "physical quantities"
SETTLED = 5.0
"""°, below which the verdict counts an attitude as settled."""


def _error(visitor: Visitor, plot: str) -> list[float]:
    """The first curve of a plot, as drawn; several plots have curves of the same names."""
    return visitor.page.evaluate(CURVE, plot)


CURVE = """(name) => {
    const title = document.querySelector(`[data-plot=${name}]`).getBoundingClientRect();
    const charts = Object.values(window.__viserTestpoints.uplots).map(entry => entry.chart);
    const below = chart => Math.abs(chart.root.getBoundingClientRect().top - title.bottom);
    charts.sort((one, other) => below(one) - below(other));
    return Array.from(charts[0].data[1]).filter(value => value !== null && !Number.isNaN(value));
}"""
"""The plot that stands closest below its own title: viser tells them apart by ids that change when one is rebuilt."""


def test_the_units_are_switched_without_a_jump_and_a_physical_value_moves_a_gain(visitor: Visitor):
    visitor.tab("Gains")
    visitor.wait_for_text("range weight q (1/")
    before = _error(visitor, "position")
    visitor.choose("show gains as", WORDS)
    visitor.wait_for_text("assumed range noise (m)")
    visitor.wait_for_no_text("range weight q (1/")
    assert _error(visitor, "position") == before
    assert "•" not in visitor.text()
    visitor.nudge("assumed range noise (m)", times=3)
    until(lambda: _error(visitor, "position") != before, "another error")
    until(lambda: visitor.number("assumed range noise (m)") == "0.1349", "the number")
    time.sleep(1.5)  # longer than work may wait to be written
    visitor.reload()
    visitor.tab("Gains")
    visitor.wait_for_text("assumed range noise (m)")
    visitor.choose("show gains as", LETTERS)
    visitor.wait_for_text("range weight q (1/")


def test_a_start_at_a_half_turn_is_drawn_from_180_degrees_down(visitor: Visitor):
    visitor.tab("Gains")
    visitor.folder("Start at a half turn")
    visitor.press("between m and g")
    visitor.wait_for_text("The start is 0° from the nearest undesired equilibrium")
    until(lambda: _error(visitor, "attitude")[0] > 179.9, "a start at 180°")
    assert visitor.number("initial attitude error (°)") == "180"
    assert max(_error(visitor, "attitude")[-20:]) < SETTLED
    visitor.press("almost: 1° off")
    visitor.wait_for_text("The start is 1° from the nearest undesired equilibrium")
    until(lambda: visitor.number("initial attitude error (°)") == "179", "the angle")
    until(lambda: 178.5 < _error(visitor, "attitude")[0] < 179.5, "a start at 179°")


def test_nonsense_in_a_physical_box_is_told_there_and_nothing_is_lost(visitor: Visitor):
    visitor.tab("Gains")
    visitor.choose("show gains as", WORDS)
    visitor.wait_for_text("assumed range noise (m)")
    before, good = _error(visitor, "position"), visitor.number("assumed range noise (m)")
    visitor.type_number("assumed range noise (m)", "1e-3")
    visitor.wait_for_text("assumed range noise asks for q = ")
    visitor.wait_for_text("Not shown")
    assert _error(visitor, "position") == before
    for nonsense in ("", "-", "abc", "1e999", "<b>1</b>"):
        visitor.type_number("assumed range noise (m)", nonsense)
    visitor.type_number("assumed range noise (m)", good)
    visitor.wait_for_no_text("asks for q = ")
    visitor.wait_for_no_text("Not shown")
    until(lambda: _error(visitor, "position") == before, "the curve as it was, to the last bit")
    visitor.choose("show gains as", LETTERS)
    visitor.wait_for_text("range weight q (1/")
