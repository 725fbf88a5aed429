"""An uploaded file, as bytes and a name that is not trusted, is read as a path, a recorded flight or a preset.

`rangenav.formats` reads the file once, under a name made of letters and digits in a folder of its own.
`rangenav.preset` reads a preset, also the one in a zip that the page has packed.
"""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

import msgspec

from explorer.storage.library import slug
from rangenav import formats, preset, record_questions
from rangenav.formats import ImportResult, archives
from rangenav.formats.lines import BINARY
from rangenav.formats.path_preset import as_preset, choices
from rangenav.inputs import Vec3, require
from rangenav.preset import MAX_TITLE, Preset

HEAD = 4096
"""The number of bytes at the beginning of a file from which its format is guessed."""
ZIPPED = b"PK\x03\x04"
"""The first bytes of a zip."""


@dataclass(frozen=True, eq=False)
class ImportFile:
    """An uploaded file."""

    name: str
    """For display only: no file is opened under this name."""
    content: bytes


@dataclass(frozen=True, eq=False)
class Interpretation:
    """How a file was understood; with a preset if it holds a path and no question is open."""

    result: ImportResult
    preset: Preset | None
    choices: tuple[str, ...] = ()
    """What the preset has that the file does not say, and why: sentences."""


def guess(file: ImportFile) -> str:
    """The format that a file seems to have, by its name and first lines; the visitor confirms it."""
    return formats.guess(file.name, file.content[:HEAD].decode("utf-8", "replace"))


def interpret(file: ImportFile, format_name: str, confirm: Mapping[str, str], anchor: Vec3 | None) -> Interpretation:
    """Read a file in a format; without an anchor (m) a path gets one outside of it.

    Raises ValueError with one sentence that names file and line if it cannot be read.
    """
    path = PurePosixPath(file.name)
    with tempfile.TemporaryDirectory(prefix="rangenav-") as folder:
        copy = Path(folder) / (slug(path.stem) + "." + slug(path.suffix))
        copy.write_bytes(file.content)

        def read(answers: Mapping[str, str]) -> ImportResult:
            return replace(formats.read(copy, format_name, confirm=answers), source=file.name)

        try:
            result = record_questions.read(read, confirm).imported
        except ValueError as error:
            raise ValueError(str(error).replace(copy.name, file.name)) from None  # the name that the visitor knows
    if result.questions or result.path is None:
        return Interpretation(result, None)
    imported = as_preset(result, anchor=anchor)
    named = msgspec.structs.replace(imported, title=path.stem[:MAX_TITLE].strip() or imported.title)
    return Interpretation(result, named, choices(named, result))


def is_binary(file: ImportFile | None) -> bool:
    """Whether a file begins as a format that holds no text, so that no other choice of a format would read it."""
    return file is not None and any(file.content.startswith(first) for first in BINARY)


def is_preset_or_zip(file: ImportFile) -> bool:
    """Whether a file is a preset or a zip, which the button “Upload a preset” reads."""
    return file.name.lower().endswith(".toml") or file.content.startswith(ZIPPED)


def preset_in(file: ImportFile) -> Preset:
    """The preset in a TOML file, or the only preset in a zip. Raises ValueError, which names the file and the fault."""
    name, content = file.name, file.content
    if content.startswith(ZIPPED):
        name, content = _unzipped(file)
    require(len(content) <= preset.MAX_BYTES, f"{name}: larger than {preset.MAX_BYTES} bytes, which no preset is")
    try:
        return preset.loads(content.decode("utf-8-sig"), source=name)
    except UnicodeDecodeError as error:
        raise ValueError(f"{name}: not UTF-8 text (byte {error.start}), and no preset") from None


def _unzipped(file: ImportFile) -> tuple[str, bytes]:
    """Name and bytes of the one preset in a zip. No more bytes are unpacked than a preset may have."""
    presets = archives.members(file.content, source=file.name, wanted=_is_preset_name, limit=preset.MAX_BYTES)
    require(len(presets) == 1, f"{file.name}: {len(presets)} presets (.toml) in it, and one is wanted")
    ((name, content),) = presets.items()
    display_name = "".join(c for c in name if c.isprintable()).rpartition("/")[2]
    return f"{display_name[:80]} in {file.name}", content


def _is_preset_name(name: str) -> bool:
    return name.lower().endswith(".toml")
