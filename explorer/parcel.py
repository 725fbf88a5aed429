"""One zip to take along: a preset, its certificate, and its motion or run in other formats. No viser here.

The certificate is of the bytes that are in the zip. A preset that misses its requirement is refused, or, if it is asked
for all the same, everything in the zip has "uncertified" in its name.
"""

import io
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from explorer.jobs import Cancelled, Progress, Stopped
from rangenav import certificate, preset
from rangenav.commands.export import exported
from rangenav.preset import Preset

SUFFIXES = {"bag": "", "euroc": "", "mcap": ".mcap", "tum": ".tum.txt", "mat": ".mat", "npz": ".npz"}
"""Bags and EuRoC records are folders; the rest are CSV files that say in their names what they are."""
STAMP = (2020, 1, 1, 0, 0, 0)
"""The time of every file inside: equal inputs make equal zips."""


@dataclass(frozen=True, eq=False)
class Parcel:
    """What is downloaded."""

    name: str
    content: bytes
    notes: tuple[str, ...]
    """What a person should know about it, a sentence each; they are inside as well."""


def parcel(
    shown: Preset,
    stem: str,
    forms: Sequence[str],
    *,
    uncertified: bool,
    progress: Progress,
    cancelled: Cancelled,
) -> Parcel:
    """Pack a preset with its certificate and some formats. Raises ValueError with the certificate's refusal, or with
    what the only format asked for cannot hold; of several formats such a one is left out and named."""
    text = preset.dumps(shown).encode()
    found = certificate.certify(text, source=f"{stem}.toml")
    refusal = certificate.gate(found)
    if refusal is not None and not uncertified:
        raise ValueError(
            f"{refusal}. Nothing was written; “even if uncertified”, above, writes it, marked so in every name"
        )
    stem = stem if refusal is None else f"{stem}.uncertified"
    notes = [] if refusal is None else [f"UNCERTIFIED: {refusal}"]
    with tempfile.TemporaryDirectory(prefix="rangenav-") as made:
        folder = Path(made)
        (folder / f"{stem}.toml").write_bytes(text)
        (folder / f"{stem}.certificate.json").write_bytes(certificate.dumps(found))
        for k, form in enumerate(forms):
            progress((k + 1) / (len(forms) + 1))
            if cancelled():
                raise Stopped
            notes += _written(shown, form, folder / (stem + SUFFIXES.get(form, f".{form}.csv")), alone=len(forms) == 1)
        (folder / "README.txt").write_text("".join(f"{note}\n" for note in (*_contents(stem), *notes)), "utf-8")
        return Parcel(f"{stem}.zip", _zipped(folder), tuple(notes))


def _written(shown: Preset, form: str, path: Path, *, alone: bool) -> list[str]:
    """Write one format; what is to be known about the file."""
    try:
        report = exported(
            shown, form, path, name=path.name, attitude="flown", uncertified=True, gate=lambda _: None
        )  # the gate was passed, or the mark is in the name
    except ValueError as error:
        if alone:
            raise
        return [f"{form}: left out: {error}"]
    return [f"{path.name}: {form}, {report['frame']}", *(f"{path.name}: {note}" for note in report["notes"])]


def _contents(stem: str) -> tuple[str, ...]:
    return (f"{stem}.toml: the preset; {stem}.certificate.json: its certificate (rangenav verify {stem}.toml)",)


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
