"""Numbers are typed as numbers, keys belong to what has the focus, and the palette finds everything on the page."""

import re

from tests.browser.page import BLUR, Visitor, until

WEIGHT, NOISE = "range weight q (1/(m⁴ s))", "range noise σ (m)"
SEARCH = "input.mantine-Spotlight-search"


def test_a_weight_is_typed_as_the_number_that_it_is_and_nothing_is_cut(visitor: Visitor):
    visitor.tab("Gains")
    assert visitor.number(WEIGHT) == "5000"
    for text in ("5e2", "1 000", "700"):
        visitor.type_number(WEIGHT, text)
        until(lambda: visitor.page.get_by_text(f"{WEIGHT} •").count() > 0, "a mark of the change")
        assert visitor.number(WEIGHT) == text
    visitor.type_number(WEIGHT, "5 00")  # no group of three digits
    visitor.wait_for_text("is not a number")
    visitor.type_number(WEIGHT, "1e12")
    visitor.wait_for_text("range weight q must lie between 0.001 and 100000, got 1e12")
    visitor.page.evaluate(BLUR)
    assert visitor.number(WEIGHT) == "1e12"


def test_an_arrow_on_a_slider_moves_the_slider_and_not_the_time(visitor: Visitor):
    visitor.tab("Gains")
    visitor.nudge(WEIGHT, "ArrowRight", times=2)
    until(lambda: visitor.number(WEIGHT) == "5248", "two steps of the slider")
    assert "<b>0.00 s</b>" in visitor.page.content()
    visitor.page.evaluate(BLUR)
    visitor.page.keyboard.press("ArrowRight")
    until(lambda: "<b>0.00 s</b>" not in visitor.page.content(), "a step in time")


def _search(visitor: Visitor, words: str, entry: str) -> None:
    """Open the palette, type some words, and wait for an entry."""
    visitor.page.evaluate(BLUR)
    visitor.page.keyboard.press("Control+k")
    visitor.page.locator(SEARCH).fill(words)
    entries = visitor.page.locator(".mantine-Spotlight-action")
    until(lambda: entry in [re.sub(r"\s+", " ", text) for text in entries.all_inner_texts()], entry)


FOUND = {
    "gains": "Gains tab",
    "hover": "Preset: Hover (hover)",
    "position error": "Plot: Position error",
    "export attitude": "Export: the plot Attitude error",
    "range noise": f"Control: {NOISE}",
    "help": "Help: keys",
    "step on": "One step on in time →",
}
"""Words that are searched, and an entry that is found."""


def test_the_palette_finds_tabs_presets_plots_exports_controls_and_help_and_goes_there(visitor: Visitor):
    for words, entry in FOUND.items():
        _search(visitor, words, entry)
        visitor.page.keyboard.press("Escape")
        visitor.page.locator(SEARCH).wait_for(state="hidden")
    _search(visitor, "process noise V(p)", "Control: process noise V(p)")
    visitor.page.keyboard.press("Enter")
    focus = "() => document.activeElement.getAttribute('aria-label')"
    until(lambda: visitor.page.evaluate(focus) == "process noise V(p)", "the focus")


def test_of_a_number_that_is_typed_letter_by_letter_no_part_is_shown(visitor: Visitor):
    visitor.tab("Gains")
    curve = "σ by P"
    before = visitor.chart_data(curve)
    visitor.box(WEIGHT).first.click()
    visitor.page.keyboard.press("Control+a")
    visitor.page.keyboard.type("1e99", delay=60)
    visitor.wait_for_text("range weight q must lie between")
    assert visitor.chart_data(curve) == before  # and not that of q = 1
    visitor.page.keyboard.press("Control+a")
    visitor.page.keyboard.type("5e3", delay=60)
    visitor.page.keyboard.press("Enter")
    visitor.wait_for_no_text("range weight q must lie between")


TYPE_AT_ONCE = """entries => {
    const put = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set;
    entries.forEach(([box, text]) => { put.call(box, text); box.dispatchEvent(new Event('input', {bubbles: true})); });
}"""
"""As a page that is busy takes them: all inputs in one piece of its time, and no timer in between."""


def test_of_inputs_in_quick_succession_every_one_arrives(visitor: Visitor):
    typed = {axis: f"0.7{k}" for k, axis in enumerate("xyz", start=1)}
    entries = [[visitor.box(f"amplitude {axis} (m)").first.element_handle(), text] for axis, text in typed.items()]
    visitor.page.evaluate(TYPE_AT_ONCE, entries)
    for axis, text in typed.items():
        visitor.wait_for_text(f"{axis}: {text} m", timeout=10)  # a heading that the session has made of what arrived


def test_what_is_being_typed_stays_when_the_page_changes_meanwhile(visitor: Visitor):
    tones = visitor.page.get_by_text("− remove this tone")
    before = tones.count()
    visitor.box("amplitude x (m)").first.click()
    visitor.page.keyboard.press("Control+a")
    visitor.page.keyboard.type("0.77")
    visitor.page.evaluate("() => [...document.querySelectorAll('button')].find(one => one.innerText === '+ y').click()")
    until(lambda: tones.count() > before, "another tone")
    visitor.wait_for_text("x: 0.77 m", timeout=10)
    assert visitor.number("amplitude x (m)") == "0.77"
