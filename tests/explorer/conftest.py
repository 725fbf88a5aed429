"""What the tests of the page share: a page without a browser."""

from collections.abc import Iterator

import pytest
import viser

from explorer.web import array_types
from tests.support.sent_messages import Page


@pytest.fixture
def page() -> Iterator[Page]:
    """A page that records every message which the server would send to a visitor."""
    array_types.build_once()
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield Page(server)
    server.stop()
