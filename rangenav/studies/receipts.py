"""Receipts: a part of a store counts as done if its receipt says so, and if its files are the ones of the receipt.

The files of a part are written and flushed to the disk first, then its receipt, whole: a crash at any moment leaves the
part done or not done. A part has one receipt, whose name is the part's number, so nothing is counted twice.
"""

import hashlib
import json
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import msgspec

from rangenav.inputs import Input

FOLDER = "receipts"
DIGITS = 8


class Receipt(Input, frozen=True, kw_only=True):
    """What a task did for one part."""

    part: int
    study: str
    """The study's digest."""
    points: int
    invalid: int
    """Points whose values do not fit."""
    runs: int
    width: float | None
    """The median over the points of the relative half width of the 95 % interval of `Study.watched`; None without."""
    met: int | None = None
    """Points that meet the stopping rule; None without one."""
    seconds: float
    """CPU time that the task took, of the thread that computes."""
    files: tuple[tuple[str, str], ...]
    """Files of the part below the store, each with the SHA-256 of its bytes."""


def write(store: Path, receipt: Receipt) -> None:
    """Write a receipt. Raises OSError, and leaves no receipt, if the disk refuses."""
    content = msgspec.json.encode(receipt)
    signed = json.dumps({"receipt": content.decode(), "sha256": hashlib.sha256(content).hexdigest()})
    target = path(store, receipt.part)
    opened, name = tempfile.mkstemp(dir=target.parent, prefix=f"{target.stem}.", suffix=".partial")
    try:
        with open(opened, "wb") as file:
            file.write(signed.encode())
            file.flush()
            os.fsync(file.fileno())
        os.replace(name, target)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def path(store: Path, part: int) -> Path:
    """The file of a part's receipt."""
    return store / FOLDER / f"{part:0{DIGITS}d}.json"


def read(file: Path) -> Receipt | None:
    """A receipt; None if the file is not there, or is not what was written."""
    try:
        signed = json.loads(file.read_bytes())
        content = signed["receipt"].encode()
        if hashlib.sha256(content).hexdigest() != signed["sha256"]:
            return None
        return msgspec.json.decode(content, type=Receipt)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, msgspec.MsgspecError):
        return None


def written(store: Path) -> Iterator[tuple[int, Receipt | None]]:
    """Every part with a receipt, in their order, and the receipt; None for one that is damaged."""
    for file in sorted((store / FOLDER).glob("*.json")):
        if file.stem.isdecimal():
            yield int(file.stem), read(file)


def whole(store: Path, receipt: Receipt) -> bool:
    """Whether every file of a part is there with the bytes of its receipt."""
    return all(checksum(store / name) == digest for name, digest in receipt.files)


def checksum(file: Path) -> str | None:
    """The SHA-256 of a file; None if it cannot be read."""
    try:
        return hashlib.sha256(file.read_bytes()).hexdigest()
    except OSError:
        return None


def flushed(file: Path) -> str:
    """Flush a file to the disk, and return its SHA-256. Raises OSError."""
    with file.open("rb") as opened:
        os.fsync(opened.fileno())
        return hashlib.sha256(opened.read()).hexdigest()
