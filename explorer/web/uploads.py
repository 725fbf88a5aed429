"""Uploads: one small file at a time from each tab, and nothing about it is trusted. Checked against viser 1.1.1.

viser collects whatever a browser sends, for any control and without limit, and makes it that control's value. Here a
transfer is accepted only for a button of `Uploads.button`, and only if it states a size that is small enough. It
must send exactly as many bytes as stated, with its parts in order. A transfer that stalls gives way to the next one.
The names of files are only displayed: no file is opened by its name.
"""

import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import viser
from viser import _messages

from explorer.web.bucket import Bucket

MAX_BYTES = 20_000_000
"""The largest size of one file: about 100 000 lines of a log."""
MAX_PART = 2**20
"""Bytes of one part; viser's page sends half of that."""
MAX_PARTS = 64
MAX_TOGETHER = 4
"""The largest number of simultaneous transfers of all visitors; together they hold at most 80 MB."""
PER_VISITOR, PER_CLASS = (60e6, 1e5), (500e6, 2.5e5)
"""Bytes that one visitor in a class, and all of them together, may upload at once, and per second after that."""
STALLED = 20.0
"""s without a part, after which a transfer is dropped."""
LONGEST_NAME = 80
Receive = Callable[[str, bytes], None]
"""Called with the name for display and the content of a file."""


@dataclass(eq=False)
class Transfer:
    """One file that is being uploaded."""

    uuid: str
    button: str
    name: str
    size: int
    parts: int
    contents: list[bytes] = field(default_factory=list)
    """The parts that have arrived, in order."""
    bytes: int = 0
    """The sum of their sizes."""
    last_part_at: float = field(default_factory=time.monotonic)
    """s, monotonic; when the last part, or the announcement, arrived."""


class Traffic:
    """Counts the transfers of all visitors, of which stalled ones do not count, and the bytes of each in a class."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last_part_at: dict[int, float] = {}
        self._together = _full(PER_CLASS)
        self._visitors: dict[int, Bucket] = {}

    def enter(self, tab: int, visitor: int, size: int) -> str:
        """Count a new transfer of a tab, of so many bytes. Returns why it must wait, and then does not count it.

        visitor: the number of the visitor in a class; 0 at this machine's own page, where bytes are not counted."""
        now = time.monotonic()
        with self._lock:
            self._last_part_at = {other: at for other, at in self._last_part_at.items() if now - at < STALLED}
            if len(self._last_part_at) >= MAX_TOGETHER:
                return f"{MAX_TOGETHER} files of others are on their way: try again in a moment"
            if visitor:
                own = self._visitors.setdefault(visitor, _full(PER_VISITOR))
                for bucket, whose in ((own, "you have"), (self._together, "the class has")):
                    wait = bucket.wait(now, size)
                    if wait > 0:
                        return f"{whose} uploaded very much: try again in {math.ceil(wait)} s"
                for bucket in (own, self._together):
                    bucket.take(size)
            self._last_part_at[tab] = now
            return ""

    def record_part(self, tab: int) -> None:
        """Record that a part of this tab's file has arrived."""
        with self._lock:
            if tab in self._last_part_at:
                self._last_part_at[tab] = time.monotonic()

    def leave(self, tab: int) -> None:
        """Record that the transfer of this tab has ended."""
        with self._lock:
            self._last_part_at.pop(tab, None)


def _full(size_and_rate: tuple[float, float]) -> Bucket:
    size, rate = size_and_rate
    return Bucket(size=size, rate=rate, level=size, at=time.monotonic())


TRAFFIC = Traffic()


class Uploads:
    """The upload buttons of one tab, and the one transfer that may be running."""

    def __init__(self, gui: viser.GuiApi, do: Callable[[Callable[[], None]], None], visitor: int = 0) -> None:
        """`do` queues an action for the session's loop. `visitor`: as in `Traffic.enter`."""
        self._gui, self._do, self._visitor = gui, do, visitor
        self._callbacks: dict[str, tuple[Receive, Callable[[str], None]]] = {}
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
        button = self._gui.add_upload_button(label, hint=hint)
        self._callbacks[button._impl.uuid] = receive, refuse

    def _start(self, client: int, message: _messages.FileTransferStartUpload) -> None:
        button, size, parts = message.source_component_uuid, message.size_bytes, message.part_count
        if not isinstance(button, str) or button not in self._callbacks or not isinstance(message.transfer_uuid, str):
            return
        stalled = self._transfer is not None and time.monotonic() - self._transfer.last_part_at > STALLED
        if stalled:
            self._drop()
        name = readable(message.filename)
        reason = self._reason_to_refuse(name, size, parts)
        if reason is not None:
            self._refuse(button, message.transfer_uuid, size, reason)
            return
        self._transfer = Transfer(message.transfer_uuid, button, name, size, parts)

    def _reason_to_refuse(self, name: str, size: object, parts: object) -> str | None:
        """Why a file is refused, or None; an accepted file is counted in `TRAFFIC`."""
        if type(size) is not int or type(parts) is not int or size <= 0 or parts <= 0:
            return f"{name}: the file is empty"
        if size > MAX_BYTES:
            return f"{name}: {size / 1e6:.0f} MB, more than the {MAX_BYTES / 1e6:.0f} MB that are taken"
        if parts > min(MAX_PARTS, size):
            return f"{name}: {parts} parts of {size} bytes are no file"
        if self._transfer is not None:
            return f"{name}: another file is on its way"
        busy = TRAFFIC.enter(id(self), self._visitor, size)
        return f"{name}: {busy}" if busy else None

    def _part(self, client: int, message: _messages.FileTransferPart) -> None:
        transfer, content = self._transfer, message.content
        if transfer is None or message.transfer_uuid != transfer.uuid:
            return
        valid = isinstance(content, bytes) and len(content) <= MAX_PART and message.part_index == len(transfer.contents)
        if not valid or transfer.bytes + len(content) > transfer.size:
            self._drop()
            self._refuse(transfer.button, transfer.uuid, transfer.size, f"{transfer.name}: it did not arrive as sent")
            return
        transfer.contents.append(content)
        transfer.bytes += len(content)
        transfer.last_part_at = time.monotonic()
        TRAFFIC.record_part(id(self))
        if len(transfer.contents) == transfer.parts:
            self._finish(transfer)
        else:
            self._acknowledge(transfer.button, transfer.uuid, transfer.bytes, transfer.size)

    def _finish(self, transfer: Transfer) -> None:
        self._drop()
        if transfer.bytes != transfer.size:
            reason = f"{transfer.name}: {transfer.bytes} bytes came of {transfer.size}"
            self._refuse(transfer.button, transfer.uuid, transfer.size, reason)
            return
        receive, content = self._callbacks[transfer.button][0], b"".join(transfer.contents)
        self._acknowledge(transfer.button, transfer.uuid, transfer.size, transfer.size)
        self._do(lambda: receive(transfer.name, content))

    def _refuse(self, button: str, uuid: str, size: object, reason: str) -> None:
        """Report the reason. The page enables its button again when the last byte is acknowledged."""
        refuse, whole = self._callbacks[button][1], size if type(size) is int else 0
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
