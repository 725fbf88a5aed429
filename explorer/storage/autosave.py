"""The work of one tab is saved while the visitor works, and restored after a reload or a server's restart.

A file that this version cannot read is kept under another name, and is written over only when the visitor changes
something.
"""

import logging
import threading
from collections.abc import Callable
from typing import Literal

import msgspec

from explorer.model.settings import GainUnits, Settings
from explorer.model.view import View
from explorer.storage.work_files import MAX_BYTES, StorageError, WorkFiles
from rangenav.inputs import Input, shortened

VERSION = 1
NEWER, BROKEN = ".newer", ".broken"
"""Endings of the names under which files are kept that this version cannot read."""
HISTORY_BYTES = 2**18
"""The size of the steps for undo and redo in a file; of large settings fewer steps are remembered."""
PERIOD, RETRY = 1.0, 10.0
"""s between two writes, of which only the last is written; and s after which a write that failed is tried again."""

NO_VIEW = View()
UNFORESEEN = "Your work is not kept: something went wrong on the server."

log = logging.getLogger(__name__)


class SavedWork(Input, frozen=True, kw_only=True):
    """The content of a tab's file. The names of the fields are part of the file format."""

    version: Literal[1] = VERSION
    opened: str
    """The preset that the program was started with."""
    settings: Settings
    language: GainUnits = "paper"
    """In which units the gains are shown."""
    view: View = NO_VIEW
    """What else is remembered of the page; versions before 0.2.0 wrote none."""


class _Numbered(msgspec.Struct):
    """The version of a file of any version."""

    version: int = VERSION


