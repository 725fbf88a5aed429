"""Auto-tune and the basin of attraction in a real Chromium: stopped, run small, its result used, a globe of starts."""

from tests.browser.page import PATIENCE, Visitor


def _open(visitor: Visitor, section: str) -> None:
    visitor.tab("Gains")
    visitor.folder(section)


def _gains(visitor: Visitor) -> list[str]:
    return [
        visitor.number(label)
        for label in ("range weight q (1/(m⁴ s))", "attitude gain k1 (1/s)", "trust in gravity ρ2 (s⁴/m²)")
    ]


def test_a_search_is_stopped_and_another_is_run_small_and_used(wide: Visitor):
    _open(wide, "Auto-tune")
    before = _gains(wide)
    wide.type_number("sets of gains to try", "2000")
    wide.press("Tune the gains")
    wide.wait_for_text("Working:")
    wide.nudge("attitude gain k1 (1/s)", "ArrowRight")  # the page goes on meanwhile
    wide.wait_for_text("Working:")
    wide.nudge("attitude gain k1 (1/s)", "ArrowLeft")
    wide.press("Stop")
    wide.wait_for_no_text("Working:")
    assert "Picked" not in wide.text()
    assert _gains(wide) == before

    wide.type_number("runs per try", "2")
    wide.type_number("sets of gains to try", "30")
    wide.press("Tune the gains")
    wide.wait_for_text("Picked (found)")
    assert _gains(wide) == before  # nothing changes until it is asked for
    wide.type_number("place on the curve", "1")
    wide.press("Use these gains")
    wide.wait_for_text("On the page now.")
    assert _gains(wide) != before
    svg = (
        "() => [...document.querySelectorAll('svg[aria-label*=picked]')].map(svg => svg.getBoundingClientRect().right)"
    )
    rights = wide.page.evaluate(svg)
    assert len(rights) == 2
    assert max(rights) <= 1920  # not clipped by the dock
    wide.page.evaluate("() => document.activeElement.blur()")
    wide.page.keyboard.press("Control+z")
    wide.wait_for_no_text("On the page now.")
    assert _gains(wide) == before


def test_a_globe_of_starts_is_drawn_and_gone_when_a_gain_changes(wide: Visitor):
    _open(wide, "Basin of attraction")
    wide.type_number("number of axes", "60")
    wide.press("Start from all around")
    wide.wait_for_text("of 60 starts at 179° settle")
    wide.wait_for_node("/basin/settling")
    shown = "visible => window.__viserMutable.nodeRefFromName['/basin'].visible === visible"
    wide.page.wait_for_function(shown, arg=True, timeout=PATIENCE * 1000)
    across, down = wide.screen_position("/basin")
    assert 0 < across < 1920
    assert 0 < down < 1080
    wide.nudge("attitude gain k1 (1/s)", "ArrowRight")
    wide.page.wait_for_function(shown, arg=False, timeout=PATIENCE * 1000)
