"""The entries of a table as numbers: missing ones are NaN, dates are seconds, and a line that is no row is broken.

A line is broken if it has another number of entries than there are columns, or an entry that is no number: text, inf,
the header once more. Broken lines are left out only if that is confirmed (`--lines drop`).
"""

from array import array
from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.formats.dates import Dates
from rangenav.formats.lines import Lines, Row
from rangenav.inputs import require
from rangenav.results import result

MAX_ROWS = 1_000_000
MAX_NUMBERS = 20_000_000
"""In all rows together: the eighteen columns of an own log of ten minutes at 1 kHz are eleven million."""
LARGEST = 1e20
"""Nanoseconds since 1970 are 2e18; no measured number is larger, and the square of this is finite."""
MOST_BROKEN = 0.2
"""Largest share of broken lines that may be left out: a file with more of them is no table of numbers."""
SHOWN = 24
"""Most characters of a wrong entry that a message repeats."""


class BrokenLinesError(ValueError):
    """Some lines of a table are no rows, and whether they may be left out is not confirmed."""

    def __init__(self, source: str, broken: "Broken") -> None:
        self.source, self.evidence = source, broken.summary
        super().__init__(f"{source}, {broken.reasons[0]}")


@result
class Broken:
    """The lines that are no rows."""

    numbers: tuple[int, ...]
    reasons: tuple[str, ...]
    """The line and what is wrong with it, of the first ones."""

    @property
    def summary(self) -> str:
        """The first broken line and its reason, and how many there are."""
        more = len(self.numbers) - 1
        rest = f" (and {more} more, the last is line {self.numbers[-1]})" if more else ""
        return f"{self.reasons[0]}{rest}"


@result
class Entries:
    """The numbers of a table."""

    values: Float[Array, "n c"]
    numbers: Int[Array, "n"]
    """The line number of each row."""
    broken: Broken


def parsed(
    rows: Iterator[Row], names: Sequence[str], kept: Sequence[int], lines: Lines, *, comma: bool, dates: Dates
) -> Entries:
    """The numbers of the columns `kept`, row after row, and the lines that are broken.

    comma: whether decimals have a comma. dates: the columns that hold dates. Raises ValueError for a table that is too
    large, has no row, or more broken lines than MOST_BROKEN.
    """
    values, numbers, broken, reasons = array("d"), array("q"), array("q"), []
    width, every = len(names), len(kept) == len(names)
    for number, row in rows:
        try:
            if len(row) != width:
                row = _as_wide(row, names)
            if dates.columns:
                row = dates.replaced(row, names)
            entries = row if every else [row[k] for k in kept]
            if comma:
                entries = [entry.replace(",", ".") for entry in entries]
            values.extend(_numbers(entries, names, kept, underscored=number in lines.underscored))
            numbers.append(number)
        except ValueError as error:
            broken.append(number)
            if not reasons:
                reasons.append(f"line {number}: {error}")
        require(len(numbers) + len(broken) <= MAX_ROWS, f"{lines.source}: more than {MAX_ROWS} rows")
        require(len(values) <= MAX_NUMBERS, f"{lines.source}: more than {MAX_NUMBERS} numbers")
    total = len(numbers) + len(broken)
    require(total > 0, f"{lines.source}: no rows of numbers")
    many = len(broken) > max(1, MOST_BROKEN * total)
    require(not many, f"{lines.source}, {reasons[0] if reasons else ''} ({len(broken)} of {total} lines are broken)")
    require(len(numbers) > 0, f"{lines.source}, {reasons[0] if reasons else ''}")
    table = np.frombuffer(values).reshape(len(numbers), len(kept))
    return _without_large(table, np.frombuffer(numbers, dtype=np.int64), names, kept, (list(broken), reasons), lines)


def _without_large(
    values: Array,
    numbers: Array,
    names: Sequence[str],
    kept: Sequence[int],
    broken: tuple[list[int], list[str]],
    lines: Lines,
) -> Entries:
    """The rows without those that have an infinite or too large number, which are broken as well."""
    others, reasons = broken
    low, high = (ends.reduce(values, axis=None, initial=0.0) for ends in (np.fmin, np.fmax))  # pass over NaN
    if max(-low, high) > LARGEST:
        large = np.abs(values) > LARGEST
        row, column = np.argwhere(large)[0]
        size = f"must not exceed {LARGEST:g}, got {values[row, column]:.3g}"
        reason = f"line {numbers[row]}: {names[kept[column]][:SHOWN]} {size}"
        reasons = [reason] if not others or numbers[row] < others[0] else reasons
        whole = ~large.any(axis=-1)
        others = sorted([*others, *numbers[~whole].tolist()])
        values, numbers = values[whole], numbers[whole]
        total = len(others) + len(numbers)
        many = len(others) > max(1, MOST_BROKEN * total) or not len(numbers)
        require(not many, f"{lines.source}, {reasons[0]} ({len(others)} of {total} lines are broken)")
    return Entries(values=values, numbers=numbers, broken=Broken(numbers=tuple(others), reasons=tuple(reasons)))


def _numbers(entries: Sequence[str], names: Sequence[str], kept: Sequence[int], *, underscored: bool) -> list[float]:
    try:
        if underscored:
            raise ValueError
        if "" in entries:
            return [float(entry) if entry else np.nan for entry in entries]
        return list(map(float, entries))
    except ValueError:
        return [_number(entry.strip(), names[k]) for entry, k in zip(entries, kept, strict=True)]


def _as_wide(row: Sequence[str], names: Sequence[str]) -> list[str]:
    """The row without empty entries behind the last column. Raises ValueError for another number of entries."""
    width = len(names)
    shortened = list(row) if len(row) < width else [*row[:width], *trimmed(row[width:])]
    require(len(shortened) == width, f"{len(shortened)} entries where {width} columns are named")
    return shortened


def trimmed(row: Sequence[str]) -> list[str]:
    """A row without the empty entries at its end, which trailing separators make."""
    end = next((k for k in range(len(row), 0, -1) if row[k - 1].strip()), 0)
    return list(row[:end])


def _number(entry: str, name: str) -> float:
    """One entry, NaN if it is empty. Raises ValueError for what is no number."""
    require(not entry or " ".join(entry.split()) != name, "the header once more")
    try:
        if "_" in entry:
            raise ValueError
        return float(entry) if entry else np.nan
    except ValueError:
        mangled = "; spreadsheets mangle stamps into times of day" if ":" in entry or "/" in entry else ""
        raise ValueError(f"{name[:SHOWN]} must be a number, got {entry[:SHOWN]!r}{mangled}") from None
