"""A table as text, one row per line, with readable numbers: a line that nobody touched stands for its exact row."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

R = TypeVar("R")
DIGITS = 6
"""Significant digits of a number in the text."""
MAX_LINES = 5000
"""A text of more lines is refused before any line is read."""
MAX_QUOTE = 40
"""Characters of a line that an error message quotes."""


@dataclass(frozen=True)
class Table(Generic[R]):
    """How rows are written as lines of text, and lines read as rows. It holds no rows."""

    columns: Sequence[str]
    row: Callable[[list[float]], R]
    """Makes a row of the numbers of a line. Raises ValueError for numbers that make none."""
    cells: Callable[[R], Sequence[float]]
    """The numbers of a row."""

    def format(self, rows: Sequence[R]) -> str:
        """The text of the rows."""
        return "\n".join(self._lines(rows))

    def parse(self, text: str, formatted: Sequence[R] = ()) -> tuple[R, ...]:
        """The rows of a text. A line that `format` wrote for one of the rows `formatted` is that row to the last digit.

        Raises ValueError with the line's number and the rule that it breaks.
        """
        exact = dict(zip(self._lines(formatted), formatted, strict=True))
        lines = text.split("\n")
        if len(lines) > MAX_LINES:
            raise ValueError(f"at most {MAX_LINES} lines, got {len(lines)}")
        numbered = ((number, line.strip()) for number, line in enumerate(lines, 1) if line.strip())
        return tuple(exact[line] if line in exact else self._parsed(number, line) for number, line in numbered)

    def _lines(self, rows: Sequence[R]) -> list[str]:
        """A line for each row; with all digits where fewer would make two lines equal."""
        lines = ["  ".join(f"{value:.{DIGITS}g}" for value in self.cells(row)) for row in rows]
        if len(set(lines)) < len(rows):
            return ["  ".join(repr(value) for value in self.cells(row)) for row in rows]
        return lines

    def _parsed(self, number: int, line: str) -> R:
        cells = line.replace(",", " ").replace(";", " ").split()
        if len(cells) != len(self.columns):
            expected = f"{len(self.columns)} numbers, {' '.join(self.columns)}"
            raise ValueError(f"line {number}: expected {expected}, got {len(cells)} in “{line[:MAX_QUOTE]}”")
        try:
            return self.row([_number(cell) for cell in cells])
        except ValueError as error:
            raise ValueError(f"line {number}: {error}") from None


def _number(cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or "_" in cell:
        raise ValueError(f"“{cell[:MAX_QUOTE]}” is not a number")
    return value
