"""A visitor without a browser who costs little: many of them share one process, and decode only what they wait for.

Speaks viser 1.1.1's messages. While nothing is awaited, a message of the server is counted and not unpacked.
"""

import asyncio
import math
import time
from typing import Any

import msgspec
import viser
import zstandard
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Origin, Subprotocol

from rangenav.number_format import UNBROKEN
from tests.support.wire import CAMERA, HEADER

GAIN, POSITIONS = "range weight q (1/(m⁴ s))", (1.0, 3.0)
"""The slider, and the powers of ten between which it is dragged."""
READY = "of 13</b>, nonlinear"
"""On the page once the first picture has been drawn."""
IN_SIGHT = "width=1366&height=768&plots=position+velocity+gravity+attitude&tabs=errors+gains"
"""What a browser reports of a window of this size."""
PATIENCE = 10.0
"""s after which a picture has not come."""


class Visitor:
    """One tab."""

    def __init__(self, port: int) -> None:
        self._port, self._socket = port, None
        self._ids: dict[str, str] = {}
        """Ids of the controls and commands, by their labels."""
        self._ready = asyncio.Event()
        self._attends = True
        """Whether messages are unpacked: while the page is built, and while a picture is awaited."""
        self._box = ""
        self._waiting: list[tuple[float, float]] = []
        """When each event was sent (s), and the value that it has set; the oldest first."""
        self.waits: list[float] = []
        """ms from each event that was answered to its picture, or to a later one."""
        self.messages = self.bytes = self.pictures = self.lost = 0
        """Messages and bytes that came, pictures that answered, and events that nothing answered."""
        self.closed = ""
        """Why the server closed the connection; empty if it did not."""

    async def join(self) -> None:
        """Connect, and wait for the first picture."""
        self._socket = await connect(
            f"ws://127.0.0.1:{self._port}/",
            origin=Origin(f"http://127.0.0.1:{self._port}"),
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            max_size=None,
            compression=None,
        )
        self._listener = asyncio.create_task(self._listen(self._socket))
        await self._send(CAMERA)
        await asyncio.wait_for(self._ready.wait(), 10 * PATIENCE)
        await self._set("page", IN_SIGHT)
        self._box = self._ids[f"{GAIN}: number"]
        self._attends = False

    async def play(self) -> None:
        """Play, or pause."""
        await self._send({"type": "CommandTriggerMessage", "uuid": self._ids["Play or pause"]})

    async def drag(self, events: int, seconds: float, start: float) -> None:
        """Move the gain's slider in equal steps, from a share of its way on, and wait for the last picture."""
        self._attends = True
        low, high = POSITIONS
        for k in range(events):
            position = round(low + (high - low) * ((start + k / events) % 1.0), 2)
            self._waiting.append((time.perf_counter(), 10.0**position))
            await self._set(GAIN, position)
            await asyncio.sleep(seconds / events)
        deadline = time.perf_counter() + PATIENCE
        while self._waiting and time.perf_counter() < deadline:
            await asyncio.sleep(0.01)
        self.lost += len(self._waiting)
        self._waiting.clear()
        self._attends = False

    async def leave(self) -> None:
        """Close the tab."""
        if self._socket is not None:
            await self._socket.close()
            await self._listener

    async def _set(self, label: str, value: Any) -> None:
        await self._send({"type": "GuiUpdateMessage", "uuid": self._ids[label], "updates": {"value": value}})

    async def _send(self, message: dict[str, Any]) -> None:
        assert self._socket is not None
        await self._socket.send(msgspec.msgpack.encode(message))

    async def _listen(self, socket: ClientConnection) -> None:
        unpack = zstandard.ZstdDecompressor()
        try:
            async for frame in socket:
                assert isinstance(frame, bytes)
                self.messages += 1
                self.bytes += len(frame)
                if self._attends:
                    size = int.from_bytes(frame[HEADER : 2 * HEADER], "little")
                    packed = unpack.decompress(frame[2 * HEADER : 2 * HEADER + size])
                    now, self._answers = time.perf_counter(), False
                    for message in msgspec.msgpack.decode(packed)["messages"]:
                        await self._take_in(message, now)
                    if self._answers:
                        self._answer(now)
        except ConnectionClosed as reason:
            self.closed = str(reason)

    async def _take_in(self, message: dict[str, Any], now: float) -> None:
        name = message["type"]
        if name == "GuiUpdateMessage":
            updates = message["updates"]
            if message["uuid"] == self._box and "value" in updates:
                self._shown, self._answers = float(updates["value"]), True
            if "data" in updates:
                self._drawn_at, self._answers = now, True
            if READY in str(updates.get("content", "")).replace(UNBROKEN, " "):
                self._ready.set()
        elif name == "RegisterCommandMessage":
            self._ids[message["props"]["label"]] = message["uuid"]
        elif name == "LocalStorageGetItemRequestMessage":
            answer = {"value": None, "error": None, "request_uuid": message["request_uuid"]}
            await self._send({"type": "LocalStorageGetItemResponseMessage", **answer})
        elif name.startswith("Gui") and message.get("props", {}).get("label"):
            self._ids.setdefault(message["props"]["label"], message["uuid"])

    _shown, _drawn_at, _answers = math.nan, -math.inf, False
    """The value in the box beside the slider, when (s) a plot was drawn last, and whether the frame had one of them.
    The box follows the picture, in the same frame or in the next one."""

    def _answer(self, now: float) -> None:
        """The picture of the value in the box has come: it answers the event of that value, and those before it."""
        close = [
            k
            for k, (sent, value) in enumerate(self._waiting)
            if sent < self._drawn_at and math.isclose(value, self._shown, rel_tol=2e-3)
        ]
        if close:
            answered, self._waiting = self._waiting[: close[-1] + 1], self._waiting[close[-1] + 1 :]
            self.waits += [1e3 * (now - sent) for sent, _ in answered]
            self.pictures += 1
