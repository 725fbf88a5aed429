"""Keyboard and readers of the screen: the rules of axe-core, the way of the keyboard, and what is spoken."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from explorer.web.access.entrance import DOOR
from tests.browser.axe import broken
from tests.browser.page import BLUR, Visitor, until

DOCUMENTED = Path(__file__).parents[2] / "docs" / "accessibility.md"
SPOKEN = "[aria-live=polite].rn-unseen"


def documented() -> set[str]:
    """The rules that the page about accessibility says viser's own markup breaks."""
    return set(re.findall(r"^\| `([a-z-]+)` \|", DOCUMENTED.read_text(encoding="utf-8"), re.MULTILINE))


@pytest.fixture
def still(visitor: Visitor) -> Iterator[Visitor]:
    """The page for a visitor whose system asks for little motion."""
    visitor.page.emulate_media(reduced_motion="reduce")
    yield visitor
    visitor.page.emulate_media(reduced_motion="no-preference")


def test_lesson_card_and_large_plot_obey_the_rules_also_on_a_dark_page_in_big_type(visitor: Visitor):
    page = visitor.page
    visitor.tab("Learn")
    visitor.press("Help")
    page.emulate_media(color_scheme="dark")
    visitor.press("Big type")
    visitor.press("1 · One range")
    visitor.wait_for_text("A drone hovers")
    page.wait_for_timeout(300)
    assert broken(page) == set()
    visitor.press("leave")
    visitor.press("Help")
    visitor.press("Big type")
    page.emulate_media(color_scheme="light")
    visitor.press("Large view: Position error")
    page.wait_for_selector(".rn-large")
    assert broken(page, ".mantine-Modal-content") == set()
    page.keyboard.press("Escape")
    page.wait_for_selector(".rn-large", state="detached")


def test_what_visers_own_menus_break_is_what_the_documentation_says(visitor: Visitor):
    page, rules = visitor.page, tuple(documented())
    visitor.tab("Presets")
    visitor.beside("preset").locator("input").first.click()
    page.get_by_role("option").first.wait_for()
    menus = {rule.partition(":")[0] for rule in broken(page, only=rules)}
    page.keyboard.press("Escape")
    page.evaluate(BLUR)
    page.keyboard.press("Control+k")
    page.get_by_role("dialog").get_by_role("textbox").wait_for()
    palette = {rule.partition(":")[0] for rule in broken(page, only=("aria-dialog-name", *rules))}
    page.keyboard.press("Escape")
    assert palette <= menus == set(rules)


def test_folders_controls_and_lessons_are_worked_by_the_keyboard(still: Visitor):
    page = still.page
    still.tab("Motion")
    head = page.locator(".mantine-Paper-root[role=button]").filter(visible=True).first
    opened = head.get_attribute("aria-expanded")
    head.focus()
    page.keyboard.press("Enter")
    until(lambda: head.get_attribute("aria-expanded") != opened, "the folder")
    page.keyboard.press("Space")
    until(lambda: head.get_attribute("aria-expanded") == opened, "the folder as before")
    assert page.evaluate("getComputedStyle(document.querySelector('button')).transitionDuration") in (
        "0.00001s",
        "1e-05s",
    )
    still.tab("Gains")
    weight = page.get_by_role("slider", name="range weight q")
    weight.focus()
    page.keyboard.press("ArrowRight")
    until(lambda: (weight.get_attribute("aria-valuetext") or "").startswith("5"), "the number itself")
    assert weight.get_attribute("aria-description")
    still.tab("Learn")
    page.get_by_role("button", name="1 · One range").focus()
    page.keyboard.press("Enter")
    still.wait_for_text("A drone hovers")
    page.get_by_role("button", name="Next ›").focus()
    page.keyboard.press("Enter")
    still.wait_for_text("2 / 8")
    assert page.evaluate("document.activeElement.tagName") == "H2"  # the next one waits for a prediction
    until(lambda: "screen 2 of 8" in page.locator(SPOKEN).inner_text(), "the spoken heading")
    still.press("leave")
    play = page.get_by_role("button", name="Play or pause (space)")
    for state in ("playing", "paused"):
        play.focus() if state == "playing" else None
        page.keyboard.press("Enter")
        still.wait_for_text(state)
        assert page.evaluate("document.activeElement.dataset.rnEvent") == "play"
    page.keyboard.press("Home")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("ArrowRight")
    until(lambda: "At 0.05 s" in page.locator(SPOKEN).inner_text(), "the moment, spoken")


def test_the_door_of_a_class_obeys_the_rules(browser: Browser, tmp_path: Path):
    door = tmp_path / "door.html"
    door.write_text(DOOR.read_text(encoding="utf-8").replace("SENTENCE", "This code is not right."), encoding="utf-8")
    context = browser.new_context()
    page = context.new_page()
    page.goto(door.as_uri())
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
        assert broken(page) == set(), scheme
    context.close()
