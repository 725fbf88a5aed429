"""What the tests of the page share: a page without a browser."""

from collections.abc import Iterator

import pytest
import viser

from tests.support.sent_messages import Page


@pytest.fixture
def page() -> Iterator[Page]:
    """Remembers every message that a server would send to its one visitor."""
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield Page(server)
    server.stop()
