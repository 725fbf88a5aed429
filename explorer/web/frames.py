"""One moment of a playing run: all that moves leaves as one frame of the websocket. Checked against viser 1.1.1.

viser sends each assigned property through a queue, and serializes each message by its type hints: most of a frame's
time went there. Here the properties are assigned as ever, and their messages are collected, packed once, and written:

with frames.collecting(): scene.move(...)     the messages of what has changed
post([frames.packed(), …])                    one wake of viser's loop for the frames of several tabs:
                                              written, if nothing else waits for the browser; else dropped

A picture, or bytes that the browser has not taken yet, come first. What a dropped frame would have moved goes with the
next one, or by viser's queue once the run is paused (`finish`): no change is lost, and none overtakes a later one.
"""

import asyncio
import contextlib
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np
import viser
import zstandard
from jaxtyping import Float
from numpy import ndarray as Array
from viser import _messages
from viser.infra import Message
from viser.infra._infra import _append_aligned_buffers
from viser.infra._messages import _prepare_for_serialization, wire_field_names
from websockets.protocol import State

MOVES = frozenset(
    (
        _messages.SetPositionMessage,
        _messages.SetOrientationMessage,
        _messages.SetSceneNodeVisibilityMessage,
        _messages.SceneNodeUpdateMessage,
        _messages.GuiUpdateMessage,
    )
)
"""The types of messages that assign a property: of two of the same property, the later one alone counts."""
PAYLOAD = 4096
"""Bytes of a frame's messages, roughly: the memory of the compressor is chosen for it."""
HEADER = 8
"""Bytes of each of the two sizes that begin a frame."""

Key = tuple[str, str, tuple[str, ...]]
"""What a message assigns: its type, the node or control, and the names of the properties."""


def place(node: viser.SceneNodeHandle, position: Float[Array, "3"]) -> None:
    """Assign a node's position (m), as `node.position = position` does at ten times the cost."""
    state, (x, y, z) = node._impl, position.tolist()
    if state.position.tolist() != [x, y, z]:
        state.position[:] = position
        state.api._queue_scene_message(_messages.SetPositionMessage(state.name, (x, y, z)))


def turn(node: viser.SceneNodeHandle, wxyz: tuple[float, float, float, float]) -> None:
    """Assign a node's rotation, as `node.wxyz = wxyz` does at ten times the cost."""
    state = node._impl
    if state.wxyz.tolist() != [*wxyz]:
        state.wxyz[:] = wxyz
        state.api._queue_scene_message(_messages.SetOrientationMessage(state.name, wxyz))


@dataclass(eq=False)
class Flight:
    """A frame on its way."""

    frames: "Frames"
    moved: dict[Key, Message]
    data: bytes
    left: bool | None = None
    """Whether it was written; None until viser's loop has looked."""
    last: bool = False
    """Whether no other frame follows."""
    lock: threading.Lock = field(default_factory=threading.Lock)


