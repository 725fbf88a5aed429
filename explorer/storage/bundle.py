"""One zip for download: a preset, and its motion or its run in other formats, each with its certificate.

Every file meets the conditions of `rangenav export`, is certified from the bytes in the zip, and can be verified where
it is unpacked. A file that does not meet them is left out; with `uncertified` it is included, without a certificate and
with "uncertified" in its name.
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
"""The time of every file inside, always the same, so that equal inputs make equal zips."""


@dataclass(frozen=True, eq=False)
class Bundle:
    """A zip for download."""

    name: str
    content: bytes
    notes: tuple[str, ...]
    """Sentences about the files: format, frame, certificate, and what a format cannot hold. The README has them too."""


def pack(
    preset: Preset,
    stem: str,
    format_names: Sequence[str],
    *,
    uncertified: bool,
    progress: Progress,
    cancelled: Cancelled,
) -> Bundle:
    """Pack a preset and some formats, each with its certificate.

    Raises ValueError if the preset does not meet the conditions, or if there is one format and it cannot hold the
    preset. Of several formats, one that cannot hold it is left out, and a note says why. Raises CancelledError.
    """
    notes: list[str] = []
    with tempfile.TemporaryDirectory(prefix="rangenav-") as temporary:
        folder = Path(temporary)
        for k, format_name in enumerate(("preset", *format_names)):
            progress((k + 1) / (len(format_names) + 2))
            if cancelled():
                raise CancelledError
            path = folder / (stem + formats.row(format_name).suffix)
            try:
                notes += _write_format(preset, format_name, path, uncertified=uncertified)
            except ValueError as error:
                if format_name == "preset" or len(format_names) == 1:
                    raise
                notes.append(f"{format_name}: left out: {error}")
        (folder / "README.txt").write_text("".join(f"{note}\n" for note in (VERIFY, *notes)), "utf-8")
        marked = any(MARK in path.name for path in folder.iterdir())
        return Bundle(f"{stem}{MARK if marked else ''}.zip", _zipped(folder), tuple(notes))


def _write_format(preset: Preset, format_name: str, path: Path, *, uncertified: bool) -> list[str]:
    """Write one format and its certificate. Returns sentences about the file."""
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
"""Sends a visitor a file (name, content) to download."""
