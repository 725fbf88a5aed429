"""What was deleted from a folder of presets, or written over there: the newest hundred, each found by a mark.

    <folder>/<name>.<moment>.toml           deleted: it can be brought back, also after a reload of the page
    <folder>/<name>.<moment>.before.toml    what was there before a save or another title took its place

A mark is `<name>.<moment>`, the moment in hexadecimal nanoseconds, so that marks come in order. No viser here.
"""

import os
import secrets
import time
from pathlib import Path

from explorer.storage.files import unlink, write

SUFFIX, BEFORE = ".toml", ".before"
MAX_KEPT = 100
"""The oldest go first."""
MARKED = 16
"""Hexadecimal digits of nanoseconds since 1970, until the year 2554."""


class Trash:
    """One folder; whoever uses it holds the lock of the library. What the disk refuses is an OSError."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def move(self, file: Path) -> str:
        """Take a deleted file. Returns its mark."""
        mark = self._mark(file.stem)
        os.replace(file, self._folder / (mark + SUFFIX))
        self._forget_oldest()
        return mark

    def copy(self, name: str, content: bytes) -> None:
        """Keep what is about to be written over."""
        write(self._folder / (self._mark(name) + BEFORE + SUFFIX), content)
        self._forget_oldest()

    def deleted(self) -> list[str]:
        """The marks of all that can be brought back, the newest first; none if the folder cannot be read."""
        try:
            stems = [path.stem for path in self._folder.glob("*" + SUFFIX)]
        except OSError:
            return []
        return sorted((stem for stem in stems if not stem.endswith(BEFORE) and "." in stem), key=moment, reverse=True)

    def path(self, mark: str) -> Path:
        """Where a deleted file lies, if it does."""
        return self._folder / (mark + SUFFIX)

    def _mark(self, name: str) -> str:
        self._folder.mkdir(mode=0o700, exist_ok=True)
        return f"{name}.{time.time_ns():0{MARKED}x}{secrets.token_hex(2)}"

    def _forget_oldest(self) -> None:
        kept = sorted(self._folder.glob("*" + SUFFIX), key=lambda path: moment(path.stem))
        for path in kept[:-MAX_KEPT]:
            unlink(path)


def moment(stem: str) -> str:
    """When a file came here, for ordering."""
    return stem.removesuffix(BEFORE).rpartition(".")[2]


def name_of(mark: str) -> str:
    """What a file was called."""
    return mark.rpartition(".")[0]
