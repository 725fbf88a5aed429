"""Uploads: one small file at a time from each visitor, and nothing about it is trusted. Checked against viser 1.1.1.

viser collects whatever a browser sends, for any control and without limit, and makes it that control's value. Here a
transfer is accepted only for a button made by `Uploads.button`, and only if it states a size that is small enough. It
must send exactly as many bytes as stated, with its parts in order. A transfer that stalls gives way to the next one.
The names of files are only displayed: no file is opened by its name.
"""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import viser
from viser import _messages

MAX_BYTES = 20_000_000
"""Of one file: some 100 000 lines of a log."""
MAX_PART = 2**20
"""Bytes of one part; viser's page sends half of that."""
MAX_PARTS = 64
MAX_TOGETHER = 4
"""Transfers at a time, over all visitors: they hold at most 80 MB."""
STALLED = 20.0
"""s without a part, after which a transfer is dropped."""
LONGEST_NAME = 80
Receive = Callable[[str, bytes], None]
"""Receives (name for display, content)."""


@dataclass(eq=False)
class Transfer:
    """One file that is being uploaded."""

    uuid: str
    button: str
    name: str
    size: int
    parts: int
    got: list[bytes] = field(default_factory=list)
    bytes: int = 0
    heard: float = field(default_factory=time.monotonic)


class Traffic:
    """Counts the transfers of all visitors; stalled ones do not count."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._heard: dict[int, float] = {}

    def enter(self, visitor: int) -> bool:
        """Whether this visitor may begin a transfer; it then counts."""
        now = time.monotonic()
        with self._lock:
            self._heard = {one: heard for one, heard in self._heard.items() if now - heard < STALLED}
            if len(self._heard) >= MAX_TOGETHER:
                return False
            self._heard[visitor] = now
            return True

    def hear(self, visitor: int) -> None:
        """A part of this visitor's file has arrived."""
        with self._lock:
            if visitor in self._heard:
                self._heard[visitor] = time.monotonic()

    def leave(self, visitor: int) -> None:
        """The transfer of this visitor has ended."""
        with self._lock:
            self._heard.pop(visitor, None)


TRAFFIC = Traffic()


class Uploads:
    """The upload buttons of one visitor, and the one transfer that may be running."""

    def __init__(self, gui: viser.GuiApi, do: Callable[[Callable[[], None]], None]) -> None:
        """`do` leaves an action for the session's loop."""
        self._gui, self._do = gui, do
        self._of: dict[str, tuple[Receive, Callable[[str], None]]] = {}
        self._transfer: Transfer | None = None
        wire = gui._websock_interface
        for message, handler in (
            (_messages.FileTransferStartUpload, self._start),
            (_messages.FileTransferPart, self._part),
        ):
            wire._incoming_handlers.pop(message, None)
            wire.register_handler(message, handler)  # type: ignore[arg-type]

    def button(self, label: str, receive: Receive, refuse: Callable[[str], None], *, hint: str) -> None:
        """A button that uploads a file. `receive`, or `refuse` with the reason, is called in the session's loop."""
        made = self._gui.add_upload_button(label, hint=hint)
        self._of[made._impl.uuid] = receive, refuse

    def _start(self, client: int, message: _messages.FileTransferStartUpload) -> None:
        button, size, parts = message.source_component_uuid, message.size_bytes, message.part_count
        if not isinstance(button, str) or button not in self._of or not isinstance(message.transfer_uuid, str):
            return
        stalled = self._transfer is not None and time.monotonic() - self._transfer.heard > STALLED
        if stalled:
            self._drop()
        name = readable(message.filename)
        reason = self._why_not(name, size, parts)
        if reason is not None:
            self._refuse(button, message.transfer_uuid, size, reason)
            return
        self._transfer = Transfer(message.transfer_uuid, button, name, size, parts)

    def _why_not(self, name: str, size: object, parts: object) -> str | None:
        """Why a file is refused; None if it is accepted, and it then counts."""
        if type(size) is not int or type(parts) is not int or size <= 0 or parts <= 0:
            return f"{name}: the file is empty"
        if size > MAX_BYTES:
            return f"{name}: {size / 1e6:.0f} MB, more than the {MAX_BYTES / 1e6:.0f} MB that are taken"
        if parts > min(MAX_PARTS, size):
            return f"{name}: {parts} parts of {size} bytes are no file"
        if self._transfer is not None:
            return f"{name}: another file is on its way"
        if not TRAFFIC.enter(id(self)):
            return f"{name}: {MAX_TOGETHER} files of others are on their way: try again in a moment"
        return None

    def _part(self, client: int, message: _messages.FileTransferPart) -> None:
        transfer, content = self._transfer, message.content
        if transfer is None or message.transfer_uuid != transfer.uuid:
            return
        fits = isinstance(content, bytes) and len(content) <= MAX_PART and message.part_index == len(transfer.got)
        if not fits or transfer.bytes + len(content) > transfer.size:
            self._drop()
            self._refuse(transfer.button, transfer.uuid, transfer.size, f"{transfer.name}: it did not arrive as sent")
            return
        transfer.got.append(content)
        transfer.bytes += len(content)
        transfer.heard = time.monotonic()
        TRAFFIC.hear(id(self))
        if len(transfer.got) == transfer.parts:
            self._finish(transfer)
        else:
            self._acknowledge(transfer.button, transfer.uuid, transfer.bytes, transfer.size)

    def _finish(self, transfer: Transfer) -> None:
        self._drop()
        if transfer.bytes != transfer.size:
            reason = f"{transfer.name}: {transfer.bytes} bytes came of {transfer.size}"
            self._refuse(transfer.button, transfer.uuid, transfer.size, reason)
            return
        receive, content = self._of[transfer.button][0], b"".join(transfer.got)
        self._acknowledge(transfer.button, transfer.uuid, transfer.size, transfer.size)
        self._do(lambda: receive(transfer.name, content))

    def _refuse(self, button: str, uuid: str, size: object, reason: str) -> None:
        """Report the reason. The page enables its button again when it hears of the last byte."""
        refuse, whole = self._of[button][1], size if type(size) is int else 0
        self._acknowledge(button, uuid, whole, whole)
        self._do(lambda: refuse(reason))

    def _acknowledge(self, button: str, uuid: str, done: int, size: int) -> None:
        self._gui._websock_interface.queue_message(
            _messages.FileTransferPartAck(
                source_component_uuid=button, transfer_uuid=uuid, transferred_bytes=done, total_bytes=size
            )
        )

    def _drop(self) -> None:
        self._transfer = None
        TRAFFIC.leave(id(self))


def readable(name: object) -> str:
    """A file's name for display: without folders and invisible characters, and not too long."""
    text = name if isinstance(name, str) else ""
    last = text[-4 * LONGEST_NAME :].replace("\\", "/").rpartition("/")[2]
    return "".join(c for c in last if c.isprintable())[-LONGEST_NAME:].strip() or "file"
