"""What the browser reports comes through the door as values; what no browser of ours would write is ignored."""

from collections.abc import Iterator

import pytest

from explorer.model import layers
from explorer.web.door import Door, Window
from explorer.web.security import open_server
from tests.support.wire import Wire


@pytest.fixture(scope="module")
def door() -> Iterator[Door]:
    """The door of a connected browser."""
    server = open_server("127.0.0.1", 0)
    visitor = Wire(server.get_port())
    visitor.wait_for(server.get_clients, "the connection")
    (client,) = server.get_clients().values()
    door = Door(client, lambda: None)
    yield door
    visitor.close()
    server.stop()


def test_a_report_is_a_window_and_each_press_counts_once(door: Door) -> None:
    report = "width=911&height=512&flags=dark+big&switched=tail&query=preset%3Dhover&event=5:undo&event=6:play"
    door.receive(report)
    door.receive(report)
    assert door.window == Window(
        width=911,
        height=512,
        flags=frozenset({"dark", "big"}),
        switched=frozenset({"tail"}),
        query="preset=hover",
    )
    assert door.take_events() == ["undo", "play"]
    assert door.take_events() == []


@pytest.mark.parametrize(
    ("said", "plots", "tabs"),
    [
        ("", None, None),
        ("&plots=snap+rank-by-length&tabs=in-depth", frozenset({"snap", "rank-by-length"}), frozenset({"in-depth"})),
        ("&plots=none&tabs=none", frozenset({"none"}), frozenset({"none"})),
        ("&plots=%3Cb%3E", frozenset(), None),
    ],
)
def test_what_is_in_sight_is_known_once_the_browser_has_named_it(
    door: Door, said: str, plots: frozenset[str] | None, tabs: frozenset[str] | None
) -> None:
    door.receive("width=911&height=512" + said)
    assert door.window is not None
    assert (door.window.plots, door.window.tabs) == (plots, tabs)


@pytest.mark.parametrize(
    "text", ["", "width=0&height=512", "width=nan&height=512", "width=911", "height=512&width=99999999", "\x00" * 5000]
)
def test_a_report_without_a_size_is_ignored(door: Door, text: str) -> None:
    before = door.window
    door.receive(text + "&event=99:undo")
    assert door.window is before
    assert door.take_events() == []


def test_names_that_are_none_are_left_out(door: Door) -> None:
    door.receive("width=911&height=512&flags=dark+%3Cb%3E&event=1000:%3Cscript%3E&event=x:undo")
    assert door.window is not None
    assert door.window.flags == {"dark"}
    assert door.take_events() == []


def test_a_layer_that_is_switched_twice_is_as_at_first_and_unknown_ones_do_not_matter() -> None:
    assert layers.hidden(frozenset()) == layers.AT_FIRST
    assert layers.hidden(frozenset({"tail"})) == layers.AT_FIRST | {"tail"}
    assert "vectors" not in layers.hidden(frozenset({"vectors", "nonsense"}))
