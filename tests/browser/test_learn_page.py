"""A link brings a lesson or settings, and a handout works from disk without a network."""

import re

import pytest
from playwright.sync_api import Browser

from explorer.handout import handout
from explorer.lessons import course, teaching
from explorer.model import share
from explorer.model.settings import Settings
from rangenav import preset
from tests.browser.axe import broken
from tests.browser.page import COARSE, Server, Visitor

LESSON = course().lessons[0]
ANOTHER = Settings(origin="soft", preset=preset.load("soft"), time_scale=1.75)
OTHER = Settings(origin="soft", preset=preset.load("soft"), time_scale=1.5)


@pytest.fixture(scope="module")
def visitor(server: Server, browser: Browser):
    tab = Visitor(browser, f"{server.url}?lesson={LESSON.number}", density=COARSE, says="determined")
    tab.dismiss_notifications()
    yield tab
    assert tab.complaints == []
    tab.close()


def test_a_link_with_a_lesson_opens_it_at_its_question(visitor: Visitor):
    visitor.wait_for_text(LESSON.header.title)
    visitor.wait_for_text("Can the drone know where it is?")


def test_a_link_on_an_open_page_asks_if_work_would_be_lost_and_a_reload_asks_no_more(visitor: Visitor):
    question = visitor.page.locator(".rn-question")
    follow(visitor, share.link_text(OTHER))
    visitor.wait_for_text("A link was opened")  # at once: there was nothing to lose
    follow(visitor, "abc")
    visitor.wait_for_text("The link is damaged")
    follow(visitor, share.link_text(ANOTHER))
    question.get_by_role("button", name="Stay here").click()
    question.wait_for(state="hidden")
    follow(visitor, share.link_text(ANOTHER))
    question.get_by_role("button", name="Open it").click()
    visitor.tab("Motion")
    visitor.wait_for_text("1.75 times as slow")
    visitor.reload()  # the address still names a lesson, which has been left
    visitor.wait_for_text("1.75 times as slow")
    assert not question.is_visible()


def follow(visitor: Visitor, link: str) -> None:
    """As if a link was opened in the tab that shows the page."""
    visitor.page.evaluate("fragment => { location.hash = fragment }", f"#s={link}")


def test_a_new_tab_opens_a_link_and_copies_its_own(server: Server, browser: Browser):
    tab = Visitor(browser, f"{server.url}?#s={share.link_text(OTHER)}", density=COARSE, says="▲ weak")
    tab.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    tab.press("Copy a link")
    tab.wait_for_text("Link copied")
    copied = tab.page.evaluate("navigator.clipboard.readText()")
    assert share.from_link(copied.partition("#s=")[2]).preset == OTHER.preset
    assert tab.complaints == []
    tab.close()


def test_the_worksheet_is_two_pages_of_paper(browser: Browser):
    page = browser.new_page()
    page.set_content(teaching.worksheet(course().lessons).decode())
    assert re.findall(rb"/Count (\d+)", page.pdf(format="A4")) == [b"2"]
    assert page.evaluate("[...document.querySelectorAll('.choices')].every(p => p.scrollWidth <= p.clientWidth)")
    page.close()


def test_a_handout_plays_scrubs_and_slides_from_disk_without_a_network(browser: Browser, tmp_path):
    path = tmp_path / "lesson.html"
    path.write_bytes(handout(LESSON.start.settings, ["gains.riccati.q"], lesson=LESSON))
    context, complaints = browser.new_context(viewport={"width": 400, "height": 800}, offline=True), []
    page = context.new_page()
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("request", lambda request: complaints.append(request.url) if request.url.startswith("http") else None)
    page.goto(path.as_uri())
    page.wait_for_function("document.querySelectorAll('#scene .main-svg').length > 0")
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
    assert not page.get_by_text("No program can tell").is_visible()
    page.locator(".choice").first.click()
    page.wait_for_function("document.querySelectorAll('#plots .main-svg').length > 0")  # after the prediction
    assert page.locator("#predicted").inner_text() == LESSON.header.prediction.choices[0]
    page.locator("#time").fill("120")
    now = page.locator("#now").inner_text()
    assert re.fullmatch(r"\d+\.\d\d s", now)
    page.locator("#play").click()
    page.wait_for_function("now => document.getElementById('now').textContent !== now", arg=now)
    page.locator("#play").click()
    page.locator("#time").fill("120")
    offset = page.locator("#offset").inner_text()
    page.locator("#sliders input").fill("0")
    page.wait_for_function("before => document.getElementById('offset').textContent !== before", arg=offset)
    assert re.search(
        r"vehicle is at \(.*\) m, [\d.]+ m from the anchor",
        page.locator("#scene[role=img]").get_attribute("aria-label") or "",
    )
    assert "at the end" in (page.locator("#plots [role=img]").first.get_attribute("aria-label") or "")
    assert broken(page) == set()
    assert complaints == []
    context.close()
