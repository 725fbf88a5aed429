"""Exchange formats: `read` understands a file and asks before it assumes, `export` writes a run.

`table` has one row for each format: what it reads, what it writes, what it keeps, how it is certified.
"""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path, PurePath

from rangenav.formats import text
from rangenav.formats.entries import BrokenLinesError
from rangenav.formats.format import Format, ReadOptions
from rangenav.formats.hover_ramps import RAMP
from rangenav.formats.import_result import (
    ImportResult,
    OpenQuestionsError,
    Question,
    broken_lines,
    settled,
    typed_flag,
    unread,
)
from rangenav.formats.output_files import ExportOptions, OutputFile, export_options, marked
from rangenav.formats.recorded_flight import Flight
from rangenav.formats.sampled_rows import FLIGHT, Part
from rangenav.formats.table import holding, markdown, names, readable, row, rows, unsupported, writable
from rangenav.inputs import require
from rangenav.preset import Preset

__all__ = [
    "RAMP",
    "ExportOptions",
    "Flight",
    "Format",
    "ImportResult",
    "OpenQuestionsError",
    "OutputFile",
    "Question",
    "export",
    "export_options",
    "guess",
    "holding",
    "markdown",
    "marked",
    "names",
    "parse",
    "read",
    "readable",
    "row",
    "rows",
    "settled",
    "typed_flag",
    "unsupported",
    "writable",
]


def read(
    path: str | Path,
    format: str,
    *,
    confirm: Mapping[str, str] | None = None,
    knots: float | None = None,
    part: Part = FLIGHT,
) -> ImportResult:
    """Understand a file. Open questions are in the result; `confirm` answers them (`{"gyro": "deg/s"}`).

    knots: s between the knots of a curve that is fitted to positions; None: the reader chooses. part: begin and end (s,
    from the first row) of what is read of a path; None: no limit.

    Raises ValueError with one sentence naming file and line for what cannot be read at all.
    """
    path, answers, chosen = Path(path), dict(confirm or {}), _readable(format)
    folder_reader = chosen.folder_reader
    if folder_reader is not None and path.is_dir():
        options = ReadOptions(source=path.name, confirm=answers, knots=knots, part=part)
        return _asked(format, path.name, lambda: folder_reader(path, options))
    data = text.contents(path, limit=chosen.max_bytes)
    return parse(data, format, source=path.name, confirm=answers, knots=knots, part=part)


def parse(
    data: bytes,
    format: str,
    *,
    source: str,
    confirm: Mapping[str, str],
    knots: float | None = None,
    part: Part = FLIGHT,
) -> ImportResult:
    """Understand the bytes of a file, as `read` does. `source` names the file in messages."""
    reader = _readable(format).reader
    assert reader is not None
    options = ReadOptions(source=source, confirm=confirm, knots=knots, part=part)
    result = _asked(format, source, lambda: reader(data, options))
    return replace(result, sha256=hashlib.sha256(data).hexdigest())


def _asked(format: str, source: str, reader: Callable[[], ImportResult]) -> ImportResult:
    """What a reader returns; where lines of a table are broken, the question what to do with them."""
    try:
        return reader()
    except BrokenLinesError as error:
        evidence = error.evidence if error.source == source else f"{error.source}, {error.evidence}"  # of a folder
        return unread(source, format, questions=broken_lines(evidence, {}, []))


def guess(name: str, head: str) -> str:
    """The name of the format that a file looks like, by its name and its first lines; a person confirms it."""
    suffix, head = PurePath(name.lower()).suffix, head.lower()
    by_name = [row.name for row in readable() if suffix in row.read_suffixes]
    by_head = [row.name for row in readable() if row.recognises(head)]
    return [*by_name, *by_head][0]


def export(
    preset: Preset, format: str, path: str | Path, *, attitude: str = "flown", ramp: float = RAMP, once: bool = False
) -> OutputFile:
    """Write a preset, or its run, in a format: a motion as finely as the format can hold it.

    attitude, ramp (s) and once are those of `ExportOptions`; a run has no use for them. Raises ValueError for what the
    format cannot hold, and why.
    """
    chosen = next((row for row in (*writable(), *unsupported()) if row.name == format), None)
    require(chosen is not None, f"{format}: no format that is written; written are {names(writable())}")
    assert chosen is not None
    require(not chosen.unsupported, f"{format}: {chosen.unsupported}")
    options = export_options(attitude=attitude, ramp=ramp, once=once)
    if chosen.drafts is not None:
        *_, finest = chosen.drafts(preset, options)
        written = finest(Path(path))
        if written.unfit is not None:
            Path(path).unlink()
            raise ValueError(written.unfit)
        return written
    assert chosen.writer is not None
    return chosen.writer(preset, Path(path))


def _readable(format: str) -> Format:
    chosen = next((row for row in readable() if row.name == format), None)
    if chosen is None:
        raise ValueError(f"{format}: no format that is read; read are {names(readable())}")
    return chosen
