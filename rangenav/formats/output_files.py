"""What was written, and how: never half a file, never over a folder, and marked where a requirement was missed."""

import os
import tempfile
from dataclasses import field
from pathlib import Path
from typing import Any

from rangenav.inputs import require
from rangenav.results import result


@result
class OutputFile:
    """One export."""

    files: tuple[Path, ...]
    frame: str
    """z-up or z-down."""
    steady: tuple[float, float] | None = None
    """s in the file's own time: what a certificate of the path covers. None where the whole record is the path's."""
    notes: tuple[str, ...] = ()
    figures: dict[str, Any] = field(default_factory=dict)


def marked(path: Path) -> Path:
    """The name of what was written although it misses its requirement: flight.uncertified.csv."""
    return path.with_name(f"{path.stem}.uncertified{path.suffix}")


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file, whole or not at all."""
    require(path.parent.is_dir(), f"{path.parent}: no such folder")
    require(not path.is_dir(), f"{path}: is a folder")
    try:
        handle, name = tempfile.mkstemp(prefix=path.name, dir=path.parent)
    except OSError as error:
        raise ValueError(f"{path}: cannot be written: {error.strerror}") from None
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def new_folder(path: Path) -> None:
    """Refuse to write into a folder that holds something."""
    require(path.parent.is_dir(), f"{path.parent}: no such folder")
    free = not path.exists() or (path.is_dir() and not any(path.iterdir()))
    require(free, f"{path}: exists already; a folder is never written over")
