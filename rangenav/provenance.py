"""Where an imported path came from, and whether its snap was in the file. A fitted path is never certified.

A file of polynomials, or of rows with their snap, states the fourth derivative of its path. A record of positions does
not: the snap of a curve fitted to positions comes from the fit and not from the flight (∫snap² changes by a factor of
400 with the smoothing window). The excitation of a fitted path is therefore not judged.

A path that was changed after the import is a new design, and is judged like any design. The hash of the imported path
tells whether the path was changed, so that editors need not report it. A person who wants to fly the imported curve
exactly as it is deletes the table [source] from the preset; the curve is then a design as well.
"""

import hashlib
from functools import lru_cache
from typing import Any, Literal

import msgspec

from rangenav.inputs import Input, require
from rangenav.signals import Multisine, Signal, Sum

MAX_FILE, MAX_WORDS = 255, 400
"""Characters of a file's name, as file systems have them, and of a sentence."""
HASH = 64
"""Hexadecimal digits of a SHA-256."""
CACHED = 32
SourceFormat = Literal["reference", "polynomial", "tum", "euroc", "csv", "arrays"]
"""Formats whose files hold a path, and paths made of arrays; a test compares the list with the table of formats."""
"""What a path was imported from: a file in one of these formats, or arrays in a program."""
ADOPT = (
    "judge the flight itself by its IMU (rangenav log), or make the curve a design of your own: change its path, or "
    "delete [source] from the preset"
)
"""What a person can do if a path is not judged."""


class Source(Input, frozen=True, kw_only=True, omit_defaults=True):
    """The file a path was imported from."""

    file: str
    """Its name."""
    sha256: str
    """Of its bytes."""
    format: SourceFormat
    derivatives: Literal["file", "fit"]
    """Whether the derivatives up to snap stood in the file, or come from fitting."""
    fitted: str = ""
    """What was fitted, and how near it is; empty if the path is the file's own."""
    unjudged: str = ""
    """Why excitation cannot be judged from it; empty if it can."""
    path_sha256: str
    """Of the path as it was imported: see `fingerprint`."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, most in (("file", MAX_FILE), ("fitted", MAX_WORDS), ("unjudged", MAX_WORDS)):
            text = getattr(self, name)
            require(len(text) <= most, f"source.{name} must have at most {most} characters, got {len(text)}")
        require(len(self.file) > 0, "source.file must not be empty")
        for name in ("sha256", "path_sha256"):
            text = getattr(self, name)
            rule = f"source.{name} must be {HASH} hexadecimal digits, got {text[:HASH]!r}"
            require(len(text) == HASH and set(text) <= set("0123456789abcdef"), rule)
        require(
            self.derivatives == "file" or bool(self.unjudged),
            'source.unjudged must say why, where derivatives is "fit"',
        )


def edited(source: Source, path: Signal) -> bool:
    """Whether the path differs from the imported one. A wiggle without amplitude is no difference."""
    return fingerprint(_without_idle_wiggle(path)) != source.path_sha256


def renamed(source: Source | None, path: Signal, same: Signal) -> Source | None:
    """The source of the same path in other axes: naming the axes anew is no change of the path."""
    if source is None or edited(source, path):
        return source
    return msgspec.structs.replace(source, path_sha256=fingerprint(_without_idle_wiggle(same)))


def restriction(source: Source | None, path: Signal) -> str | None:
    """Why the path's excitation is not judged, as one clause; None if it may be."""
    if source is None or source.derivatives == "file" or edited(source, path):
        return None
    return f"the path's snap was not in {source.file} but comes from fitting: {source.unjudged}"


def description(source: Source, path: Signal) -> str:
    """Where the path comes from, as one clause."""
    came = f"imported from {source.file} ({source.format})"
    if edited(source, path):
        return f"{came} and changed since: a design"
    return f"{came}, {'whose own snap it has' if source.derivatives == 'file' else source.fitted}"


@lru_cache(maxsize=CACHED)
def fingerprint(path: Signal) -> str:
    """The SHA-256 of a path's values: of its JSON, with every number a float and no negative zero."""
    return hashlib.sha256(msgspec.json.encode(_plain(msgspec.to_builtins(path)))).hexdigest()


def _without_idle_wiggle(path: Signal) -> Signal:
    if not (isinstance(path, Sum) and isinstance(path.wiggle, Multisine)):
        return path
    idle = msgspec.structs.replace(path.wiggle, tones=tuple(tone for tone in path.wiggle.tones if tone.amplitude != 0))
    return path.base if msgspec.structs.replace(path, wiggle=idle) == Sum(base=path.base, wiggle=Multisine()) else path


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    return float(value) + 0.0 if isinstance(value, int | float) and not isinstance(value, bool) else value
