"""Writing files: whole or not at all, never over a folder, and with a mark where a requirement was missed."""

import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, cast

from rangenav.formats.hover_ramps import RAMP, Place
from rangenav.inputs import require
from rangenav.results import result

Attitudes = Literal["flown", "preset"]


@dataclass(frozen=True, kw_only=True)
class ExportOptions:
    """How a motion is written; a run has no such choice."""

    attitude: Attitudes = "flown"
    """What flying the path takes, or the preset's own, where the format holds an attitude."""
    ramp: float = RAMP
    """s of each ramp, from hover into the path and back to hover."""
    once: bool = False
    """Whether a path that closes is written as one flight, too, and not as a loop."""


@result
class OutputFile:
    """What an export wrote."""

    files: tuple[Path, ...]
    frame: str
    """z-up or z-down."""
    steady: tuple[float, float] | None = None
    """From when to when (s, in the file) a certificate of the path holds; None if the whole record is the path."""
    loop: bool = False
    """Whether that part closes, and is flown again and again."""
    unfit: str | None = None
    """Why the file is not the preset's motion, as one clause; None if it is."""
    place: Place | None = None
    """Where a written motion lies; None for a run."""
    notes: tuple[str, ...] = ()
    figures: dict[str, Any] = field(default_factory=dict)


def export_options(*, attitude: str = "flown", ramp: float = RAMP, once: bool = False) -> ExportOptions:
    """Options from what a person typed. Raises ValueError for an attitude that does not exist."""
    require(attitude in ("flown", "preset"), f"attitude must be flown or preset, got {attitude!r}")
    return ExportOptions(attitude=cast(Attitudes, attitude), ramp=ramp, once=once)


Draft = Callable[[Path], OutputFile]
"""One of several ways to write a motion."""


def marked(path: Path) -> Path:
    """The name of a file that misses its requirement and was written all the same: flight.uncertified.csv."""
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
    """Raise ValueError if the path is a file, or a folder that is not empty."""
    require(path.parent.is_dir(), f"{path.parent}: no such folder")
    free = not path.exists() or (path.is_dir() and not any(path.iterdir()))
    require(free, f"{path}: exists already; a folder is never written over")
