"""What a press does, in the order of the presses: what viser calls at once, and not in a thread of its pool.

viser 1.1.1 gives a plain function to one of several threads. Until that thread runs, a later press may have changed the
value that the function reads, and two presses may change places. A coroutine runs before the next message is read.
"""

from collections.abc import Callable, Coroutine
from typing import Any

Handler = Callable[[Any], Coroutine[Any, Any, None]]


def in_order(receive: Callable[[Any], None]) -> Handler:
    """The handler of an event, for `on_click` and `on_trigger`. `receive` only notes the event, and takes no time."""

    async def handler(event: Any) -> None:
        receive(event)

    return handler
