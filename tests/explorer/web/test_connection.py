"""What viser keeps together on its way to a browser."""

import asyncio
from types import SimpleNamespace
from typing import Any, cast

from viser import _messages
from viser.infra._async_message_buffer import AsyncMessageBuffer

from explorer.web.connection import send_in_large_batches
from tests.support import own_loop

MESSAGES = 1000
"""A new page has some seven hundred."""


def first_window(*, large: bool) -> int:
    """How many messages viser puts into the first batch for a browser."""

    async def run() -> int:
        buffer = AsyncMessageBuffer(asyncio.get_running_loop(), persistent_messages=False)
        socket = SimpleNamespace(get_message_buffer=lambda: buffer)
        if large:
            send_in_large_batches(cast(Any, SimpleNamespace(gui=SimpleNamespace(_websock_interface=socket))))
        for k in range(MESSAGES):
            buffer.push(_messages.SetPositionMessage(f"/{k}", (0.0, 0.0, 0.0)))
        windows = buffer.window_generator(0)
        window = await anext(windows)
        buffer.set_done()
        await windows.aclose()
        return len(window)

    return own_loop.run(run())


def test_a_new_page_is_one_batch_which_viser_alone_would_cut() -> None:
    assert first_window(large=True) == MESSAGES
    assert first_window(large=False) < MESSAGES
