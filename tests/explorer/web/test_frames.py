"""One moment of a playing run leaves as one frame: its bytes are viser's, and no change is lost or comes too late."""

import asyncio
import time
from typing import Any, cast

import msgspec
import numpy as np
import pytest
import viser
import zstandard
from viser import _messages
from viser.infra import Message
from viser.infra._async_message_buffer import AsyncMessageBuffer
from viser.infra._infra import _message_producer
from viser.transforms import SO3
from websockets.protocol import State

from explorer.scene.bounds import quaternion
from explorer.web.clock import Clock
from explorer.web.frames import MOVES, Frames, Packer, place, post, turn
from explorer.web.security import CHECKED_AGAINST
from tests.support import own_loop

HEADER = 8
EACH: tuple[Message, ...] = (
    _messages.SetPositionMessage("/a", (1.0, 2.0, 3.0)),
    _messages.SetOrientationMessage("/a", (1.0, 0.0, 0.0, 0.0)),
    _messages.SetSceneNodeVisibilityMessage("/a", cast(bool, np.True_)),
    _messages.SceneNodeUpdateMessage("/a", {"points": np.arange(12, dtype=np.float32).reshape(2, 2, 3)}),
    _messages.SceneNodeUpdateMessage("/a", {"scale": (1.0, 2.0, 3.0)}),
    _messages.SceneNodeUpdateMessage("/b", {"points": np.arange(5, dtype=np.uint8)}),
    _messages.GuiUpdateMessage("uuid", {"content": "µ"}),
)


def unpacked(frame: bytes) -> tuple[dict[str, Any], bytes]:
    """The messages of a frame without the time, and the arrays behind them."""
    size, packed = (int.from_bytes(frame[k : k + HEADER], "little") for k in (0, HEADER))
    inner = zstandard.ZstdDecompressor().decompress(frame[2 * HEADER : 2 * HEADER + packed])
    assert len(inner) == size
    said = msgspec.msgpack.decode(inner)
    assert isinstance(said.pop("timestampSec"), float)
    return said, frame[2 * HEADER + packed :]


def sent_by_viser(messages: tuple[Message, ...]) -> bytes:
    """What viser's own producer writes to a websocket."""
    frames: list[bytes] = []

    async def run() -> None:
        buffer = AsyncMessageBuffer(asyncio.get_running_loop(), persistent_messages=True)

        class Socket:
            async def send(self, data: bytes) -> None:
                frames.append(data)
                buffer.set_done()

        for message in messages:
            buffer.push(message)
        await _message_producer(cast(Any, Socket()), buffer, 0)

    own_loop.run(run())
    (frame,) = frames
    return frame


def test_a_frame_says_what_viser_would_have_said() -> None:
    assert viser.__version__ == CHECKED_AGAINST
    assert {type(message) for message in EACH} == MOVES
    theirs, arrays = unpacked(sent_by_viser(EACH))
    ours, our_arrays = unpacked(Packer()(EACH))
    assert ours | {"messages": []} == theirs | {"messages": []}
    assert ours["messages"] == theirs["messages"]
    assert our_arrays.lstrip(b"\0") == arrays.lstrip(
        b"\0"
    )  # they begin at a multiple of eight bytes: zeros before them


class Socket:
    """The connection of a browser, which may lag behind."""

    def __init__(self) -> None:
        self.state, self.waiting, self.frames = State.OPEN, 0, []
        self.protocol, self.transport = self, self

    def send_binary(self, data: bytes) -> None:
        self.frames.append(unpacked(data)[0]["messages"])

    def send_data(self) -> None: ...

    def get_write_buffer_size(self) -> int:
        return self.waiting


class Loop:
    """viser's loop, which gets to its work when a test says so."""

    def __init__(self) -> None:
        self.due: list[tuple[Any, ...]] = []

    def call_soon_threadsafe(self, *call: Any) -> None:
        self.due.append(call)

    def run(self) -> None:
        for call, *arguments in self.due:
            call(*arguments)
        self.due.clear()


class Client:
    """As much of a client as frames need."""

    def __init__(self) -> None:
        self._websock_connection = self._websock_server = self._viser_server = self
        self._background_event_loop, self.client_id, self.queued = Loop(), 7, []
        self.socket = Socket()
        self._live_connections = {7: self.socket}
        self.message_counter, self.generator_cursors = 0, {7: -1}

    def queue_message(self, message: Message) -> None:
        self.queued.append(message)

    def get_message_buffer(self) -> "Client":
        return self

    def assign(self, value: str) -> None:
        self.queue_message(_messages.GuiUpdateMessage("cursor", {"content": value}))

    @property
    def cursors(self) -> list[str]:
        """What the browser was sent in frames."""
        return [message["updates"]["content"] for frame in self.socket.frames for message in frame]

    @property
    def queue(self) -> list[str]:
        """What was sent by viser's queue."""
        return [message.updates["content"] for message in self.queued]


@pytest.fixture
def tab() -> Client:
    return Client()


