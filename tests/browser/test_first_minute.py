"""The first visit, windows that change their size, and a browser without WebGL."""

import time

from playwright.sync_api import Browser

from tests.browser.page import CHROMIUM, COARSE, PATIENCE, Server, Visitor

BOX = "selector => { const b = document.querySelector(selector).getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom] }"  # noqa: E501
TOOLS_IN_SIGHT = """selector => {
    const bar = document.querySelector('.rn-tools'), name = document.querySelector(selector);
    if (!bar) return false;
    const tools = bar.getBoundingClientRect(), text = document.createRange();
    if (name) text.selectNodeContents(name);
    const hidden = !name || getComputedStyle(name).visibility === 'hidden';
    const apart = hidden || text.getBoundingClientRect().right <= tools.left;
    return apart && tools.top >= 0 && tools.bottom <= innerHeight && tools.right <= innerWidth;
}"""
"""Whether undo, redo and help lie in the window and not on the name of the page."""
DETERMINED = "quantities determined"
"""In the verdict on every motion, also on a blind one."""
NAME = '[data-testid="floating-panel-handle"] > div > svg + div'
"""The name of the page, in the bar with the tools."""
SIZES = ((1366, 768), (1920, 1080), (911, 512), (400, 800))


def box(visitor: Visitor, selector: str) -> tuple[float, float, float, float]:
    left, top, right, bottom = visitor.page.evaluate(BOX, selector)
    return left, top, right, bottom


def test_a_new_visitor_is_welcomed_once_and_the_question_mark_brings_the_card_back(server: Server, browser: Browser):
    tab = Visitor(browser, server.url, density=COARSE, welcomed=False, says=DETERMINED)
    card = tab.page.get_by_role("dialog", name="Welcome")
    assert card.is_visible()
    tab.press("Learn")
    card.wait_for(state="hidden")
    tab.wait_for_text("5 of 13 quantities determined", PATIENCE)
    tab.wait_for_text("One range, many vehicles")  # the first lesson, in the tab that was opened
    tab.reload()
    assert not card.is_visible()
    tab.press("Help")
    card.wait_for(state="visible")
    tab.press("Tune")
    card.wait_for(state="hidden")
    tab.wait_for_text("Auto-tune")
    tab.page.set_viewport_size({"width": 390, "height": 844})  # a phone: the controls are a sheet, which takes taps
    tab.press("Help")
    card.get_by_label("Close").click()
    card.wait_for(state="hidden")
    tab.tab("World")
    tab.page.locator("[role=tab][aria-selected=true]", has_text="World").wait_for()
    assert tab.complaints == []
    tab.close()


def test_a_link_with_a_preset_opens_it_and_skips_the_card(server: Server, browser: Browser):
    tab = Visitor(browser, f"{server.url}?preset=circle", density=COARSE, welcomed=False, says=DETERMINED)
    tab.wait_for_text("nothing excites z", PATIENCE)
    assert not tab.page.get_by_role("dialog", name="Welcome").is_visible()
    tab.close()


def test_verdict_scene_timeline_and_controls_never_cover_each_other_while_the_window_changes(visitor: Visitor):
    for width, height in (*SIZES, SIZES[0]):
        visitor.page.set_viewport_size({"width": width, "height": height})
        deadline = time.monotonic() + PATIENCE
        while True:
            _, _, _, verdict = box(visitor, ".rn-verdict")
            left, top, right, bottom = box(visitor, "[data-dock-root] > :first-child")
            line_left, line_top, line_right, line_bottom = box(visitor, ".rn-transport")
            apart = verdict <= top + 1 and bottom <= line_top + 1 and line_bottom <= height + 1
            if apart and right - left > 250 and bottom - top > 180 and abs(line_left - left) < 25:
                break
            assert time.monotonic() < deadline, (
                width,
                height,
                verdict,
                top,
                bottom,
                line_top,
                line_bottom,
                left,
                right,
            )
            time.sleep(0.1)
        assert line_right <= right + 1
        visitor.page.wait_for_function(TOOLS_IN_SIGHT, arg=NAME, timeout=1000 * PATIENCE)
        for tool in ("Undo", "Redo", "Help"):
            assert visitor.page.get_by_role("button", name=tool, exact=True).is_visible()


def test_without_webgl_plots_controls_and_verdict_work_and_the_page_says_what_is_missing(
    server: Server, browser: Browser
):
    arguments = ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"]
    without = browser.browser_type.launch(executable_path=CHROMIUM, headless=True, args=arguments)
    tab = Visitor(without, server.url, drawn=True)  # nothing stands in for the WebGL that is missing
    assert "it has no WebGL" in tab.text()
    assert len(tab.chart_labels()) >= 4
    tab.tab("Presets")
    tab.choose("preset", "(circle)")
    tab.wait_for_text("nothing excites z")
    assert "ws://" not in tab.text()
    assert [one for one in tab.complaints if not one.startswith("THREE.")] == []
    without.close()
