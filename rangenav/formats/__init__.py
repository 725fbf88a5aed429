"""Exchange formats, one file each: `read` understands a file and asks before it assumes, `export` writes a run.

read     reference, polynomial, tum, euroc: paths     log, mat, euroc: recorded flights
write    preset, reference, polynomial, bag, mcap, tum, euroc, mat, npz, csv, log     never: bezier, qgc
"""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from rangenav.formats import text
from rangenav.formats.import_result import ImportResult, Question, settled
from rangenav.formats.output_files import OutputFile, marked
from rangenav.formats.recorded_flight import Flight
from rangenav.formats.unsupported import REFUSED
from rangenav.inputs import require
from rangenav.preset import Preset

READ = ("reference", "polynomial", "tum", "euroc", "log", "mat")
WRITTEN = ("preset", "reference", "polynomial", "bag", "mcap", "tum", "euroc", "mat", "npz", "csv", "log")
SUFFIXES = {".mat": "mat", ".txt": "tum", ".tum": "tum"}
MAX_MAT = 256_000_000

__all__ = [
    "READ",
    "REFUSED",
    "WRITTEN",
    "Flight",
    "ImportResult",
    "OutputFile",
    "Question",
    "export",
    "marked",
    "read",
    "settled",
]


def read(
    path: str | Path, format: str, *, confirm: Mapping[str, str] | None = None, knots: float | None = None
) -> ImportResult:
    """Understand a file. Open questions are in the result; `confirm` answers them (`{"gyro": "deg/s"}`).

    Raises ValueError with one sentence naming file and line for what cannot be read at all.
    """
    path, answers = Path(path), dict(confirm or {})
    require(format in READ, f"{format}: read are {', '.join(READ)}")
    if format == "euroc":
        from rangenav.formats import euroc

        return euroc.read(path, confirm=answers, knots=knots)
    data = text.contents(path, limit=MAX_MAT if format == "mat" else text.MAX_BYTES)
    return parse(data, format, source=path.name, confirm=answers, knots=knots)


def parse(
    data: bytes, format: str, *, source: str, confirm: Mapping[str, str], knots: float | None = None
) -> ImportResult:
    """The same for bytes that have been read already."""
    return replace(_parsed(data, format, source, confirm, knots), sha256=hashlib.sha256(data).hexdigest())


def _parsed(data: bytes, format: str, source: str, confirm: Mapping[str, str], knots: float | None) -> ImportResult:
    from rangenav.formats import log, mat, polynomial, reference, tum

    match format:
        case "reference":
            return reference.parse(data, source=source, knots=knots)
        case "polynomial":
            return polynomial.parse(data, source=source)
        case "tum":
            return tum.parse(data, source=source, confirm=confirm, knots=knots)
        case "mat":
            return mat.parse(data, source=source, confirm=confirm)
        case _:
            return log.parse(data, source=source, confirm=confirm)


def export(preset: Preset, format: str, path: str | Path, *, attitude: str = "flown") -> OutputFile:
    """Write a preset, or its run, in a format. Raises ValueError for what the format cannot hold, and why."""
    require(format not in REFUSED, f"{format}: {REFUSED.get(format, '')}")
    require(format in WRITTEN, f"{format}: written are {', '.join(WRITTEN)}")
    require(attitude in ("flown", "preset"), f"attitude must be flown or preset, got {attitude!r}")
    return _writer(format, attitude)(preset, Path(path))


def _writer(format: str, attitude: str) -> Callable[[Preset, Path], OutputFile]:
    from rangenav.formats import arrays, euroc, log, polynomial, reference, ros, tum

    def as_preset(preset: Preset, path: Path) -> OutputFile:
        from rangenav.formats.output_files import write_text
        from rangenav.preset import dumps

        write_text(path, dumps(preset))
        return OutputFile(files=(path,), frame="as the preset has it")

    writers: dict[str, Callable[[Preset, Path], OutputFile]] = {
        "preset": as_preset,
        "reference": lambda preset, path: reference.write(
            preset, path, attitude="preset" if attitude == "preset" else "flown"
        ),
        "polynomial": polynomial.write,
        "bag": ros.write_bag,
        "mcap": ros.write_mcap,
        "tum": tum.write,
        "euroc": euroc.write,
        "mat": arrays.write_mat,
        "npz": arrays.write_npz,
        "csv": arrays.write_csv,
        "log": log.write,
    }
    return writers[format]
