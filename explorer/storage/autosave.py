"""One visitor's work, kept while they work and found again after a reload, a lost connection or a server's restart."""

from collections.abc import Callable
from typing import Literal

import msgspec

from explorer.model.settings import GainUnits, Settings
from explorer.storage.files import StorageError, WorkFiles
from rangenav.inputs import Input

PERIOD = 1.0
"""s: what is changed faster is written once."""


class SavedWork(Input, frozen=True, kw_only=True):
    """What is in the file."""

    version: Literal[1] = 1
    opened: str
    """The preset that the program was started with."""
    settings: Settings
    language: GainUnits = "paper"


class Autosave:
    """The file of one tab, or none where browser or disk refuse; `tell` is called with the reason when that begins."""

    def __init__(self, work_files: WorkFiles, opened: str, notify: Callable[[str], None]) -> None:
        self._work_files, self._opened, self._notify = work_files, opened, notify
        self._session_key: str | None = None
        self._noted: tuple[Settings, GainUnits] | None = None
        self._unwritten: tuple[Settings, GainUnits] | None = None
        self._written = float("-inf")
        self._failing = False
        """Told once; each change is tried again, for a disk may have room later, or the work be smaller."""

    def find(self, session_key: str | None) -> SavedWork | None:
        """The work kept under a name, None if there is none; from now on work is kept there."""
        self._session_key = session_key
        if session_key is None:
            self._notify("This browser keeps nothing, so a reload begins anew.")
            return None
        try:
            found = self._work_files.load(session_key)
            return None if found is None else msgspec.json.decode(found, type=SavedWork)
        except StorageError as reason:
            self._notify(_sentence(reason))
        except (msgspec.DecodeError, ValueError, RecursionError) as error:
            self._notify(f"Your earlier work is of no use to this version: {' '.join(str(error).split())}")
        return None

    def remember(self, settings: Settings, language: GainUnits = "paper") -> None:
        """This is what should be kept."""
        if (settings, language) != self._noted:
            self._noted = self._unwritten = settings, language

    def wait(self, now: float) -> float | None:
        """How long (s) until something should be written; None if there is nothing."""
        return None if self._unwritten is None else max(0.0, self._written + PERIOD - now)

    def write(self, now: float, *, at_once: bool = False) -> None:
        """Write what is due."""
        if self._unwritten is None or not (at_once or now - self._written >= PERIOD):
            return
        (settings, language), self._unwritten, self._written = self._unwritten, None, now
        if self._session_key is None:
            return
        try:
            kept = SavedWork(opened=self._opened, settings=settings, language=language)
            self._work_files.save(self._session_key, msgspec.json.encode(kept))
        except StorageError as reason:
            if not self._failing:
                self._notify(f"{_sentence(reason)} The page works on; download what you need.")
            self._failing = True
        else:
            self._failing = False


def _sentence(reason: StorageError) -> str:
    words = str(reason)
    return f"{words[:1].upper()}{words[1:]}."
