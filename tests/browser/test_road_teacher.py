"""The teacher's road: the printed condition against the derived one on a hover, side by side, dark and in big type; one
plot fills the screen and is saved as PDF, and the scene as PNG. At most twelve actions."""

import io
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Browser, Download

from tests.browser.page import CHARTS, COARSE, Server, Visitor

MOST_ACTIONS = 12
LAST_CHARTS = f"() => {CHARTS}.slice(-2).map(chart => chart.bbox ? [chart.scales.y.min, chart.scales.y.max] : null)"
AREAS = ".mantine-Modal-content .u-over"


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
    assert "✕ fails: derived μ 0 of 1 m²/s⁷" in text
    assert "5 of 13\t5 of 13" in text
    page.wait_for_function(f"() => document.querySelectorAll('{AREAS}').length === 2")
    left, right = (area.bounding_box() for area in page.locator(AREAS).all())
    assert left is not None
    assert right is not None
    assert left["y"] == right["y"]
    assert left["x"] + left["width"] < right["x"]
    assert right["y"] + right["height"] < 768
    first, second = page.evaluate(LAST_CHARTS)
    assert first == second  # on the same axes
    page.mouse.move(left["x"] + left["width"] / 2, left["y"] + left["height"] / 2)
    page.wait_for_function("() => getComputedStyle(document.documentElement).getPropertyValue('--rn-at-time')")
    shown = "() => getComputedStyle(document.documentElement).getPropertyValue('--excitation-a-4').replaceAll('\"', '')"
    assert float(page.evaluate(shown)) > 1.0  # the printed λ₁ at the mouse, above the required 1 m²/s⁷

    teacher.do("press", "A and B in one plot")
    page.wait_for_function(f"() => document.querySelectorAll('{AREAS}').length === 1")
    large = page.locator(AREAS).bounding_box()
    assert large is not None
    assert large["width"] > 0.75 * 1366
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
