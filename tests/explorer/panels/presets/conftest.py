"""A visitor of the Presets tab with an empty library, who can reload the page."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from explorer.server import SessionServer
from explorer.storage.library import Library
from tests.support.waiting_visitor import Editing, arrived


@pytest.fixture
def data(tmp_path: Path, sessions: tuple[int, SessionServer]) -> Library:
    """An empty library for this test's visitors."""
    library = Library(tmp_path / "presets")
    object.__setattr__(sessions[1].shared, "library", library)
    return library


@pytest.fixture
def page(sessions: tuple[int, SessionServer], data: Library) -> Iterator[Editing]:
    visitor = arrived(sessions)
    yield visitor
    visitor.tab.close()


@pytest.fixture
def reloaded(page: Editing, sessions: tuple[int, SessionServer]) -> Iterator[Callable[[], Editing]]:
    """A function that closes the page and opens it again in the same browser, with its storage."""
    later: list[Editing] = []

    def reload() -> Editing:
        session = page.session
        page.tab.close()
        page.tab.wait_for(lambda: not session.thread.is_alive(), "the end of the session")
        later.append(arrived(sessions, page.tab.storage))
        return later[0]

    yield reload
    for one in later:
        one.tab.close()