class Autosave:
    """Saves the work of one tab. If the browser or the disk refuses, the visitor is notified and nothing is saved."""

    def __init__(self, work_files: WorkFiles, opened: str, notify: Callable[[str], None]) -> None:
        """`notify` receives a sentence when saving begins to fail."""
        self._work_files, self._opened, self._notify = work_files, opened, notify
        self._session_key: str | None = None
        self._latest: tuple[Settings, GainUnits, View] | None = None
        self._unwritten: tuple[Settings, GainUnits, View] | None = None
        self._written_at = float("-inf")
        self._writer: threading.Thread | None = None
        self._kept = False
        """Whether there is a file that was kept under another name, and that is not written over unasked."""
        self._failing = False
        """Whether the visitor has been notified. The next change is written all the same."""
        self._failed: tuple[Settings, GainUnits, View] | None = None
        """What could not be written last; it is tried again, for a disk that was full may have room."""

    def restore(self, session_key: str | None) -> SavedWork | None:
        """The work saved under a session key, None if there is none; from now on the work is saved there."""
        self._session_key = session_key
        if session_key is None:
            self._notify("This browser keeps nothing, so a reload begins anew.")
            return None
        try:
            content = self._work_files.load(session_key)
        except StorageError as reason:
            return self._keep(session_key, BROKEN, _sentence(reason))
        try:
            return None if content is None else msgspec.json.decode(content, type=SavedWork)
        except (msgspec.DecodeError, ValueError, RecursionError) as error:
            if content is not None and _is_newer(content):
                return self._keep(session_key, NEWER, "Your earlier work was saved by a newer version of the program.")
            sentence = f"Your earlier work is of no use to this version: {shortened(str(error))}."
            return self._keep(session_key, BROKEN, sentence)

    def _keep(self, session_key: str, ending: str, sentence: str) -> None:
        """Keep the file under another name. Where that fails, nothing is saved, so the file stays as it is."""
        try:
            name = self._work_files.keep(session_key, ending)
        except StorageError as reason:
            self._session_key = None
            self._notify(f"{sentence} It stays as it is, and nothing is saved: {reason}.")
            return
        self._kept = True
        self._notify(f"{sentence} It is kept as {name} in {self._work_files.folder}, and the page begins anew.")

    def remember(self, settings: Settings, units: GainUnits = "paper", view: View = NO_VIEW) -> None:
        """Take the settings and the view that `write` saves when the next write is due."""
        if (settings, units, view) == self._latest:
            return
        opened_only = self._kept and (self._latest is None or self._latest[:2] == (settings, units))
        self._latest = settings, units, view
        if not opened_only:
            self._kept = False
            self._unwritten = settings, units, view

    def wait(self, now: float) -> float | None:
        """How long (s) until a write is due; None if everything is written."""
        if self._unwritten is not None:
            return max(0.0, self._written_at + PERIOD - now)
        if self._writing:  # it may fail
            return RETRY
        return None if self._failed is None else max(0.0, self._written_at + RETRY - now)

    @property
    def _writing(self) -> bool:
        return self._writer is not None and self._writer.is_alive()

    def write(self, now: float, *, at_once: bool = False) -> None:
        """Write the settings if that is due, or `at_once`, after those that another thread is writing."""
        self.finish()
        self._try_again(now, at_once=at_once)
        if self._unwritten is not None and (at_once or now - self._written_at >= PERIOD):
            self._save(*self._take(now))

    def write_aside(self, now: float) -> None:
        """As `write`, in a thread of its own: the visitor's next move does not wait for the disk."""
        self._try_again(now)
        if self._unwritten is None or now - self._written_at < PERIOD:
            return
        if self._writing:  # a slow disk: the newest work follows later
            self._written_at = now
            return
        taken = self._take(now)
        self._failed = taken  # until it is written: the thread may fail to start
        writer = threading.Thread(target=self._save, args=taken, name="autosave", daemon=True)
        writer.start()
        self._writer = writer

    def finish(self) -> None:
        """Wait until what another thread is writing is on the disk."""
        if self._writer is not None:
            self._writer.join()

    def _try_again(self, now: float, *, at_once: bool = False) -> None:
        """Have what could not be written written again, unless something newer is waiting."""
        if self._failed is None or self._writing or not (at_once or now - self._written_at >= RETRY):
            return
        self._unwritten, self._failed = self._unwritten or self._failed, None

    def _take(self, now: float) -> tuple[Settings, GainUnits, View]:
        assert self._unwritten is not None
        taken, self._unwritten, self._written_at = self._unwritten, None, now
        return taken

    def _save(self, settings: Settings, units: GainUnits, view: View) -> None:
        reason = "" if self._session_key is None else self._refusal(self._session_key, settings, units, view)
        if reason and not self._failing:
            self._notify(f"{reason} The page works on; download what you need.")
        self._failing = bool(reason)
        self._failed = (settings, units, view) if reason else None

    def _refusal(self, session_key: str, settings: Settings, units: GainUnits, view: View) -> str:
        """Write the work. Returns why it could not be written; empty if it was."""
        try:
            work = SavedWork(opened=self._opened, settings=settings, language=units, view=view)
            self._work_files.save(session_key, _encoded(work))
        except StorageError as reason:
            return _sentence(reason)
        except Exception:
            log.exception("the work of a tab could not be written")
            return UNFORESEEN
        return ""


def _encoded(work: SavedWork) -> bytes:
    """The content of the file. Where that would be too large, the view is left out: the settings are what counts."""
    steps = max(HISTORY_BYTES // len(msgspec.json.encode(work.settings)), 1)
    view = msgspec.structs.replace(work.view, past=work.view.past[-steps:], future=work.view.future[-steps:])
    content = msgspec.json.encode(msgspec.structs.replace(work, view=view))
    return content if len(content) <= MAX_BYTES else msgspec.json.encode(msgspec.structs.replace(work, view=NO_VIEW))


def _is_newer(content: bytes) -> bool:
    """Whether a file states a version that is not known yet."""
    try:
        return msgspec.json.decode(content, type=_Numbered).version > VERSION
    except (msgspec.DecodeError, ValueError, RecursionError):
        return False


def _sentence(reason: StorageError) -> str:
    text = str(reason)
    return f"{text[:1].upper()}{text[1:]}."
