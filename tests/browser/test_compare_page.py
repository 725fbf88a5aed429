"""The Compare tab in a real Chromium: a run pinned and changed, seeds with a band, and seeds that are stopped."""

from tests.browser.page import CHARTS, PATIENCE, Visitor


def _wait_for_bands(visitor: Visitor, count: int) -> None:
    """Until so many plots on view have a tinted band."""
    expression = f"count => {CHARTS}.filter(chart => chart.bands.length > 0).length === count"
    visitor.page.wait_for_function(expression, arg=count, timeout=PATIENCE * 1000)


def test_a_pinned_run_stays_in_the_plots_while_a_gain_changes(wide: Visitor):
    wide.tab("Compare")
    wide.press("Pin this run as A")
    wide.wait_for_text("A and B have the same settings so far.")
    before = wide.chart_data("σ by P")
    assert any("A" in labels for labels in wide.chart_labels())
    assert before[1] == before[3]  # A lies on what it was pinned from
    wide.tab("Gains")
    wide.nudge("range weight q (1/(m⁴ s))", "ArrowLeft", times=5)
    wide.tab("Compare")
    wide.wait_for_text("Range weight q:")
    wide.wait_for_text("steady position")
    after = wide.chart_data("σ by P")
    assert after[1] != after[3]
    wide.wait_for_node("/pinned_trail")
    wide.press("Unpin")
    wide.wait_for_no_text("Range weight q:")
    assert not any("A" in labels for labels in wide.chart_labels())


def test_seeds_draw_a_band_that_goes_when_a_gain_changes(wide: Visitor):
    wide.tab("Compare")
    wide.type_number("runs", "8")
    wide.press("Run the noise seeds")
    wide.wait_for_text("8 seeds of these settings")
    _wait_for_bands(wide, 4)
    data = wide.chart_data("8 seeds")
    median, high, low = data[-3:]
    assert None not in high + low + median
    mean = [sum(value or 0.0 for value in column) for column in (low, median, high)]
    assert mean == sorted(mean)  # each column is thinned by itself: within a pixel a point of one may pass another's
    assert mean[0] < mean[2]
    wide.tab("Gains")
    wide.nudge("attitude gain k1 (1/s)", "ArrowLeft")
    _wait_for_bands(wide, 0)
    wide.tab("Compare")
    wide.wait_for_text("the band belonged to others and is gone")


def test_seeds_can_be_stopped(wide: Visitor):
    wide.tab("Motion")
    wide.type_number("flight duration (s)", "600")
    wide.wait_for_text("600")
    wide.tab("Compare")
    wide.type_number("runs", "100")
    wide.press("Run the noise seeds")
    wide.wait_for_text("Working:")
    wide.press("Stop")
    wide.wait_for_no_text("Working:")
    assert "of these settings" not in wide.text()
