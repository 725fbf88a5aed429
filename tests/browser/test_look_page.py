"""The look of the page, measured in the browser: contrast of every text, sizes of big type, and the large view."""

import time

import pytest
from playwright.sync_api import Browser

from tests.browser.page import COARSE, Server, Visitor

CONTRAST = """() => {
    const context = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
    const over = (color, below) => {
        context.fillStyle = `rgb(${below.join()})`; context.fillRect(0, 0, 1, 1);
        context.fillStyle = color; context.fillRect(0, 0, 1, 1);
        return [...context.getImageData(0, 0, 1, 1).data].slice(0, 3);
    };
    const light = rgb => {
        const [r, g, b] = rgb.map(c => c / 255).map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const dark = document.documentElement.dataset.mantineColorScheme === 'dark';
    const behind = element => {
        const parents = [];
        for (let one = element; one; one = one.parentElement) parents.unshift(one);
        const page = dark ? [36, 36, 36] : [255, 255, 255];
        return parents.reduce((rgb, one) => over(getComputedStyle(one).backgroundColor, rgb), page);
    };
    const poor = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
        const text = walker.currentNode.textContent.trim(), element = walker.currentNode.parentElement;
        if (!text || ['STYLE', 'SCRIPT', 'TITLE'].includes(element.tagName)) continue;
        if (!element.checkVisibility({opacityProperty: true, visibilityProperty: true})) continue;
        const below = behind(element);
        let front = over(getComputedStyle(element).color, below);
        let opacity = 1;
        for (let one = element; one; one = one.parentElement) opacity *= parseFloat(getComputedStyle(one).opacity);
        front = front.map((c, i) => opacity * c + (1 - opacity) * below[i]);
        const [high, low] = [light(front), light(below)].sort((a, b) => b - a);
        const contrast = (high + 0.05) / (low + 0.05);
        if (contrast < 4.5) poor.push([text.slice(0, 40), Math.round(100 * contrast) / 100]);
    }
    return poor;
}"""
"""Texts with less than 4.5:1 (WCAG 2.2, 1.4.3) against what is behind them."""
SMALL = """() => [
        ...document.querySelectorAll('label, [role=tab], .rn-title b, .rn-legend button, .rn-layer span, .rn-line')
    ].filter(one => one.textContent.trim() && one.checkVisibility())
    .map(one => [one.textContent.trim().slice(0, 30), parseFloat(getComputedStyle(one).fontSize)])
    .filter(([_, size]) => size < 18)"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_can_be_read_in_both_themes(visitor: Visitor, scheme: str):
    visitor.page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
    theme = f"() => document.documentElement.dataset.mantineColorScheme === '{scheme}'"
    visitor.page.wait_for_function(theme)
    for tab in ("Motion", "Gains", "Presets"):
        visitor.tab(tab)
        visitor.page.mouse.move(700, 300)
        time.sleep(0.5)
        assert visitor.page.evaluate(CONTRAST) == []


def test_big_type_is_big_and_a_link_asks_for_it(server: Server, browser: Browser):
    tab = Visitor(browser, f"{server.url}?present", width=1920, height=1080, density=COARSE)
    tab.page.wait_for_function("() => document.documentElement.classList.contains('rn-is-big')")
    tab.page.wait_for_function(f"() => ({SMALL})().length === 0")
    tab.press("Big type")
    tab.page.wait_for_function(f"() => ({SMALL})().length > 0")
    tab.close()


def test_a_plot_opens_large_with_its_title_and_can_be_saved(visitor: Visitor):
    visitor.press("Large view: Position error")
    visitor.page.wait_for_function("() => document.querySelector('.rn-large')")
    large = visitor.page.locator(".mantine-Modal-content .uplot").bounding_box()
    assert large is not None
    assert large["width"] > 1000
    assert large["height"] > 400
    with visitor.page.expect_download() as coming:
        visitor.page.get_by_role("button", name="PDF", exact=True).click()
    assert coming.value.suggested_filename == "paper-slow-position.pdf"
    assert coming.value.path().read_bytes().startswith(b"%PDF")
    visitor.page.keyboard.press("Escape")
    visitor.page.wait_for_function("() => !document.querySelector('.rn-large')")


def test_an_entry_of_the_legend_hides_its_layer_and_is_remembered(visitor: Visitor):
    shown = "() => window.__viserMutable.nodeRefFromName['/path'].visible"
    assert visitor.page.evaluate(shown)
    visitor.press("true path")
    visitor.page.wait_for_function(f"() => !({shown})()")
    visitor.reload()
    visitor.page.wait_for_function(f"() => !({shown})()")
    visitor.press("true path")
    visitor.page.wait_for_function(shown)
