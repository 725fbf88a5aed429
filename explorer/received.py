"""A file from outside, as bytes and a name that is not trusted: what it may be, and what it is understood to be.

No viser here. The file is read by `rangenav.formats`, under a plain name in a folder of its own, and only once.
"""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

import msgspec

from explorer.library import slug
from rangenav import formats
from rangenav.formats import Imported
from rangenav.formats.presets import as_preset
from rangenav.inputs import Vec3
from rangenav.preset import MAX_TITLE, Preset

HEAD = 4096
"""Bytes of a file's beginning that tell what it may be."""


@dataclass(frozen=True, eq=False)
class Received:
    """A file that was handed over."""

    name: str
    """For reading only."""
    content: bytes


@dataclass(frozen=True, eq=False)
class Understood:
    """What a file was understood to be; with its preset if it is a path and nothing is open."""

    found: Imported
    preset: Preset | None


def guess(file: Received) -> str:
    """The format that a file looks like, by its name and first lines; a person confirms it."""
    suffix = PurePosixPath(file.name.lower()).suffix
    if suffix in formats.SUFFIXES:
        return formats.SUFFIXES[suffix]
    head = file.content[:HEAD].decode("utf-8", "replace").lower()
    if "x^0" in head:
        return "polynomial"
    if "p_rs_r" in head:
        return "euroc"
    return "reference" if "p_x" in head and "gyr" not in head and "acc" not in head else "log"


def understand(file: Received, form: str, confirm: Mapping[str, str], anchor: Vec3) -> Understood:
    """Read a file. Raises ValueError with one sentence naming file and line for what cannot be read at all."""
    path = PurePosixPath(file.name)
    with tempfile.TemporaryDirectory(prefix="rangenav-") as folder:
        kept = Path(folder) / (slug(path.stem) + "." + slug(path.suffix))
        kept.write_bytes(file.content)
        found = replace(formats.read(kept, form, confirm=confirm), source=file.name)
    if found.questions or found.path is None:
        return Understood(found, None)
    made = as_preset(found, anchor=anchor)
    return Understood(found, msgspec.structs.replace(made, title=path.stem[:MAX_TITLE] or made.title))
