"""Reading text files within limits: the bytes of a file, and tables of numbers with the line number of each row.

The size of a file is checked before it is read, the length of a line before it is split. An entry that is no number is
refused with its line and column. An empty field is a missing number (NaN), and each reader of a table decides about it.
"""

from array import array
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.inputs import require
from rangenav.results import result

MAX_BYTES = 64_000_000
"""An hour of ten columns at 100 Hz; parsing takes some 0.1 s per million bytes."""
MAX_LINE = 8_192
"""Characters; the widest format has 33 columns."""
MAX_ROWS = 1_000_000
MAX_COLUMNS = 200
LARGEST = 1e20
"""Nanoseconds since 1970 are 2e18; no measured number is larger, and the square of this is finite."""
SHOWN = 24
"""Most characters of a wrong entry that a message repeats."""


@result
class Table:
    """Numbers in named columns."""

    source: str
    names: tuple[str, ...]
    """As in the header, without blanks at the ends; all different."""
    comments: tuple[str, ...]
    """Lines that begin with #, without it."""
    values: Float[Array, "n c"]
    """NaN where a field is empty or nan."""
    lines: Int[Array, "n"]
    """The line number of each row in the file, from 1."""


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


def decoded(data: bytes, *, source: str) -> str:
    """UTF-8 text, without the mark some editors put in front."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"{source}: not UTF-8 text (byte {error.start})") from None


def table(
    data: bytes, *, source: str, separator: str | None = ",", names: tuple[str, ...] | None = None, marked: bool = False
) -> Table:
    """Numbers between separators (None: blanks). The first line that is no comment names the columns, unless `names`.

    marked: the header is the first comment (EuRoC writes `#timestamp [ns],...`).
    """
    comments, values, lines = [], array("d"), array("q")
    for number, line in enumerate(decoded(data, source=source).splitlines(), 1):
        place = f"{source}, line {number}"
        require(len(line) <= MAX_LINE, f"{place}: longer than {MAX_LINE} characters")
        line = line.strip()
        if line.startswith("#"):
            comments.append(line[1:].strip())
            if marked and names is None:
                names = _header(line[1:], separator, place)
        elif line and names is None:
            names = _header(line, separator, place)
        elif line and names is not None:
            values.extend(_numbers(line, separator, names, place))
            lines.append(number)
            require(len(lines) <= MAX_ROWS, f"{source}: more than {MAX_ROWS} rows")
    require(names is not None and len(lines) > 0, f"{source}: no rows of numbers")
    assert names is not None
    return Table(
        source=source,
        names=names,
        comments=tuple(comments),
        values=np.array(values).reshape(len(lines), len(names)),
        lines=np.array(lines, dtype=int),
    )


def columns(table: Table, wanted: tuple[str, ...]) -> Float[Array, "n c"]:
    """Columns by their names. Raises ValueError naming those that are not there."""
    missing = [name for name in wanted if name not in table.names]
    require(not missing, f"{table.source}: no column named {', '.join(missing)}")
    return table.values[:, [table.names.index(name) for name in wanted]]


def refuse_missing(values: Float[Array, "n c"], table: Table, what: str) -> None:
    """Raise ValueError naming the first line where a number that cannot be done without is missing."""
    missing = np.asarray(np.isnan(values).any(axis=-1))
    if missing.any():
        line = int(table.lines[int(np.argmax(missing))])
        raise ValueError(f"{table.source}, line {line}: {what} is missing or not a number ({_count(missing)} in all)")


def _count(missing: Array) -> str:
    count = int(np.sum(missing))
    return f"{count} row" if count == 1 else f"{count} rows"


def _split(line: str, separator: str | None) -> list[str]:
    parts = [part.strip() for part in line.split(separator)]
    return parts[:-1] if parts[-1] == "" and len(parts) > 1 else parts


def _header(line: str, separator: str | None, place: str) -> tuple[str, ...]:
    names = tuple(_split(line, separator))
    require(len(names) <= MAX_COLUMNS, f"{place}: more than {MAX_COLUMNS} columns")
    for k, name in enumerate(names):
        require(name != "" and name.isprintable(), f"{place}: column {k + 1} has no name that can be read")
        require(name not in names[:k], f"{place}: two columns are named {name[:SHOWN]!r}")
    return names


def _numbers(line: str, separator: str | None, names: tuple[str, ...], place: str) -> list[float]:
    parts = line.split(separator)
    if len(parts) == len(names) + 1 and not parts[-1].strip():
        del parts[-1]  # a trailing comma is common, and means nothing
    require(len(parts) == len(names), f"{place}: {len(parts)} entries where {len(names)} columns are named")
    try:
        if "_" in line:  # float("1_0") is 10 to Python and a misprint to everybody else
            raise ValueError
        numbers = [float(part) if part else np.nan for part in parts]
    except ValueError:
        return [_number(part.strip(), name, place) for part, name in zip(parts, names, strict=True)]
    for number, part, name in zip(numbers, parts, names, strict=True):
        if abs(number) > LARGEST:
            raise ValueError(_too_large(part, name, place))
    return numbers


def _number(part: str, name: str, place: str) -> float:
    """One entry, and what is wrong with it."""
    try:
        if "_" in part:
            raise ValueError
        value = float(part) if part else np.nan
    except ValueError:
        mangled = "; spreadsheets mangle stamps into times of day" if ":" in part or "/" in part else ""
        message = f"{place}: {name[:SHOWN]} must be a number, got {part[:SHOWN]!r}{mangled}"
        raise ValueError(message) from None
    require(not abs(value) > LARGEST, _too_large(part, name, place))
    return value


def _too_large(part: str, name: str, place: str) -> str:
    return f"{place}: {name[:SHOWN]} must not exceed {LARGEST:g}, got {part.strip()[:SHOWN]!r}"
