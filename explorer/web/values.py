"""What a browser may do to the controls of its page: set their values, and nothing else. Checked against viser 1.1.1.

viser sets whatever field of a control a browser names, and keeps texts of any length.
"""

import logging
import time
from typing import Any

import viser
from viser import _messages

from explorer.model import palette
from explorer.web.bucket import Bucket
from explorer.web.limits import MAX_MESSAGE

MAX_HELD = MAX_MESSAGE
"""Characters, or bytes of numbers, in all controls of one tab together."""
LONG = 10_000
"""The length from which on a value is counted."""
COMPLAINTS = (10.0, 1.0)
"""Values that are refused with a notice and a line in the log: at once, and per second after that. More are refused in
silence."""
UNUSED_MESSAGES = (
    _messages.FileTransferStartUpload,
    _messages.FileTransferPart,
    _messages.GuiFormDirtyMessage,
    _messages.GuiFormSubmitMessage,
)

log = logging.getLogger(__name__)


def accept_values_only(client: viser.ClientHandle) -> None:
    """Let this client set only the values of its own controls and the poses of its own gizmos.

    The client is notified when it sends anything else for a control."""
    connection = client.gui._websock_interface
    (update,) = connection._incoming_handlers[_messages.GuiUpdateMessage]
    complaints = Bucket(*COMPLAINTS, COMPLAINTS[0], time.monotonic())

    async def checked(client_id: Any, message: _messages.GuiUpdateMessage) -> None:
        try:
            if set(message.updates) != {"value"}:
                raise ValueError("only a control's value may be set")
            _require_room(client.gui, message.uuid, message.updates["value"])
            await update(client_id, message)  # type: ignore[misc]
        except (ValueError, TypeError, AssertionError, OverflowError) as error:
            if complaints.wait(time.monotonic()) > 0:
                return
            complaints.take()
            log.warning("client %s sent an invalid value for a control: %s", client_id, type(error).__name__)
            client.add_notification(
                "⚠ Not a value", "That control takes another kind of value.", color=palette.NOTIFY_ERROR
            )

    connection.unregister_handler(_messages.GuiUpdateMessage)
    connection.register_handler(_messages.GuiUpdateMessage, checked)  # type: ignore[arg-type]
    drop_unused(client.gui)


def drop_unused(gui: viser.GuiApi) -> None:
    """Refuse the messages of viser's forms and uploads.

    The page has no forms, and viser passes their messages on to every other visitor. viser collects uploads without
    limit, as the value of any control; `web.uploads` handles them for its own buttons."""
    for message in UNUSED_MESSAGES:
        gui._websock_interface.unregister_handler(message)


def _require_room(gui: viser.GuiApi, uuid: str, value: object) -> None:
    """Raise ValueError if a long value does not fit beside those that the controls of this tab hold already."""
    if _length(value) < LONG:
        return
    others = (handle.value for other, handle in gui._gui_input_handle_from_uuid.items() if other != uuid)
    if _length(value) + sum(map(_length, others)) > MAX_HELD:
        raise ValueError("too much text")


def _length(value: object) -> int:
    """Characters of a text, or bytes of a list of numbers."""
    if isinstance(value, str):
        return len(value)
    return 8 * len(value) if isinstance(value, list | tuple | dict) else 0