@pytest.fixture
def frames(tab: Client) -> Frames:
    return Frames(cast(Any, tab))


def leave(frames: Frames) -> None:
    frame = frames.packed()
    post([] if frame is None else [frame], 0.0, lambda lateness: None)


def draw(frames: Frames, tab: Client, *values: str) -> None:
    with frames.collecting():
        for value in values:
            tab.assign(value)
    leave(frames)


def test_the_latest_of_a_moment_leaves_in_one_frame(tab: Client, frames: Frames) -> None:
    draw(frames, tab, "1", "2")
    assert not frames.ready
    tab._background_event_loop.run()
    assert frames.ready
    assert (tab.cursors, tab.queue) == (["2"], [])
    tab.assign("3")
    assert tab.queue == ["3"]


@pytest.mark.parametrize("reason", ["a picture waits", "the browser is slow", "the tab has left"])
def test_a_dropped_frame_moves_with_the_next_or_by_the_queue(tab: Client, frames: Frames, reason: str) -> None:
    if reason == "a picture waits":
        tab.message_counter = 1
    elif reason == "the browser is slow":
        tab.socket.waiting = 1
    else:
        tab._live_connections.clear()
    draw(frames, tab, "1")
    tab._background_event_loop.run()
    assert tab.cursors == []
    tab.message_counter, tab.socket.waiting, tab._live_connections = 0, 0, {7: tab.socket}
    with frames.collecting():
        pass  # nothing has moved since
    leave(frames)
    tab._background_event_loop.run()
    assert tab.cursors == ["1"]
    tab.socket.waiting = 1
    draw(frames, tab, "2")
    tab._background_event_loop.run()
    frames.finish()
    assert tab.queue == ["2"]


def test_a_frame_that_is_refused_after_the_pause_goes_by_the_queue(tab: Client, frames: Frames) -> None:
    draw(frames, tab, "1")
    frames.finish()
    tab.socket.waiting = 1
    tab._background_event_loop.run()
    assert (tab.cursors, tab.queue) == ([], ["1"])
    frames.finish()
    assert tab.queue == ["1"]


def test_what_was_assigned_later_is_not_overtaken_by_a_dropped_frame(tab: Client, frames: Frames) -> None:
    draw(frames, tab, "old")
    tab.assign("new")
    tab.message_counter = 1
    tab._background_event_loop.run()
    tab.message_counter = 0
    draw(frames, tab)
    frames.finish()
    assert (tab.cursors, tab.queue) == ([], ["new"])


def test_a_removed_control_is_not_written_to(tab: Client, frames: Frames) -> None:
    draw(frames, tab, "old")
    tab.queue_message(_messages.GuiRemoveMessage("cursor"))
    tab.socket.waiting = 1
    tab._background_event_loop.run()
    frames.finish()
    assert [type(message) for message in tab.queued] == [_messages.GuiRemoveMessage]


def test_a_node_stands_where_it_was_placed_and_is_not_told_twice(page: Any) -> None:
    node = page.scene.add_frame("/moved")
    page.messages.clear()
    for _ in range(2):
        place(node, np.array([1.0, 2.0, 3.0]))
        turn(node, (0.0, 1.0, 0.0, 0.0))
    assert [type(message).__name__ for message in page.messages] == ["SetPositionMessage", "SetOrientationMessage"]
    assert node.position.tolist() == [1.0, 2.0, 3.0]
    assert node.wxyz.tolist() == [0.0, 1.0, 0.0, 0.0]
    node.position = (1.0, 2.0, 3.0)  # viser's own setter knows it
    assert len(page.messages) == 2


def test_the_quaternion_turns_as_the_matrix_does() -> None:
    chance = np.random.default_rng(3)
    half_turns = [np.diag(signs) for signs in ((1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0))]
    for rotation in [np.eye(3), *half_turns, *(SO3.sample_uniform(chance).as_matrix() for _ in range(50))]:
        assert np.allclose(SO3(np.array(quaternion(rotation))).as_matrix(), rotation, atol=1e-12)


def test_the_clock_draws_whoever_plays_and_rests_when_nobody_does() -> None:
    class Player:
        def __init__(self) -> None:
            self.plays, self.frames = True, 0

        def frame(self, now: float) -> None:
            self.frames += 1

    clock, one, other = Clock(), Player(), Player()
    clock.follow(one)
    clock.follow(other)
    clock.follow(one)
    deadline = time.monotonic() + 10
    while min(one.frames, other.frames) < 2 and time.monotonic() < deadline:
        time.sleep(0.01)
    other.plays = False
    assert abs(one.frames - other.frames) <= 1
    stopped, one.frames = other.frames, 0
    while one.frames < 3 and time.monotonic() < deadline:
        time.sleep(0.01)
    assert other.frames <= stopped + 1
    one.plays = False
    time.sleep(0.2)
    still = one.frames
    time.sleep(0.1)
    assert one.frames == still
    one.plays = True
    clock.follow(one)
    while one.frames == still and time.monotonic() < deadline:
        time.sleep(0.01)
    assert one.frames > still
    one.plays = False
