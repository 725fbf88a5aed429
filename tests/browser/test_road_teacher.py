"""The teacher's road: the printed condition against the derived one on a hover, side by side, dark and in big type; one
plot fills the screen and is saved as PDF, and the scene as PNG. At most twelve actions."""

import io
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Browser, Download

from tests.browser.page import CHARTS, COARSE, Server, Visitor

MOST_ACTIONS = 12
AREAS = ".mantine-Modal-content .u-over"
SIDE_BY_SIDE = f"""() => {{
    const boxes = [...document.querySelectorAll('{AREAS}')].map(area => area.getBoundingClientRect());
    const axes = {CHARTS}.slice(-2).map(chart => [chart.scales.y.min, chart.scales.y.max].join());
    const [left, right] = boxes;
    const alike = (one, other) => Math.abs(one - other) < 1;
    return boxes.length === 2 && alike(left.top, right.top) && alike(left.width, right.width) && left.right < right.left
        && right.bottom < innerHeight && axes[0] === axes[1] && axes[0].endsWith(',1000');
}}"""
"""Two plots of the same size at the same height, both in sight and on the same axes."""
PRINTED_AT_MOUSE = """() => {
    const style = getComputedStyle(document.documentElement), text = style.getPropertyValue('--excitation-a-4');
    return style.getPropertyValue('--rn-at-time') && parseFloat(text.replaceAll('"', '')) > 1;
}"""
"""The printed λ₁ of A stands in its legend, above the required 1 m²/s⁷."""


class Teacher:
    """A visitor who counts what they click."""

    def __init__(self, visitor: Visitor) -> None:
        self.visitor, self.actions = visitor, 0

    def do(self, name: str, *arguments: object) -> None:
        """One action."""
        self.actions += 1
        getattr(self.visitor, name)(*arguments)

    def download(self, button: str) -> Download:
        """What a button saves; one action."""
        self.actions += 1
        with self.visitor.page.expect_download() as coming:
            self.visitor.page.get_by_role("button", name=button, exact=True).click()
        return coming.value


@pytest.fixture(scope="module")
def visitor(server: Server, browser: Browser):
    tab = Visitor(browser, server.url, density=COARSE)
    tab.dismiss_notifications()
    yield tab
    assert tab.complaints == []
    tab.close()


def test_printed_against_derived_side_by_side_large_and_as_files(visitor: Visitor):
    teacher, page = Teacher(visitor), visitor.page
    teacher.do("press", "Dark or light")
    teacher.do("press", "Big type")
    teacher.do("tab", "Presets")
    teacher.do("folder", "As printed in the paper")
    teacher.do("press", "Printed against derived, on a hover")
    visitor.wait_for_text("✓ holds: printed μ 16")
    text = visitor.text()
    assert "A · Turning hover, as printed" in text
    assert "B · Turning hover, as derived" in text
    assert "✕ fails: derived μ 0 m²/s⁷ (required: 1)" in text
    assert "5 of 13\t5 of 13" in text
    page.wait_for_function(SIDE_BY_SIDE)
    page.locator(AREAS).first.hover()
    page.wait_for_function(PRINTED_AT_MOUSE)

    teacher.do("press", "A and B in one plot")
    page.wait_for_function(
        f"() => {{ const areas = [...document.querySelectorAll('{AREAS}')];"
        "return areas.length === 1 && areas[0].getBoundingClientRect().width > 0.75 * innerWidth }"
    )
    visitor.wait_for_text("PE eigenvalues")
    visitor.wait_for_text("A printed λ₁")
    plot = teacher.download("PDF")
    assert plot.suggested_filename == "turning-hover-excitation.pdf"
    assert plot.path().read_bytes().startswith(b"%PDF")
    teacher.do("press", "✕ close")
    teacher.do("tab", "Export")
    scene = teacher.download("Scene as PNG")
    assert Image.open(io.BytesIO(Path(scene.path()).read_bytes())).width > 300
    assert teacher.actions <= MOST_ACTIONS, teacher.actions
