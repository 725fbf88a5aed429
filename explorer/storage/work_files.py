"""The files in which the work of each browser tab is saved, for a reload, a lost connection or a server's restart.

    <state folder>/work/<session key>.json
    <state folder>/work/<session key>.json.newer, .newer-2, .broken      copies of what a version could not read

The state folder is the system's own ($XDG_STATE_HOME/rangenav, or its counterpart on macOS and Windows), or the one
that RANGENAV_STATE names. `autosave` decides what is in a file. Every failure is a `StorageError` with one sentence:
without a disk the page works on, and saves nothing.
"""

import filecmp
import os
import re
import secrets
import shutil
import threading
import time
from pathlib import Path

import platformdirs

from explorer.storage.files import UNFINISHED, unlink, write

STATE = "RANGENAV_STATE"
SESSION_KEY = re.compile(r"[0-9a-f]{32}(?:-[1-9][0-9]?)?")
"""The id of a browser and the slot of one of its tabs; no such key is a path."""
SUFFIX = ".json"
MAX_BYTES = 2**21
"""The largest size of one file. A thousand waypoints in each of several drafts take a tenth of this size."""
MAX_FILES, MAX_TOTAL = 200, 2**26
"""Files in the folder, and bytes of all of them; the oldest are removed first."""
MAX_AGE, AGELESS = 90 * 86400.0, 50
"""s; the largest age of a file, and how many of the newest files have no such limit: a clock that jumps makes all of
them old at once."""
MAX_KEPT = 50
"""Copies of one tab's file that no version has written over."""
ABANDONED = 3600.0
"""s after which an unfinished file belongs to a program that has ended."""
SAVES_PER_PRUNE = 100


class StorageError(OSError):
    """The work could not be written or read; the message is one sentence that says why."""


class WorkFiles:
    """The files of all tabs. Threads and programs may share the folder; the last one to write a file wins."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = state_folder() / "work" if folder is None else folder
        self._saves, self._lock = 0, threading.Lock()
        self._saved: dict[str, int] = {}
        """The files written here, each with the number of its last save, which no clock can make older."""
        self.prune()

    def save(self, session_key: str, work: bytes) -> None:
        """Replace the work that was saved before. Raises StorageError."""
        path = self._path(session_key)
        if len(work) > MAX_BYTES:
            raise StorageError(f"your work is not kept: it has {len(work)} bytes, and at most {MAX_BYTES} are kept")
        try:
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            write(path, work)
        except OSError as error:
            raise StorageError(f"your work is not kept: {self.folder} cannot be written ({error.strerror})") from error
        with self._lock:
            self._saves += 1
            self._saved[path.name] = self._saves
            due = self._saves % SAVES_PER_PRUNE == 0
        if due:
            self.prune()

    def load(self, session_key: str) -> bytes | None:
        """The work that was saved last, None if there is none. Raises StorageError if it cannot be read."""
        path = self._path(session_key)
        try:
            with path.open("rb") as file:
                work = file.read(MAX_BYTES + 1)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise StorageError(f"your earlier work cannot be read: {path} ({error.strerror})") from error
        if len(work) > MAX_BYTES:
            raise StorageError(f"your earlier work cannot be read: {path} has more than {MAX_BYTES} bytes")
        return work

    def keep(self, session_key: str, ending: str) -> str:
        """Copy the saved work to a name with this ending, numbered if there is another file of that name. No copy is
        ever written over or pruned. Returns the name. Raises StorageError."""
        path = self._path(session_key)
        for number in range(1, MAX_KEPT + 1):
            copy = path.with_name(path.name + ending + (f"-{number}" if number > 1 else ""))
            try:
                if copy.exists() and filecmp.cmp(path, copy, shallow=False):
                    return copy.name
                with path.open("rb") as content, open(copy, "xb", opener=_owners_alone) as kept:
                    shutil.copyfileobj(content, kept)
                return copy.name
            except FileExistsError:
                continue
            except OSError as error:
                raise StorageError(f"{path} cannot be copied ({error.strerror})") from error
        raise StorageError(f"{path} has been kept {MAX_KEPT} times: remove some of the copies")

    def prune(self) -> None:
        """Remove files that are too old or too many, the oldest first. Files of other names are left alone."""
        saved = self._saved
        try:
            files = sorted(self._files(), key=lambda one: (saved.get(one[2].name, 0), one[0]), reverse=True)
        except OSError:  # there is no folder, or it cannot be read: the next save reports it
            return
        now, total = time.time(), 0
        for rank, (written, size, path) in enumerate(files):
            total += size
            too_old = rank >= AGELESS and now - written > MAX_AGE
            if rank >= MAX_FILES or total > MAX_TOTAL or too_old:
                unlink(path)

    def _files(self) -> list[tuple[float, int, Path]]:
        """Time of writing, size and path of every file; abandoned unfinished files are removed on the way."""
        files = []
        with os.scandir(self.folder) as entries:
            for entry in entries:
                path = Path(entry.path)
                if path.suffix not in (SUFFIX, UNFINISHED) or not SESSION_KEY.fullmatch(path.name.split(".")[0]):
                    continue
                try:
                    status = entry.stat(follow_symlinks=False)
                except FileNotFoundError:  # another program has finished or pruned it meanwhile
                    continue
                if path.suffix == SUFFIX:
                    files.append((status.st_mtime, status.st_size, path))
                elif time.time() - status.st_mtime > ABANDONED:
                    unlink(path)
        return files

    def _path(self, session_key: str) -> Path:
        if not SESSION_KEY.fullmatch(session_key):
            raise ValueError(f"a session key must be 32 hexadecimal digits and a slot, got {session_key[:40]!r}")
        return self.folder / (session_key + SUFFIX)


def _owners_alone(path: str, flags: int) -> int:
    """Open a new file that only its owner may read."""
    return os.open(path, flags, 0o600)


def new_browser_id() -> str:
    """An id that nobody can guess."""
    return secrets.token_hex(16)


def state_folder() -> Path:
    """The system's folder for the state of a program between two runs."""
    named = os.environ.get(STATE)
    return Path(named) if named else platformdirs.user_state_path("rangenav", appauthor=False)
