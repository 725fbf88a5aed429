"""What one connection may send: so many messages and bytes a second, and none that viser's page does not send.

A page that is used sends up to 40 messages a second (a slider, the camera); each waits for nobody. A connection that
sends more is read more slowly, and holds up nobody but itself. A malformed frame is ignored, with one line in the log.
"""

import asyncio
import logging
import time
from typing import Any

from websockets.asyncio.server import ServerConnection

from explorer.web.bucket import Bucket
from explorer.web.incoming import fault

MAX_MESSAGE = 2**24
"""Bytes of one message from a browser; viser allows 50 MB. The page's own largest message is that of a text
box: a visitor who pastes ten megabytes should see a complaint, and not lose the connection."""
MESSAGES = (400.0, 100.0)
"""Messages at once, and per second after that."""
BYTES = (4.0 * MAX_MESSAGE, 2.0**22)
"""Bytes at once, and per second after that."""
MAX_MALFORMED = 20
"""Malformed frames after which a connection is ended: its program is none that belongs here."""
MALFORMED, MALFORMED_REASON = 1008, "too many malformed frames"
"""The code and the reason of that end."""
PING_PERIOD, PONG_TIMEOUT, CLOSE_TIMEOUT = 20.0, 20.0, 10.0
"""s between two pings, s in which a browser must answer one, and s in which it may agree to the end: after that a
connection is cut off that is half open, or whose browser reads nothing."""

log = logging.getLogger(__name__)


class MeteredConnection(ServerConnection):
    """A connection that is read no faster than the limits allow, and hands on no malformed frame."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        now = time.monotonic()
        self._meters = tuple(Bucket(size, rate, size, now) for size, rate in (MESSAGES, BYTES))
        self._malformed = 0

    async def recv(self, decode: bool | None = None) -> Any:
        """The next message, after the wait that its size costs."""
        while True:
            message = await self._received(decode)
            reason = fault(message)
            if reason is None:
                return message
            self._malformed += 1
            log.warning("a frame was ignored: %s", reason)
            if self._malformed >= MAX_MALFORMED:
                await self.close(MALFORMED, MALFORMED_REASON)  # the next call says that the connection is closed

    async def _received(self, decode: bool | None) -> Any:
        message = await super().recv(decode)
        now = time.monotonic()
        wait = max(
            meter.charge(amount, now) for meter, amount in zip(self._meters, (1.0, float(len(message))), strict=True)
        )
        if wait > 0:
            await asyncio.sleep(wait)
        return message