class Frames:
    """The frames of one tab."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._connection, self._server = client._websock_connection, client._viser_server._websock_server
        self._pack = Packer()
        self._collector = 0
        """The thread whose messages are collected now; 0 for none."""
        self._moved: dict[Key, Message] = {}
        """Messages that were collected, and are not on their way yet."""
        self._flight: Flight | None = None
        self._queue = self._connection.queue_message
        self._connection.queue_message = self._take  # type: ignore[method-assign]

    @property
    def ready(self) -> bool:
        """Whether another frame may be made: the last one has left, or was dropped."""
        return self._flight is None or self._flight.left is not None

    @contextlib.contextmanager
    def collecting(self) -> Iterator[None]:
        """Within it, what this thread assigns is collected for the next frame."""
        self._collector = threading.get_ident()
        try:
            yield
        finally:
            self._collector = 0

    def packed(self) -> Flight | None:
        """The collected messages as one frame, to be posted; None if there are none. Called only while `ready`."""
        self._land()
        if not self._moved:
            return None
        flight = self._flight = Flight(self, self._moved, self._pack(self._moved.values()))
        self._moved = {}
        return flight

    @property
    def loop(self) -> asyncio.AbstractEventLoop:
        """viser's loop, which is the same for all tabs of a server."""
        loop = self._server._background_event_loop
        assert loop is not None, "the server runs"
        return loop

    def finish(self) -> None:
        """Send by viser's queue what dropped frames would have moved, because no frame follows for now."""
        flight = self._flight
        if flight is not None:
            with flight.lock:
                flight.last = flight.last or flight.left is None
        self._land()
        moved, self._moved = self._moved, {}
        for message in moved.values():
            self._queue(message)

    def _land(self) -> None:
        """Collect again what a dropped frame would have moved, where nothing newer was collected."""
        if self._flight is not None and self._flight.left is not None:
            flight, self._flight = self._flight, None
            if not flight.left and not flight.last:
                self._moved = flight.moved | self._moved

    def leave(self, flight: Flight) -> None:
        """In viser's loop: write the frame, unless other messages for the browser wait."""
        tab, buffer = self._connection.client_id, self._connection.get_message_buffer()
        connection = self._server._live_connections.get(tab)
        waiting = buffer.generator_cursors.get(tab, -1) != buffer.message_counter - 1
        free = not waiting and connection is not None and connection.state is State.OPEN
        if free and connection is not None and connection.transport.get_write_buffer_size() == 0:
            connection.protocol.send_binary(flight.data)
            connection.send_data()
            flight.left = True
        else:
            with flight.lock:
                flight.left = False
                if flight.last:
                    for message in tuple(flight.moved.values()):
                        self._queue(message)

    def _take(self, message: Message) -> None:
        """What viser calls to send a message."""
        if self._collector == threading.get_ident() and type(message) in MOVES:
            self._moved[_key(message)] = message
            return
        for moved in (self._moved, self._flight.moved if self._flight is not None else {}):
            if moved:
                _supersede(moved, message)
        self._queue(message)


def post(flights: Sequence[Flight], late: float, observe: Callable[[float], None]) -> None:
    """Have frames written by viser's loop. `observe` is then called with their lateness (s): `late`, and how long the
    loop took to come to them."""
    if not flights:
        return
    posted = time.monotonic()

    def leave() -> None:
        observe(late + time.monotonic() - posted)
        for flight in flights:
            flight.frames.leave(flight)

    with contextlib.suppress(RuntimeError):  # the loop is closed
        flights[0].frames.loop.call_soon_threadsafe(leave)


class Packer:
    """Packs messages as viser does for its browser page; for one thread at a time."""

    def __init__(self) -> None:
        parameters = zstandard.ZstdCompressionParameters.from_level(1, source_size=PAYLOAD)
        self._compressor, self._encoder = (
            zstandard.ZstdCompressor(compression_params=parameters),
            msgspec.msgpack.Encoder(),
        )

    def __call__(self, messages: Iterable[Message]) -> bytes:
        """The bytes of one binary frame of the websocket."""
        arrays: list[memoryview] = []
        inner = self._encoder.encode(
            {
                "messages": [_fields(message, arrays) for message in messages],
                "timestampSec": time.perf_counter(),
                "binaryBufferLengths": [one.nbytes for one in arrays],
            }
        )
        compressed = self._compressor.compress(inner)
        parts: list[bytes | memoryview] = [
            len(inner).to_bytes(HEADER, "little"),
            len(compressed).to_bytes(HEADER, "little"),
            compressed,
        ]
        _append_aligned_buffers(parts, arrays, 2 * HEADER + len(compressed))
        return b"".join(parts)


def _fields(message: Message, arrays: list[memoryview]) -> dict[str, Any]:
    kind = type(message)
    fields = {name: _plain(getattr(message, name), arrays) for name in wire_field_names(kind)}
    if "updates" in fields:
        fields["updates"] = {name: _plain(value, arrays) for name, value in fields["updates"].items()}
    fields["type"] = kind.__name__
    return fields


def _plain(value: Any, arrays: list[memoryview]) -> Any:
    """A value as msgpack takes it; an array goes behind the messages."""
    return _prepare_for_serialization(value, Any, arrays) if isinstance(value, np.ndarray | np.generic) else value


def _key(message: Message) -> Key:
    fields = vars(message)
    entity = fields["uuid"] if "uuid" in fields else fields["name"]
    return type(message).__name__, entity, tuple(fields.get("updates", ()))


def _supersede(moved: dict[Key, Message], message: Message) -> None:
    """Drop the collected properties that a message which is sent now assigns anew, or removes."""
    if type(message) in MOVES:
        moved.pop(_key(message), None)
    elif message.entity_id_field is not None:
        entity = getattr(message, message.entity_id_field)
        for key in [key for key in moved if key[1] == entity]:
            del moved[key]
