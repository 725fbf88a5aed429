"""The trash of the library: the newest hundred presets that were deleted or overwritten, each with a unique mark.

    <folder>/<name>.<moment>.toml           a deleted preset, which can be restored, also in a later visit
    <folder>/<name>.<moment>.before.toml    the content before a save or a new title replaced it

A mark is `<name>.<moment>`. The moment is in hexadecimal nanoseconds, so that marks sort by time.
"""

import os
import secrets
import time
from pathlib import Path

from explorer.storage.files import unlink, write

SUFFIX, BEFORE = ".toml", ".before"
MAX_FILES = 100
"""The largest number of files; the oldest are removed first."""
MARKED = 16
"""Hexadecimal digits of nanoseconds since 1970, until the year 2554."""


class Trash:
    """One folder. The caller holds the lock of the library. A failure of the disk is an OSError."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def move(self, file: Path) -> str:
        """Move a deleted file here. Returns its mark."""
        mark = self._mark(file.stem)
        os.replace(file, self._folder / (mark + SUFFIX))
        self._remove_oldest()
        return mark

    def copy(self, name: str, content: bytes) -> None:
        """Save the content of a file that is about to be overwritten."""
        write(self._folder / (self._mark(name) + BEFORE + SUFFIX), content)
        self._remove_oldest()

    def deleted(self) -> list[str]:
        """The marks of all deleted files, the newest first; none if the folder cannot be read."""
        try:
            stems = [path.stem for path in self._folder.glob("*" + SUFFIX)]
        except OSError:
            return []
        return sorted((stem for stem in stems if not stem.endswith(BEFORE) and "." in stem), key=moment, reverse=True)

    def path(self, mark: str) -> Path:
        """The path of a deleted file, which may not exist any more."""
        return self._folder / (mark + SUFFIX)

    def _mark(self, name: str) -> str:
        self._folder.mkdir(mode=0o700, exist_ok=True)
        return f"{name}.{time.time_ns():0{MARKED}x}{secrets.token_hex(2)}"

    def _remove_oldest(self) -> None:
        files = sorted(self._folder.glob("*" + SUFFIX), key=lambda path: moment(path.stem))
        for path in files[:-MAX_FILES]:
            unlink(path)


def moment(stem: str) -> str:
    """The moment part of a mark, for sorting."""
    return stem.removesuffix(BEFORE).rpartition(".")[2]


def name_of(mark: str) -> str:
    """The name part of a mark."""
    return mark.rpartition(".")[0]
