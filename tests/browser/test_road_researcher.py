"""The researcher's road: the error dynamics of a preset, another gain, the run before beside it, many seeds, a plot for
a paper; in fifteen actions at most. And what a reload and the open preset's own entry in the menu do."""

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, Locator

from tests.browser.page import COARSE, PATIENCE, Server, Visitor, until

MOST_ACTIONS = 15
WEIGHT = "range weight q (1/(m⁴ s))"


class Researcher:
    """A visitor who counts what a person clicks, chooses or types."""

    def __init__(self, visitor: Visitor) -> None:
        self.visitor, self.actions = visitor, 0

    def tab(self, label: str) -> None:
        self.actions += 1
        self.visitor.tab(label)

    def choose(self, label: str, option: str) -> None:
        self.actions += 2  # the menu, and the entry
        self.visitor.choose(label, option)

    def press(self, label: str) -> None:
        self.actions += 1
        self.visitor.press(label)

    def type(self, label: str, text: str) -> None:
        self.actions += 1
        self.visitor.type_number(label, text)


@pytest.fixture(scope="module")
def visitor(server: Server, browser: Browser):
    """One page for these tests, whose scene is saved in the end."""
    tab = Visitor(browser, server.url, density=COARSE, drawn=True)
    tab.dismiss_notifications()
    yield tab
    tab.close()


def saved_by(visitor: Visitor, label: str) -> bytes:
    """The file that a button downloads."""
    with visitor.page.expect_download(timeout=PATIENCE * 1000) as coming:
        visitor.press(label)
    return Path(coming.value.path()).read_bytes()


def selected_tabs(visitor: Visitor) -> list[str]:
    tabs: Locator = visitor.page.locator("[role=tab][aria-selected=true]")
    return [text.strip() for text in tabs.all_inner_texts()]


def test_from_the_error_dynamics_of_a_preset_to_a_plot_of_two_gains_in_fifteen_actions(visitor: Visitor):
    researcher = Researcher(visitor)
    researcher.tab("Presets")
    researcher.choose("preset", "(lissajous)")
    researcher.tab("Convergence")
    visitor.wait_for_text("Without noise the position error")
    researcher.tab("Compare")
    researcher.press("Pin this run as A")
    visitor.wait_for_node("/pinned_trail")
    researcher.tab("Gains")
    researcher.type(WEIGHT, "500")
    visitor.wait_for_text(f"{WEIGHT} •")
    researcher.tab("Compare")
    visitor.wait_for_text("Range weight q: 5000 → 500")
    researcher.type("runs", "3")
    researcher.press("Run the noise seeds")
    visitor.wait_for_text("3 seeds of these settings")
    researcher.tab("Export")
    researcher.actions += 1
    table = saved_by(visitor, "CSV").decode().splitlines()
    assert researcher.actions <= MOST_ACTIONS
    assert table[0].startswith("t (s),error (m; log axis)")
    assert len(table) > 1000
    assert visitor.complaints == []


def test_a_reload_keeps_the_tabs_and_the_pinned_run_and_the_open_preset_can_be_chosen_anew(visitor: Visitor):
    visitor.reload()
    visitor.wait_for_node("/pinned_trail")
    until(lambda: selected_tabs(visitor) == ["Convergence", "Export"], "the tabs from before")
    visitor.tab("Presets")
    visitor.wait_for_text("• changed, not saved")
    visitor.choose("preset", "(lissajous)")
    visitor.wait_for_no_text("• changed, not saved")
    visitor.choose("preset", "(hover)")
    visitor.wait_for_text("5 of 13 quantities determined")
    visitor.tab("Compare")
    visitor.wait_for_text("Pin a run, change anything")  # A was gone with its preset


def test_the_scene_is_saved_as_a_picture_and_as_an_animation(visitor: Visitor):
    labels = visitor.page.evaluate("window.rnLabels")
    assert labels >= 2  # their letters and their ground follow the page's colours
    visitor.tab("Export")
    picture = np.asarray(Image.open(io.BytesIO(saved_by(visitor, "Scene as PNG"))))
    assert picture.shape[2] == 4
    assert 0 < (picture[..., 3] > 0).mean() < 1  # what is drawn, on a transparent background
    visitor.type_text("length of the animation (s)", "0.3")
    animation = Image.open(io.BytesIO(saved_by(visitor, "Animation as GIF")))
    assert animation.n_frames == 4  # type: ignore[attr-defined]
    assert visitor.complaints == []
