"""Where a visitor's work waits for a reload, a lost connection or a server's restart. No viser here.

    <state folder>/work/<visitor>.json    written beside itself, flushed to the disk, then renamed: never torn

The state folder is the system's own ($XDG_STATE_HOME/rangenav, or what macOS and Windows have for it), or what
RANGENAV_STATE says. What is in a file is the session's business. Whoever has no disk goes on without: every failure is
one `StorageError` with a sentence.
"""

import os
import re
import secrets
import tempfile
import threading
import time
from pathlib import Path

import platformdirs

STATE = "RANGENAV_STATE"
VISITOR = re.compile(r"[0-9a-f]{32}(?:-[1-9][0-9]?)?")
"""A browser, and the slot of one of its tabs; nothing that could be a path."""
SUFFIX, UNFINISHED = ".json", ".part"
MAX_BYTES = 2**21
"""Of one visitor's work: a path of a thousand waypoints in each of some drafts has a tenth of it."""
MAX_FILES, MAX_TOTAL = 200, 2**26
"""Kept in the folder, and bytes of them together; the oldest go first."""
MAX_AGE = 90 * 86400.0
"""s since it was written."""
ABANDONED = 3600.0
"""s after which a file that was never finished belongs to a program that is gone."""
PRUNED_EVERY = 100
"""Saves from one pruning to the next."""


class StorageError(OSError):
    """The work could not be written or read, and a sentence says why."""


class WorkFiles:
    """The files of all visitors. Threads and programs may share a folder: the last to write wins."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = state_folder() / "work" if folder is None else folder
        self._saves, self._lock = 0, threading.Lock()
        self.prune()

    def save(self, visitor: str, work: bytes) -> None:
        """Keep the work in place of what was kept before. Raises StorageError with one sentence."""
        path = self._path(visitor)
        if len(work) > MAX_BYTES:
            raise StorageError(f"your work is not kept: it has {len(work)} bytes, and at most {MAX_BYTES} are kept")
        try:
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            write(path, work)
        except OSError as error:
            raise StorageError(f"your work is not kept: {self.folder} cannot be written ({error.strerror})") from error
        with self._lock:
            self._saves += 1
            due = self._saves % PRUNED_EVERY == 0
        if due:
            self.prune()

    def load(self, visitor: str) -> bytes | None:
        """The work kept last, None if there is none. Raises StorageError with one sentence if it cannot be read."""
        path = self._path(visitor)
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

    def prune(self) -> None:
        """Forget what is too old or too much, oldest first, and only files that this class may have written."""
        try:
            kept = sorted(self._files(), reverse=True)
        except OSError:  # no folder yet, or none that can be read: the next save says so
            return
        now, total = time.time(), 0
        for rank, (written, size, path) in enumerate(kept):
            total += size
            if rank >= MAX_FILES or total > MAX_TOTAL or now - written > MAX_AGE:
                unlink(path)

    def _files(self) -> list[tuple[float, int, Path]]:
        """When written, how large, and where; files that were left unfinished are removed on the way."""
        found = []
        with os.scandir(self.folder) as entries:
            for entry in entries:
                path = Path(entry.path)
                if path.suffix not in (SUFFIX, UNFINISHED) or not VISITOR.fullmatch(path.name.split(".")[0]):
                    continue
                try:
                    status = entry.stat(follow_symlinks=False)
                except FileNotFoundError:  # finished or pruned by another program in the meantime
                    continue
                if path.suffix == SUFFIX:
                    found.append((status.st_mtime, status.st_size, path))
                elif time.time() - status.st_mtime > ABANDONED:
                    unlink(path)
        return found

    def _path(self, visitor: str) -> Path:
        if not VISITOR.fullmatch(visitor):
            raise ValueError(f"a visitor's id must be 32 hexadecimal digits and a slot, got {visitor[:40]!r}")
        return self.folder / (visitor + SUFFIX)


def new_visitor() -> str:
    """An id that nobody guesses."""
    return secrets.token_hex(16)


def state_folder() -> Path:
    """Where this program may keep things between two runs."""
    told = os.environ.get(STATE)
    return Path(told) if told else platformdirs.user_state_path("rangenav", appauthor=False)


def write(path: Path, work: bytes) -> None:
    """Beside the file, then in its place: a reader, or a crash at any moment, finds the old work or the new."""
    opened, name = tempfile.mkstemp(dir=path.parent, prefix=f"{path.stem}.", suffix=UNFINISHED)  # the owner's alone
    beside = Path(name)
    try:
        with open(opened, "wb") as file:
            file.write(work)
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)
    except BaseException:
        unlink(beside)
        raise


def unlink(path: Path) -> None:
    """Remove a file, if it is there and may be removed."""
    try:
        path.unlink(missing_ok=True)
    except OSError:
        return
