"""The dialect of a table of numbers: what separates its entries, whether they are quoted, and which mark decimals have.

The separator is measured: each one splits the first lines, a number counts 1, any other entry −WRONG, and the largest
sum wins. The rows are split by the `csv` module of the standard library: it reads quotes and line breaks inside them,
says which line it is at, and adds no dependency; the large readers of tables cannot name the line of a wrong entry.
"""

import csv
import re
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _csv import Reader  # the type of csv.reader(…), which has no public name

SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", " ": "blanks", "|": "vertical bars"}
"""In the order in which equal sums are decided."""
WRONG = 2
"""An entry that is no number weighs against a separator as much as this many numbers weigh for it."""
COMMA = re.compile(r"\s*[-+]?\d*,\d+(?:[eE][-+]?\d+)?\s*")
INDEX = re.compile(r"[0-9]{1,15}")
POINT = re.compile(r"\s*[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?\s*|\s*nan\s*", re.IGNORECASE)


@dataclass(frozen=True, kw_only=True)
class Dialect:
    """How the lines of one file are split."""

    separator: str = ","
    decimal_comma: bool = False
    quoted: bool = False

    def remarks(self, usual: str) -> tuple[str, ...]:
        """A clause for each difference from the usual separator, decimal points and no quotes."""
        return (
            *((f"the entries are separated by {SEPARATORS[self.separator]}",) if self.separator != usual else ()),
            *(("the numbers have decimal commas",) if self.decimal_comma else ()),
            *(("entries stand in quotes",) if self.quoted else ()),
        )

    def rows(self, lines: Iterable[str]) -> "Reader":
        """The entries of each row. Raises csv.Error for a quote that is left open."""
        if self.separator == " ":
            lines = (" ".join(line.split()) for line in lines)
        return csv.reader(lines, delimiter=self.separator, skipinitialspace=True, strict=True)


def measured(lines: Sequence[str]) -> Dialect:
    """The dialect of the first lines of a file, of which the first may hold names; comments are left out."""
    quoted = any('"' in line for line in lines)
    candidates = [Dialect(separator=separator, quoted=quoted) for separator in SEPARATORS]
    tried = [(_worth(dialect, lines), dialect) for dialect in candidates]
    best = max(worth for worth, _ in tried)
    chosen = next(dialect for worth, dialect in tried if worth == best)
    entries = [entry for row in split(chosen, lines) for entry in row]
    with_comma = any(COMMA.fullmatch(entry) for entry in entries)
    with_point = any("." in entry and POINT.fullmatch(entry) for entry in entries)
    return Dialect(separator=chosen.separator, quoted=quoted, decimal_comma=with_comma and not with_point)


def is_number(entry: str) -> bool:
    """Whether an entry is a number, with a decimal point or a decimal comma."""
    return bool(POINT.fullmatch(entry) or COMMA.fullmatch(entry))


def counted(lines: Sequence[str], dialect: Dialect, width: int) -> bool:
    """Whether every line has `width` entries, of which the first counts the lines: an index that the header omits."""
    rows = split(dialect, lines)
    if not rows or any(len(row) != width or not row[-1].strip() for row in rows) or not INDEX.fullmatch(rows[0][0]):
        return False
    return [row[0] for row in rows] == [str(int(rows[0][0]) + k) for k in range(len(rows))]


def filled(lines: Sequence[str], dialect: Dialect) -> dict[int, list[str]]:
    """The entries of each column (from 0) in these lines that are not empty."""
    found: dict[int, list[str]] = {}
    for row in split(dialect, lines):
        for k, entry in enumerate(row):
            if entry.strip():
                found.setdefault(k, []).append(entry)
    return found


def texts(lines: Sequence[str], dialect: Dialect) -> dict[int, str]:
    """The columns (from 0) without a number in these lines, each with one of the entries that are text."""
    columns = sorted(filled(lines, dialect).items())
    return {k: entries[0].strip() for k, entries in columns if not any(map(is_number, entries))}


def _worth(dialect: Dialect, lines: Sequence[str]) -> tuple[bool, int, bool, int]:
    """Of a separator: whether it separates anything; its numbers less what is none; whether all rows are equally long;
    the entries of the first."""
    rows = split(dialect, lines)
    entries = [entry for row in rows[1:] for entry in row if entry.strip()]
    numbers = sum(map(is_number, entries))
    lengths = [len(row) for row in rows] or [0]
    worth = numbers - WRONG * (len(entries) - numbers)
    return max(lengths) > 1, worth, min(lengths) == max(lengths), lengths[0]


def split(dialect: Dialect, lines: Sequence[str]) -> list[list[str]]:
    """The rows of a few lines, as far as their quotes can be read."""
    rows = []
    with suppress(csv.Error):  # the reader of the whole file names the line
        rows.extend(dialect.rows(lines))
    return rows
