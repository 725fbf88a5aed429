"""One zip for download: a preset, and its motion or its run in other formats, each with its certificate.

Every file meets the conditions of `rangenav export`, is certified from the bytes in the zip, and can be verified where
it is unpacked. A file that does not meet them is left out, with what would cure it; with `uncertified` it is included,
without a certificate and with "uncertified" in its name. A loop for a Crazyflie comes with the program that flies it.
"""

import io
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from explorer.model.certificate_text import certificate_sentence
from explorer.storage.preset_file import as_it_became
from rangenav import formats
from rangenav.certificate import certified_export, cures, encoding
from rangenav.certificate.certified_export import CertifiedExport, RefusedExportError
from rangenav.certificate.cures import Cure
from rangenav.certificate.files import read_bytes
from rangenav.formats import ExportOptions, crazyflie
from rangenav.inputs import require
from rangenav.number_format import shortened
from rangenav.preset import Preset
from rangenav.progress import Cancelled, CancelledError, Progress

OTHERWISE = "the switch “write files that miss the requirement, too”, above, writes it under a name with “uncertified”"
NOTHING_CHOSEN = "no format is chosen: choose at least one above; “Download this preset” gives the preset alone"
MARK = ".uncertified"
VERIFY = "Verify all files where they are unpacked: rangenav verify FOLDER, or one of them: rangenav verify FILE"
FRAMES = {"as the preset has it": "in its own axes"}
"""The axes of a file, where a sentence has another word for them."""
STAMP = (2020, 1, 1, 0, 0, 0)
"""The time of every file inside, always the same, so that equal inputs make equal zips."""
CURES_FROM = 0.6
"""Share of the progress at which files are packed and cures are searched for."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Refused:
    """A file that was not written."""

    format_name: str
    reason: str
    cures: tuple[Cure, ...]
    """Changes after which it is written, each confirmed by a certificate; maybe none."""


@dataclass(frozen=True, eq=False)
class Bundle:
    """A zip for download."""

    name: str
    content: bytes
    """Empty if every file was refused: then there is nothing to download."""
    notes: tuple[str, ...]
    """Sentences about the files: format, frame, certificate, and what a format cannot hold. The README has them too."""
    refused: tuple[Refused, ...] = field(default=())


def pack(
    preset: Preset,
    stem: str,
    format_names: Sequence[str],
    *,
    options: ExportOptions | None = None,
    uncertified: bool,
    progress: Progress,
    cancelled: Cancelled,
) -> Bundle:
    """Pack a preset and some formats, each with its certificate. What is refused is left out, and has its cures.

    Raises ValueError if no format is chosen, or if there is one and it cannot hold the preset at all. Raises
    CancelledError.
    """
    require(len(format_names) > 0, NOTHING_CHOSEN)
    options, preset = options or ExportOptions(), as_it_became(preset)
    notes: list[str] = []
    refusals: list[RefusedExportError] = []
    with tempfile.TemporaryDirectory(prefix="rangenav-") as temporary:
        folder = Path(temporary)
        for k, format_name in enumerate(("preset", *format_names)):
            progress(CURES_FROM * (k + 1) / (len(format_names) + 2))
            if cancelled():
                raise CancelledError
            path = folder / (stem + formats.row(format_name).suffix)
            try:
                notes += _write_format(preset, format_name, path, options, uncertified=uncertified)
            except RefusedExportError as error:
                refusals.append(error)
                notes.append(f"{format_name}: left out: {error}")
                if format_name == "preset":
                    break  # no other format would be written either
            except ValueError as error:
                if format_name == "preset" or len(format_names) == 1:
                    raise
                notes.append(f"{format_name}: left out: {error}")
        (folder / "README.txt").write_text(_readme(notes), "utf-8")
        marked = any(MARK in path.name for path in folder.iterdir())
        left_out = {error.format_name for error in refusals}
        content = b"" if "preset" in left_out or left_out >= set(format_names) else _zipped(folder)
    refused = tuple(_with_cures(error, cancelled) for error in refusals)
    return Bundle(f"{stem}{MARK if marked else ''}.zip", content, tuple(notes), refused)


def _readme(notes: Sequence[str]) -> str:
    """The sentences below the names of their files."""
    about = [note.partition(": ")[::2] for note in notes]
    paragraphs = [
        f"{file}\n{''.join(f'  - {sentence}{chr(10)}' for name, sentence in about if name == file)}"
        for file in dict.fromkeys(name for name, _ in about)
    ]
    return "\n".join([f"{VERIFY}\n", *paragraphs])


def motion_in(bundle: Bundle, format_names: Sequence[str]) -> tuple[str, bytes] | None:
    """The first of some formats that holds a motion and is in the zip, with its content; None if none is."""
    motions = [row for row in formats.writable() if row.certified_as == "motion" and row.name in format_names]
    with zipfile.ZipFile(io.BytesIO(bundle.content)) as archive:
        for row in motions:
            for name in archive.namelist():
                if name.endswith(row.suffix) and "/" not in name:
                    return row.name, archive.read(name)
    return None


def _with_cures(error: RefusedExportError, cancelled: Cancelled) -> Refused:
    return Refused(format_name=error.format_name, reason=str(error), cures=cures.cures(error, cancelled=cancelled))


def _write_format(
    preset: Preset, format_name: str, path: Path, options: ExportOptions, *, uncertified: bool
) -> list[str]:
    """Write one format and its certificate. Returns sentences about the file."""
    export = certified_export.write(
        preset,
        format_name,
        path,
        name=path.name,
        attitude=options.attitude,
        ramp=options.ramp,
        once=options.once,
        uncertified=uncertified,
        otherwise=OTHERWISE,
    )
    name = path.name if export.complaint is None else formats.marked(path).name
    proof = "uncertified" if export.certificate is None else f"certified ({export.certificate.name})"
    about = [f"{format_name}, {FRAMES.get(export.output.frame, export.output.frame)}, {proof}", *export.notes]
    sentences = [f"{name}: {shortened(note.replace('any certificate', 'the certificate'), 4)}" for note in about]
    program = _write_program(export, preset.requirement.window, path.parent, name)
    return [*sentences, *program, *_certified(export, name)]


def _certified(export: CertifiedExport, name: str) -> list[str]:
    """What the certificate of a motion says of its windows, and of the noise for which it says that."""
    if export.certificate is None or export.output.steady is None:
        return []
    issued = encoding.loads(read_bytes(export.certificate), source=name)
    return [f"{name}: certified: {certificate_sentence(check.words)}" for check in issued.checks if check.met]


def _write_program(export: CertifiedExport, window: float, folder: Path, name: str) -> list[str]:
    """Write the program that flies a loop with a Crazyflie, if the file is one. Returns a sentence about it."""
    figures, steady, where = export.output.figures, export.output.steady, export.output.place
    if export.certificate is None or not export.output.loop or steady is None or where is None:
        return []
    begin, end = steady
    loop = crazyflie.Loop(
        ramp=begin, period=end - begin, first=figures["loop_first"], count=figures["loop_pieces"], window=window
    )
    place = folder / f"fly_{Path(name).name.partition('.')[0]}.py"
    place.write_text(crazyflie.script(name, loop, where), "utf-8")
    return [
        f"{place.name}: takes off, uploads {name}, flies ramp in, the loop as often as asked, and ramp out, and lands. "
        f"It needs cflib (pip install cflib). Run it in this folder: python {place.name} URI --loops {loop.least}; URI "
        "is that of your Crazyflie, such as radio://0/80/2M/E7E7E7E7E7. With --help it prints its options"
    ]


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
