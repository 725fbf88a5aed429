"""Reading text files within limits: the bytes of a file, and tables of numbers with the line number of each row.

The size of a file is checked before it is read, the length of a line before it is split. Separators, quotes, decimal
commas, columns without a name, and a header in a comment are understood (see `dialect`) and said in `Table.remarks`. An
entry that is no number is refused with its line and column. An empty field is a missing number (NaN), and each reader
of a table decides about it.
"""

import csv
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, islice
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.formats import dialect, entries, units
from rangenav.formats.dates import Dates
from rangenav.formats.dialect import Dialect
from rangenav.formats.entries import BrokenLinesError, trimmed
from rangenav.formats.lines import Lines, Row, begins_with_mark
from rangenav.inputs import require
from rangenav.results import result

MAX_BYTES = 64_000_000
"""An hour of ten columns at 100 Hz; parsing takes some 0.1 s per million bytes."""
MAX_COLUMNS = 200
SHOWN = 24
"""Most characters of a wrong entry that a message repeats."""
LISTED, NAME_SHOWN = 40, 48
"""Most names of columns that a message lists, and most characters of each."""
SI = ("s", "m", "m/s", "m/s2", "m/s3", "m/s4", "rad", "rad/s", "rad/s2", "1")
"""Units that the formats of paths have, as `units.spelled` writes them."""
MEASURED = 20
"""Lines from which the dialect is measured."""


@result
class Table:
    """Numbers in named columns."""

    source: str
    names: tuple[str, ...]
    """As in the header, without blanks at the ends; all different."""
    comments: tuple[str, ...]
    """Comments before the first row, without their mark."""
    values: Float[Array, "n c"]
    """NaN where a field is empty or nan."""
    lines: Int[Array, "n"]
    """The line number at which each row begins in the file, from 1."""
    remarks: tuple[str, ...] = ()
    """How the file was understood, a clause for each thing that is unusual."""
    texts: tuple[str, ...] = ()
    """Names of columns that hold text and are not in the table, each with an entry."""
    dated: tuple[str, ...] = ()
    """Names of columns that hold dates, which are seconds in the table."""


def contents(path: str | Path, *, limit: int = MAX_BYTES) -> bytes:
    """The bytes of a file. Raises ValueError, before reading, if it is no file or larger than the limit."""
    path = Path(path)
    try:
        require(path.exists(), f"{path}: no such file")
        require(path.is_file(), f"{path}: not a file")
        size = path.stat().st_size
        require(size <= limit, f"{path.name}: {size / 1e6:.0f} MB, more than the {limit / 1e6:.0f} MB that are read")
        with path.open("rb") as file:
            data = file.read(limit + 1)  # a file that has grown since, or states no size, is bounded as well
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror}") from None
    require(len(data) <= limit, f"{path.name}: more than the {limit / 1e6:.0f} MB that are read")
    return data


def table(
    data: bytes,
    *,
    source: str,
    separator: str = ",",
    names: tuple[str, ...] | None = None,
    marked: bool = False,
    header: str = "",
    drop: bool | None = None,
) -> Table:
    """Numbers in columns. The first line that is no comment names the columns, unless `names` does.

    If that line holds numbers, the last comment before it with as many entries names the columns. `marked` says that
    the format has its header in a comment (`#timestamp [ns],...`), and `separator` is the usual one of the format;
    another is read as well, with a remark. `header` is an example of the first line, for the message that there is
    none. `drop`: whether lines that are no rows may be left out; None if nobody can be asked.

    Raises BrokenLinesError if there are such lines and `drop` is False, ValueError for what cannot be read at all.
    """
    lines = Lines(data, source)
    first: list[str] = []
    for line in islice(lines.rest, MEASURED):
        lines.in_row = 0
        first.append(line)
    require(bool(first), f"{source}: no rows of numbers")
    layout = dialect.measured(first)
    remarks = [*(("a byte order mark in front",) if begins_with_mark(data) else ()), *layout.remarks(separator)]
    rows, texts, dates = _rows(first, lines, layout), {}, Dates({})
    if names is None:
        number, first_row = next(rows)
        named_before = _comment_with_names(lines, layout, first_row, header)
        if named_before is not None:
            number, first_row = named_before
            remarks += [] if marked else [f"the names of the columns are in the comment on line {number}"]
            rows = chain([next(_rows(first, lines, layout))], rows)
        samples = first if named_before is not None else first[1:]
        names = _names(first_row, samples, layout, f"{source}, line {number}")
        dates = Dates(dialect.filled(samples, layout))
        texts = {k: entry for k, entry in dialect.texts(samples, layout).items() if k < len(names) and names[k]}
        texts = {k: entry for k, entry in texts.items() if k not in dates.columns}
        remarks += [f"column {k} has no name and is not used" for k, name in enumerate(names, 1) if not name]
        remarks += [f"column {names[k][:NAME_SHOWN]} holds text and is not used" for k in texts]
    kept = [k for k, name in enumerate(names) if name and k not in texts]
    numbers = entries.parsed(rows, names, kept, lines, comma=layout.decimal_comma, dates=dates)
    remarks += [*dates.remarks(names), *_left_out(numbers.broken, drop, source)]
    return Table(
        source=source,
        names=tuple(names[k] for k in kept),
        comments=tuple(comment for _, (comment,) in lines.comments),
        values=numbers.values,
        lines=np.array(numbers.numbers, dtype=int),
        remarks=tuple(remarks),
        texts=tuple(f"{names[k][:NAME_SHOWN]} ({entry[:SHOWN]!r})" for k, entry in texts.items()),
        dated=tuple(names[k] for k in dates.columns),
    )


