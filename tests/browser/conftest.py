"""A server and a browser for a file of tests; and what every browser test needs."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from tests.browser.page import COARSE, Server, Visitor, chromium, served, why_not


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Everything in this folder drives a browser, and is skipped where there is none."""
    for item in items:
        if "tests/browser" in item.path.as_posix():
            item.add_marker(pytest.mark.browser)
            item.add_marker(pytest.mark.skipif(why_not() is not None, reason=str(why_not())))


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    """The command as a user starts it."""
    with served() as running:
        yield running


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """A headless Chromium."""
    with chromium() as running:
        yield running


@pytest.fixture(scope="session")
def narrow_page(server: Server, browser: Browser) -> Iterator[Visitor]:
    """One page for all tests: to load it takes longer than most of them."""
    tab = Visitor(browser, server.url, density=COARSE)
    tab.dismiss_notifications()
    yield tab
    tab.close()


@pytest.fixture(scope="session")
def wide_page(server: Server, browser: Browser) -> Iterator[Visitor]:
    """One page for all tests, on a screen that has all plots on view."""
    tab = Visitor(browser, server.url, width=1920, height=1080, density=COARSE)
    tab.dismiss_notifications()
    yield tab
    tab.close()


@pytest.fixture
def visitor(narrow_page: Visitor, request: pytest.FixtureRequest) -> Iterator[Visitor]:
    """That page with the first preset as it is shipped; it must not complain."""
    narrow_page.begin_anew(request.session.testsfailed)
    yield narrow_page
    assert narrow_page.complaints == []


@pytest.fixture
def wide(wide_page: Visitor, request: pytest.FixtureRequest) -> Iterator[Visitor]:
    """That page with all plots on view, with the first preset as it is shipped; it must not complain."""
    wide_page.begin_anew(request.session.testsfailed)
    yield wide_page
    assert wide_page.complaints == []
