"""What a press does, in the order of the presses, and what the session writes between two messages of a visitor.

viser 1.1.1 gives a plain function to one of several threads. Until that thread runs, a later press may have changed the
value that the function reads, and two presses may change places. A coroutine runs before the next message is read.

The session's own thread may write a control at the very moment when the visitor moves it, and what was moved is lost.
A function that viser's event loop runs has the time to look first, because no message is read meanwhile.
"""

from collections.abc import Callable, Coroutine
from typing import Any

import viser

from explorer.web.connection import may_close

Handler = Callable[[Any], Coroutine[Any, Any, None]]


def in_order(receive: Callable[[Any], None]) -> Handler:
    """The handler of an event, for `on_click` and `on_trigger`. `receive` only notes the event, and takes no time."""

    async def handler(event: Any) -> None:
        receive(event)

    return handler


def in_turn(gui: viser.GuiApi, write: Callable[[], object]) -> None:
    """Have viser's event loop call `write` between two messages of the visitor; it takes no time."""

    def in_loop() -> None:
        with may_close(gui):
            write()

    gui._event_loop.call_soon_threadsafe(in_loop)
