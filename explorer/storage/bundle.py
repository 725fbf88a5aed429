"""One zip to take along: a preset and its motion or run in other formats, each with its certificate. No viser here.

Everything in it passes the gate of `rangenav export`, is certified from the bytes that are in the zip, and can be
verified where it is unpacked. What the gate refuses is left out, or, asked for all the same, has "uncertified" in its
name and no certificate.
"""

import io
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rangenav import formats
from rangenav.certificate import certified_export
from rangenav.preset import Preset
from rangenav.progress import Cancelled, CancelledError, Progress

OTHERWISE = "“even if uncertified”, above, writes it, marked so in every name"
MARK = ".uncertified"
VERIFY = "Verify any file or folder where it is unpacked: rangenav verify NAME"
STAMP = (2020, 1, 1, 0, 0, 0)
"""The time of every file inside: equal inputs make equal zips."""


@dataclass(frozen=True, eq=False)
class Bundle:
    """What is downloaded."""

    name: str
    content: bytes
    notes: tuple[str, ...]
    """What a person should know about it, a sentence each; they are inside as well."""


def pack(
    shown: Preset,
    stem: str,
    forms: Sequence[str],
    *,
    uncertified: bool,
    progress: Progress,
    cancelled: Cancelled,
) -> Bundle:
    """Pack a preset and some formats, each with its certificate. Raises ValueError with the gate's refusal of the
    preset, or with what the only format asked for cannot hold; of several formats such a one is left out and named."""
    notes: list[str] = []
    with tempfile.TemporaryDirectory(prefix="rangenav-") as made:
        folder = Path(made)
        for k, form in enumerate(("preset", *forms)):
            progress((k + 1) / (len(forms) + 2))
            if cancelled():
                raise CancelledError
            path = folder / (stem + formats.row(form).suffix)
            try:
                notes += _write_format(shown, form, path, uncertified=uncertified)
            except ValueError as error:
                if form == "preset" or len(forms) == 1:
                    raise
                notes.append(f"{form}: left out: {error}")
        (folder / "README.txt").write_text("".join(f"{note}\n" for note in (VERIFY, *notes)), "utf-8")
        marked = any(MARK in path.name for path in folder.iterdir())
        return Bundle(f"{stem}{MARK if marked else ''}.zip", _zipped(folder), tuple(notes))


def _write_format(preset: Preset, format_name: str, path: Path, *, uncertified: bool) -> list[str]:
    """Write one format and its certificate; what a person should know about the file."""
    export = certified_export.write(
        preset, format_name, path, name=path.name, uncertified=uncertified, otherwise=OTHERWISE
    )
    name = path.name if export.complaint is None else formats.marked(path).name
    proof = "uncertified" if export.certificate is None else f"certified ({export.certificate.name})"
    about = f"{name}: {format_name}, {export.output.frame}, {proof}"
    return [about, *(f"{name}: {note}" for note in export.notes)]


def _zipped(folder: Path) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(path for path in folder.rglob("*") if path.is_file()):
            entry = zipfile.ZipInfo(path.relative_to(folder).as_posix(), STAMP)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, path.read_bytes())
    return packed.getvalue()


Send = Callable[[str, bytes], None]
"""Gives a visitor a file to download."""
