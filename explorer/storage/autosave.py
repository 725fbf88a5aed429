"""The work of one tab is saved while the visitor works, and restored after a reload or a server's restart."""

from collections.abc import Callable
from typing import Literal

import msgspec

from explorer.model.settings import GainUnits, Settings
from explorer.storage.work_files import StorageError, WorkFiles
from rangenav.inputs import Input

PERIOD = 1.0
"""s between two writes; of the changes in between only the last is written."""


class SavedWork(Input, frozen=True, kw_only=True):
    """The content of a tab's file. The names of the fields are part of the file format."""

    version: Literal[1] = 1
    opened: str
    """The preset that the program was started with."""
    settings: Settings
    language: GainUnits = "paper"
    """In which units the gains are shown."""


class Autosave:
    """Saves the work of one tab. If the browser or the disk refuses, the visitor is notified and nothing is saved."""

    def __init__(self, work_files: WorkFiles, opened: str, notify: Callable[[str], None]) -> None:
        """`notify` receives a sentence when saving begins to fail."""
        self._work_files, self._opened, self._notify = work_files, opened, notify
        self._session_key: str | None = None
        self._latest: tuple[Settings, GainUnits] | None = None
        self._unwritten: tuple[Settings, GainUnits] | None = None
        self._written_at = float("-inf")
        self._failing = False
        """Whether the visitor has been notified. The next change is written all the same."""

    def restore(self, session_key: str | None) -> SavedWork | None:
        """The work saved under a session key, None if there is none; from now on the work is saved there."""
        self._session_key = session_key
        if session_key is None:
            self._notify("This browser keeps nothing, so a reload begins anew.")
            return None
        try:
            content = self._work_files.load(session_key)
            return None if content is None else msgspec.json.decode(content, type=SavedWork)
        except StorageError as reason:
            self._notify(_sentence(reason))
        except (msgspec.DecodeError, ValueError, RecursionError) as error:
            self._notify(f"Your earlier work is of no use to this version: {' '.join(str(error).split())}")
        return None

    def remember(self, settings: Settings, units: GainUnits = "paper") -> None:
        """Take the settings that `write` saves when the next write is due."""
        if (settings, units) != self._latest:
            self._latest = self._unwritten = settings, units

    def wait(self, now: float) -> float | None:
        """How long (s) until a write is due; None if everything is written."""
        return None if self._unwritten is None else max(0.0, self._written_at + PERIOD - now)

    def write(self, now: float, *, at_once: bool = False) -> None:
        """Write the settings if that is due."""
        if self._unwritten is None or not (at_once or now - self._written_at >= PERIOD):
            return
        (settings, units), self._unwritten, self._written_at = self._unwritten, None, now
        if self._session_key is None:
            return
        try:
            work = SavedWork(opened=self._opened, settings=settings, language=units)
            self._work_files.save(self._session_key, msgspec.json.encode(work))
        except StorageError as reason:
            if not self._failing:
                self._notify(f"{_sentence(reason)} The page works on; download what you need.")
            self._failing = True
        else:
            self._failing = False


def _sentence(reason: StorageError) -> str:
    text = str(reason)
    return f"{text[:1].upper()}{text[1:]}."
