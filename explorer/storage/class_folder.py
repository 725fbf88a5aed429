"""The folder in which students' own presets lie until the class ends.

    <temporary folder>/rangenav-class-…/.lock        held as long as the program runs, and by nobody after a kill
    <temporary folder>/rangenav-class-…/<number>/    the presets of one student

A program that was killed could not remove its folder: the next one does, for what a class leaves is deleted.
"""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

PREFIX, LOCK = "rangenav-class-", ".lock"


@contextmanager
def class_folder() -> Iterator[Path]:
    """A new folder, which is removed at the end; abandoned ones are removed at once."""
    _remove_abandoned()
    with tempfile.TemporaryDirectory(prefix=PREFIX, ignore_cleanup_errors=True) as name:
        folder = Path(name)
        with FileLock(folder / LOCK):
            yield folder


def _remove_abandoned() -> None:
    """Remove the folders of programs that have ended; those of other people are left alone."""
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        try:
            if folder.is_symlink() or not folder.is_dir() or not _is_own(folder):
                continue
            with FileLock(folder / LOCK, timeout=0):
                shutil.rmtree(folder, ignore_errors=True)
        except (Timeout, OSError):  # it is in use, or was removed a moment ago
            continue


def _is_own(folder: Path) -> bool:
    """Whether a folder belongs to who runs this program; without owners it is a person's own."""
    return not hasattr(os, "getuid") or folder.stat().st_uid == os.getuid()
