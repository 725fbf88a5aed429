"""What every command shares: how a preset is named, one JSON object on stdout, and refusals before the work."""

import json
from pathlib import Path
from typing import Annotated, Any

import tyro

from rangenav.inputs import require

PresetName = Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="PRESET")]
"""A shipped preset's name or a path to a TOML file."""


STOPPED = 130
"""The exit code of a program that Ctrl+C ended."""


def print_json(answer: dict[str, Any]) -> None:
    """Exactly one JSON object on stdout; a number that is not finite is an error of ours, not output."""
    print(json.dumps(answer, allow_nan=False, ensure_ascii=False))


def require_place(flag: str, path: Path | None, suffix: str) -> None:
    """Refuse, before the work and not after it, a file that cannot be written or whose name has another suffix."""
    if path is not None:
        require(path.suffix == suffix, f"{flag} must name a file that ends in {suffix}, got {path}")
        require(path.parent.is_dir(), f"{flag} {path}: no such folder")
