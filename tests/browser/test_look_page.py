"""The look of the page, measured in the browser: contrast of every text, sizes of big type, and the large view."""

import time

import pytest
from playwright.sync_api import Browser

from tests.browser.axe import UNREACHED, broken
from tests.browser.page import CHARTS, COARSE, Server, Visitor

CONTRAST = """() => {
    const context = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
    const mixed = new Map();  // to read a pixel takes longer than all the rest
    const over = (color, below) => {
        const key = color + below;
        if (!mixed.has(key)) mixed.set(key, paint(color, below));
        return mixed.get(key);
    };
    const paint = (color, below) => {
        context.fillStyle = `rgb(${below.join()})`; context.fillRect(0, 0, 1, 1);
        context.fillStyle = color; context.fillRect(0, 0, 1, 1);
        return [...context.getImageData(0, 0, 1, 1).data].slice(0, 3);
    };
    const light = rgb => {
        const [r, g, b] = rgb.map(c => c / 255).map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const dark = document.documentElement.dataset.mantineColorScheme === 'dark';
    const grounds = new Map([[null, dark ? [36, 36, 36] : [255, 255, 255]]]);
    const behind = element => {
        if (!grounds.has(element))
            grounds.set(element, over(getComputedStyle(element).backgroundColor, behind(element.parentElement)));
        return grounds.get(element);
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
SEEN = """() => {
    const seen = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const add = (element, text, box) => {
        const inside = box.bottom > 0 && box.top < innerHeight && box.right > 0 && box.left < innerWidth;
        const drawn = element.checkVisibility({opacityProperty: true, visibilityProperty: true});
        if (text.trim() && box.width > 1 && inside && drawn && !['STYLE', 'SCRIPT', 'TITLE'].includes(element.tagName))
            seen.push([text.trim().slice(0, 40), parseFloat(getComputedStyle(element).fontSize)]);
    };
    while (walker.nextNode()) {
        const range = document.createRange();
        range.selectNodeContents(walker.currentNode);
        add(walker.currentNode.parentElement, walker.currentNode.textContent, range.getBoundingClientRect());
    }
    document.querySelectorAll('input').forEach(box => add(box, box.value, box.getBoundingClientRect()));
    for (const chart of CHARTS) for (const axis of chart.axes)
        seen.push([chart.series[1].label, parseFloat(axis.font[0]) / devicePixelRatio]);
    return seen;
}""".replace("CHARTS", CHARTS)
"""Every text in sight with the size of its letters (px), numbers in boxes and at the axes of plots included."""
TICKS = """() => CHARTS.flatMap(chart => chart.axes.map(axis => {
    const numbers = axis.stroke(chart, 0).match(/[0-9a-f]{2}/gi).map(digits => parseInt(digits, 16) / 255);
    const linear = numbers.map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
    const light = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
    const page = document.documentElement.dataset.mantineColorScheme === 'dark' ? 0.0176 : 1;
    const contrast = (Math.max(light, page) + 0.05) / (Math.min(light, page) + 0.05);
    return [chart.series[1].label, Math.round(100 * contrast) / 100];
})).filter(([, contrast]) => contrast < 4.5)""".replace("CHARTS", CHARTS)
"""Numbers at the axes of plots with less than 4.5:1."""
ROWS_OF_TABS = """() => new Set([...document.querySelectorAll('[data-dock-region=right] [role=tab]')]
    .map(tab => Math.round(tab.getBoundingClientRect().y))).size"""
LEAST = 18.0
"""px: at 6 m from a projector's picture of 2 m, an arc of 10 minutes."""
CONTROLS = "[data-dock-region=right]"
OF_COLOURS = ("link-in-text-block",)
"""What else than contrast, which `is_legible` measures, axe may find on a dark page that obeys its rules when light."""
TABS = ("Motion", "World", "Sensors", "Gains", "Presets", "Compare", "Studies", "Export")


@pytest.fixture(scope="module")
def projected(server: Server, browser: Browser):
    """The page in big type."""
    tab = Visitor(browser, f"{server.url}?present", density=COARSE)
    tab.dismiss_notifications()
    tab.page.wait_for_function("() => document.documentElement.classList.contains('rn-is-big')")
    yield tab
    tab.close()


def is_legible(tab: Visitor, where: str) -> None:
    """Every text in sight is large and stands out, at the latest when its theme has faded in."""
    deadline = time.monotonic() + 2.0
    while True:
        small = [text for text, size in tab.page.evaluate(SEEN) if size < LEAST]
        poor = tab.page.evaluate(CONTRAST) + tab.page.evaluate(TICKS)
        if not small and not poor:
            return
        assert time.monotonic() < deadline, (where, small, poor)


@pytest.mark.parametrize(("scheme", "width", "height"), [("light", 1366, 768), ("dark", 1920, 1080)])
def test_every_text_in_big_type_can_be_read_from_the_back_of_a_room(
    projected: Visitor, scheme: str, width: int, height: int
):
    page = projected.page
    page.set_viewport_size({"width": width, "height": height})
    page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
    page.wait_for_function(f"() => document.documentElement.dataset.mantineColorScheme === '{scheme}'")
    for tab in TABS:
        projected.tab(tab)
        is_legible(projected, tab)
        if scheme == "light":
            assert broken(page, CONTROLS, but=("color-contrast",)) == set(), tab  # `is_legible` has measured it
            assert page.evaluate(UNREACHED) == [], tab
        else:
            assert broken(page, CONTROLS, only=OF_COLOURS) == set(), tab
    assert page.evaluate(ROWS_OF_TABS) == 1
    projected.press("All answers")
    is_legible(projected, "the verdict unfolded")
    projected.press("All answers")
    if width == 1920:  # the plots are in sight
        projected.tab("Observability")
        is_legible(projected, "plots")
        projected.press("Large view: PE eigenvalues")
        projected.wait_for_text("window start (s)")
        is_legible(projected, "a large plot")
        projected.press("✕ close")
        projected.tab("Errors")


def test_the_switch_of_big_type_has_two_ways(projected: Visitor):
    small = f"() => ({SEEN})().some(([, size]) => size < {LEAST})"
    projected.press("Big type")
    projected.page.wait_for_function(small)
    projected.press("Big type")
    projected.page.wait_for_function(f"() => !({small})()")


def test_a_plot_opens_large_with_its_title_and_can_be_saved(visitor: Visitor):
    visitor.press("Large view: Position error")
    visitor.page.wait_for_function(
        "() => { const plot = document.querySelector('.mantine-Modal-content .uplot');"
        " return plot && plot.clientWidth > 1000 && plot.clientHeight > 400 }"
    )
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
