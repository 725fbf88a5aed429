"""A dock of controls without a session: the test itself calls `refresh` and `read`."""

from collections.abc import Iterator

import pytest
import viser

from explorer.model.history import History
from explorer.model.jobs import Jobs
from explorer.panels.dock import Dock
from explorer.panels.session_actions import SessionActions
from explorer.storage.catalog import Catalog
from explorer.storage.certifier import Certifier
from explorer.storage.library import Library
from explorer.web.security import open_server
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from tests.support.page_settings import SHIPPED
from tests.support.wire import Wire


def _nothing() -> None:
    """For a button that no test presses."""


def _nothing_sent(name: str, content: bytes) -> None:
    """For a download that no test asks for."""


def _nothing_shown(title: str, sentence: str) -> None:
    """For a notification that no test reads."""


def _nowhere(label: str) -> None:
    """For a control that no test is led to."""


@pytest.fixture(scope="module")
def connection() -> Iterator[tuple[Wire, viser.ClientHandle]]:
    """A visitor without a browser, and the client that a server of the module's own has for it."""
    server = open_server("127.0.0.1", 0)
    visitor = Wire(server.get_port())
    visitor.wait_for(server.get_clients, "the connection")
    (connected,) = server.get_clients().values()
    yield visitor, connected
    visitor.close()
    server.stop()


@pytest.fixture(scope="module")
def visitor(connection: tuple[Wire, viser.ClientHandle]) -> Wire:
    """Who is connected."""
    return connection[0]


@pytest.fixture(scope="module")
def client(connection: tuple[Wire, viser.ClientHandle]) -> viser.ClientHandle:
    """A connected client."""
    return connection[1]


@pytest.fixture(scope="module")
def dock(client: viser.ClientHandle) -> Dock:
    """A dock that shows `paper-slow` at first."""
    actions = SessionActions(
        restart_preset=_nothing,
        show_paper_figures=_nothing,
        show_side_by_side=_nothing,
        download_preset=_nothing,
        send=_nothing_sent,
        go_to_place=lambda _place: None,
        rewind=_nothing,
        notify=_nothing_shown,
        go_to=_nowhere,
    )
    catalog, jobs = Catalog(SHIPPED, Library(), Certifier()), Jobs(_nothing)
    return Dock(Form(client.gui, _nothing), catalog, "paper-slow", actions, jobs, History())


@pytest.fixture(scope="module")
def section(client: viser.ClientHandle) -> Section:
    """A section of a form of its own."""
    return Section(Form(client.gui, _nothing))
