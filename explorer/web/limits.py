"""What one connection may send: so many messages and bytes a second, and no more; the rest waits in its own browser.

A page that is used sends up to 40 messages a second (a slider, the camera); each waits for nobody. A connection that
sends more is read more slowly, and holds up nobody but itself.
"""

import asyncio
import time
from typing import Any

from websockets.asyncio.server import ServerConnection

from explorer.web.bucket import Bucket

MAX_MESSAGE = 2**24
"""Bytes of one message from a browser; viser allows 50 MB. The page's own largest message is that of a text
box: a visitor who pastes ten megabytes should see a complaint, and not lose the connection."""
MESSAGES = (400.0, 100.0)
"""Messages at once, and per second after that."""
BYTES = (4.0 * MAX_MESSAGE, 2.0**22)
"""Bytes at once, and per second after that."""


class MeteredConnection(ServerConnection):
    """A connection that is read no faster than the limits allow."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        now = time.monotonic()
        self._meters = tuple(Bucket(size, rate, size, now) for size, rate in (MESSAGES, BYTES))

    async def recv(self, decode: bool | None = None) -> Any:
        """The next message, after the wait that its size costs."""
        message = await super().recv(decode)
        now = time.monotonic()
        wait = max(
            meter.charge(amount, now) for meter, amount in zip(self._meters, (1.0, float(len(message))), strict=True)
        )
        if wait > 0:
            await asyncio.sleep(wait)
        return message
