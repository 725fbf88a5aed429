"""A file from outside, as bytes and a name that is not trusted: what it may be, and what it is understood to be.

No viser here. The file is read by `rangenav.formats`, under a plain name in a folder of its own, and only once; a
preset, also one in a zip as the page packs it, by `rangenav.preset`.
"""

import io
import tempfile
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

import msgspec

from explorer.storage.library import slug
from rangenav import formats, preset
from rangenav.formats import ImportResult
from rangenav.formats.path_preset import as_preset
from rangenav.inputs import Vec3, require
from rangenav.preset import MAX_TITLE, Preset

HEAD = 4096
"""Bytes of a file's beginning that tell what it may be."""
ZIPPED, MAX_ENTRIES = b"PK\x03\x04", 1000
"""How a zip begins; files in one that are looked through."""


@dataclass(frozen=True, eq=False)
class ImportFile:
    """A file that was handed over."""

    name: str
    """For reading only."""
    content: bytes


@dataclass(frozen=True, eq=False)
class Interpretation:
    """What a file was understood to be; with its preset if it is a path and nothing is open."""

    found: ImportResult
    preset: Preset | None


def guess(file: ImportFile) -> str:
    """The format that a file looks like, by its name and first lines; a person confirms it."""
    return formats.guess(file.name, file.content[:HEAD].decode("utf-8", "replace"))


def interpret(file: ImportFile, form: str, confirm: Mapping[str, str], anchor: Vec3) -> Interpretation:
    """Read a file. Raises ValueError with one sentence naming file and line for what cannot be read at all."""
    path = PurePosixPath(file.name)
    with tempfile.TemporaryDirectory(prefix="rangenav-") as folder:
        kept = Path(folder) / (slug(path.stem) + "." + slug(path.suffix))
        kept.write_bytes(file.content)
        try:
            found = formats.read(kept, form, confirm=confirm)
        except ValueError as error:
            raise ValueError(str(error).replace(kept.name, file.name)) from None  # the name that the person knows
    found = replace(found, source=file.name)
    if found.questions or found.path is None:
        return Interpretation(found, None)
    made = as_preset(found, anchor=anchor)
    return Interpretation(found, msgspec.structs.replace(made, title=path.stem[:MAX_TITLE] or made.title))


def looks_like_a_preset(file: ImportFile) -> bool:
    """Whether a file belongs to the other button."""
    return file.name.lower().endswith(".toml") or file.content.startswith(ZIPPED)


def preset_in(file: ImportFile) -> Preset:
    """The preset that was handed over, as a TOML file or the only one in a zip. Raises ValueError naming the file and
    what is wrong."""
    name, content = file.name, file.content
    if content.startswith(ZIPPED):
        name, content = _unzipped(file)
    require(len(content) <= preset.MAX_BYTES, f"{name}: larger than {preset.MAX_BYTES} bytes, which no preset is")
    try:
        return preset.loads(content.decode("utf-8-sig"), source=name)
    except UnicodeDecodeError as error:
        raise ValueError(f"{name}: not UTF-8 text (byte {error.start}), and no preset") from None


def _unzipped(file: ImportFile) -> tuple[str, bytes]:
    """Name and bytes of the one preset in a zip; what it is packed into is bounded before it is unpacked."""
    try:
        with zipfile.ZipFile(io.BytesIO(file.content)) as packed:
            require(len(packed.filelist) <= MAX_ENTRIES, f"{file.name}: more than {MAX_ENTRIES} files in one zip")
            presets = [entry for entry in packed.filelist if entry.filename.lower().endswith(".toml")]
            require(len(presets) == 1, f"{file.name}: {len(presets)} presets (.toml) in it, and one is wanted")
            with packed.open(presets[0]) as inside:
                content = inside.read(preset.MAX_BYTES + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, OSError) as error:
        raise ValueError(f"{file.name}: this zip cannot be read ({error})") from None
    shown = "".join(c for c in presets[0].filename if c.isprintable()).rpartition("/")[2]
    return f"{shown[:80]} in {file.name}", content
