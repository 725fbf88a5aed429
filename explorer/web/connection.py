"""A page is drawn in a thread of its own, so its tab may leave at any moment, also in the middle of a picture.

viser 1.1.1 warns of a message to a closed connection once per tab, because the message will never be delivered. Here
nobody is left to read it.
"""

from contextlib import AbstractContextManager

import viser
from viser import _messages

AT_ONCE = 2048
"""Messages in a batch at most. Each batch is drawn by itself; viser's own 128 would cut a new page into a dozen."""


def send_in_large_batches(client: viser.ClientHandle) -> None:
    """Let what is sent within `client.atomic()` arrive as one batch, also a whole page."""
    client.gui._websock_interface.get_message_buffer().max_window_size = AT_ONCE


def may_close(gui: viser.GuiApi) -> AbstractContextManager[None]:
    """Within it, messages to the tab of these controls are dropped without a warning once its connection is closed."""
    return gui._websock_interface.get_message_buffer().sanctioned_dead_writes()


def run_script(client: viser.ClientHandle, script: str) -> None:
    """Run statements in the browser; they may fail, as where storage is refused (checked against viser 1.1.1)."""
    source = f"try {{ {script} }} catch (refused) {{ console.info(String(refused)) }}"
    client._websock_connection.queue_message(_messages.RunJavascriptMessage(source))
