"""Plots under a real mouse: the legends tell what is under it, and a click on an entry hides its curve."""

import time

import numpy as np
import pytest

from explorer.charts import plot_list
from explorer.model.compute import compute
from explorer.model.settings import Settings
from rangenav import preset
from rangenav.number_format import significant
from tests.browser.page import CHARTS, Visitor, until

TOLD = """selector => Array.from(document.querySelectorAll(selector), found =>
    getComputedStyle(found, '::after').content.replaceAll('"', ''))"""


def _value(visitor: Visitor, curve: str) -> str:
    return visitor.page.evaluate(TOLD, f'[data-curve="{curve}"] .rn-v')[0]


def _hidden(visitor: Visitor) -> int:
    """How many plots of errors do not show their σ. The page lists a plot that is described anew as its last."""
    found = f"{CHARTS}.filter(chart => chart.series.some(series => series.label === 'σ by P' && !series.show))"
    return visitor.page.evaluate(f"() => {found}.length")


def test_a_window_is_drawn_across_a_plot_and_a_click_goes_to_a_moment(wide: Visitor):
    area = wide.page.locator('[data-plot="position"]').locator("xpath=following::div[@class='u-over'][1]")
    box = area.bounding_box()
    assert box is not None
    duration, middle = preset.load("paper-slow").duration, box["y"] + box["height"] / 2

    def at(share: float) -> tuple[float, float]:
        return box["x"] + share * box["width"], middle

    wide.page.mouse.move(*at(0.6))
    wide.page.mouse.down()
    wide.page.mouse.move(*at(0.2), steps=4)
    drawn = wide.page.evaluate("() => document.querySelector('.rn-brush').getBoundingClientRect().width")
    assert drawn == pytest.approx(0.4 * box["width"], abs=2)
    wide.page.mouse.up()
    until(
        lambda: float(wide.number("time window judged δ (s)")) == pytest.approx(0.4 * duration, abs=0.2), "the window"
    )
    wide.page.mouse.click(*at(0.75))
    until(lambda: f"<b>{0.75 * duration:.0f}." in wide.page.content(), "the moment")
    assert wide.page.evaluate("() => document.querySelector('.rn-brush').getBoundingClientRect().width") == 0


def test_hovering_tells_time_and_values_in_every_plot_and_an_entry_hides_its_curve(wide: Visitor):
    seen = compute(Settings(preset=preset.load("paper-slow"))).at_rest
    area = wide.page.locator('[data-plot="position"]').locator("xpath=following::div[@class='u-over'][1]")
    box = area.bounding_box()
    assert box is not None
    before = _value(wide, "position-0")
    wide.page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + box["height"] / 2)
    until(lambda: wide.page.evaluate(TOLD, ".rn-at")[0].endswith(" s"), "the time under the mouse")
    time.sleep(0.5)
    times = set(wide.page.evaluate(TOLD, ".rn-at"))
    assert len(times) == 1  # all plots tell the same
    moment = float(times.pop().removesuffix(" s"))
    assert moment == pytest.approx(0.25 * seen.preset.duration, abs=seen.preset.duration / box["width"])
    k = int(np.searchsorted(seen.motion.time, moment))
    near = {significant(error) for error in seen.errors.position[k - 3 : k + 4]}
    assert _value(wide, "position-0") in near
    gramian = next(plot for plot in plot_list.OBSERVABILITY.plots if plot.name == "gramian").draw(seen)
    row = int(np.searchsorted(gramian.time, moment + 1e-9)) - 1
    assert significant(gramian.values[row, 0]) == _value(wide, "gramian-0")
    assert gramian.values[row, 0] < 1e-3  # which uPlot's own legend would call 0

    wide.page.locator('[data-curve="position-1"]').click()
    until(lambda: _hidden(wide) == 1, "the curve to go")
    until(lambda: _value(wide, "position-0") == before, "the values at the playhead")
    assert wide.page.evaluate(TOLD, ".rn-at")[0] == "none"
    wide.tab("Gains")
    data = wide.chart_data("σ by P")
    wide.nudge("range weight q (1/(m⁴ s))", "ArrowLeft", times=3)
    until(lambda: wide.chart_data("σ by P") != data, "another picture")
    assert _hidden(wide) == 1
    wide.tab("Export")
    time.sleep(0.5)
    wide.press("Download Python")
    wide.wait_for_text("record.run(p)")
    time.sleep(0.5)
    wide.page.locator('[data-curve="position-1"]').click()
    until(lambda: _hidden(wide) == 0, "the curve to come back")


def _shown(visitor: Visitor, curve: str) -> list[list[float | None]]:
    """All columns of the plot that has this curve; none while the page has no such plot."""
    return visitor.chart_data(curve) if any(curve in labels for labels in visitor.chart_labels()) else []


def test_plots_follow_when_their_tab_is_opened_and_not_before(visitor: Visitor):
    innovation, error = "(y − ŷ)/σ", "σ by P"
    visitor.tab("Signals")
    until(lambda: len((_shown(visitor, innovation) or [[]])[0]) > 2, "the signals of the first picture")
    signals = _shown(visitor, innovation)
    visitor.tab("Errors")
    visitor.tab("Gains")
    for fold in (False, True):
        errors = _shown(visitor, error)
        if fold:
            visitor.page.get_by_label("Collapse panel area").first.click()
            time.sleep(0.5)
        visitor.nudge("range weight q (1/(m⁴ s))", "ArrowLeft", times=2)
        if fold:
            visitor.page.get_by_label("Expand column").first.click()
        until(lambda errors=errors: _shown(visitor, error) not in ([], errors), "the errors of another picture")
        assert _shown(visitor, innovation) in ([], signals)
    visitor.tab("Signals")
    until(lambda: _shown(visitor, innovation) not in ([], signals), "the signals of the picture on the page")