def _left_out(broken: entries.Broken, drop: bool | None, source: str) -> list[str]:
    """The remarks on broken lines that are left out. Raises ValueError where they may not be."""
    if not broken.numbers:
        return []
    if drop is None:
        raise ValueError(f"{source}, {broken.reasons[0]}")
    if not drop:
        raise BrokenLinesError(source, broken)
    return [f"{broken.summary}: dropped, as asked"]


def _rows(first: Sequence[str], lines: Lines, layout: Dialect) -> Iterator[Row]:
    """The entries of each row, and the number of the line where it begins. `first` was already taken from `lines`."""
    reader, numbers, begin = layout.rows(chain(first, lines.rest)), lines.numbers, 0
    try:
        for row in reader:
            lines.in_row = 0
            yield numbers[begin], row
            begin = reader.line_num
    except csv.Error as error:
        message = f"quotes that cannot be read in this line or after it ({error})"
        raise ValueError(f"{lines.source}, line {numbers[begin]}: {message}") from None


def _comment_with_names(lines: Lines, layout: Dialect, row: Sequence[str], header: str) -> Row | None:
    """The last comment that names the columns, and its line, if the first row holds a number; else None.

    The comment has as many entries as the row. Raises ValueError if there is none before a row of nothing but numbers.
    """
    filled = [entry for entry in row if entry.strip()]
    numbers = sum(map(dialect.is_number, filled))
    if numbers == 0:
        return None
    width = len(trimmed(row))
    split = [(number, trimmed(entries)) for number, text in lines.comments for entries in dialect.split(layout, text)]
    fitting = [(number, entries) for number, entries in split if len(entries) in (width, len(row)) and width > 1]
    rule = f"{lines.source}, line {lines.numbers[0]}: holds numbers, and no line before it names the columns"
    rule += f"; put a header before it: {header}" if header else ""
    require(bool(fitting) or numbers < len(filled), rule)
    return fitting[-1] if fitting else None


def _names(header: Sequence[str], samples: Sequence[str], layout: Dialect, place: str) -> tuple[str, ...]:
    """The names of the columns; "" for a column without one."""
    names = [" ".join(name.split()) for name in trimmed(header)]
    if dialect.counted(samples, layout, len(names) + 1):
        names.insert(0, "")
    require(len(names) <= MAX_COLUMNS, f"{place}: more than {MAX_COLUMNS} columns")
    require(any(names), f"{place}: no column has a name")
    for k, name in enumerate(names):
        require(name.isprintable(), f"{place}: column {k + 1} has no name that can be read")
        require(not name or name not in names[:k], f"{place}: two columns are named {name[:SHOWN]!r}")
    return tuple(names)


def with_si_names(table: Table) -> Table:
    """The table with its names without their units, where these are SI: `t [s]` is t, and `t [ms]` is no t."""
    split = [units.split(name) for name in table.names]
    bare = [base if unit in SI else name for name, (base, unit) in zip(table.names, split, strict=True)]
    return table if len(set(bare)) < len(bare) else replace(table, names=tuple(bare))


def columns(table: Table, wanted: tuple[str, ...]) -> Float[Array, "n c"]:
    """Columns by their names. Raises ValueError naming those that are not there."""
    missing = [name for name in wanted if name not in table.names]
    require(not missing, f"{table.source}: no column named {', '.join(missing)}; {listed(table)}")
    return table.values[:, [table.names.index(name) for name in wanted]]


def listed(table: Table) -> str:
    """The names of a table's columns, as a clause for a complaint."""
    more = f" … ({len(table.names)} in all)" if len(table.names) > LISTED else ""
    texts = f"; text and no numbers in {', '.join(table.texts[:LISTED])}" if table.texts else ""
    return f"the file's columns are {', '.join(name[:NAME_SHOWN] for name in table.names[:LISTED])}{more}{texts}"


def refuse_missing(values: Float[Array, "n c"], table: Table, what: str) -> None:
    """Raise ValueError, with the first such line, if a number is missing that the file must have."""
    missing = np.asarray(np.isnan(values).any(axis=-1))
    if missing.any():
        line = int(table.lines[int(np.argmax(missing))])
        raise ValueError(f"{table.source}, line {line}: {what} is missing or not a number ({_count(missing)} in all)")


def _count(missing: Array) -> str:
    count = int(np.sum(missing))
    return f"{count} row" if count == 1 else f"{count} rows"
