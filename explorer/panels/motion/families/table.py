"""A table as text, one row per line: readable numbers, and behind every line that was not touched its exact row."""

import math
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

R = TypeVar("R")
DIGITS = 6
MAX_LINES = 5000
"""Lines looked at; more are refused before any is read."""
MAX_QUOTE = 40
"""Characters of a line that a sentence repeats."""


class Table(Generic[R]):
    """Text and rows of the same table."""

    def __init__(
        self, columns: Sequence[str], row: Callable[[list[float]], R], cells: Callable[[R], Sequence[float]]
    ) -> None:
        self._columns, self._row, self._cells = tuple(columns), row, cells
        self._exact: dict[str, R] = {}
        self._last: tuple[str, tuple[R, ...]] = ("", ())

    @property
    def points(self) -> tuple[R, ...]:
        """The rows of the text that was formatted or parsed last."""
        return self._last[1]

    def format(self, rows: Sequence[R]) -> str:
        """Text for the rows; they are kept, digits and all, for when it comes back."""
        lines = [self._line(row) for row in rows]
        self._exact = dict(zip(lines, rows, strict=True))
        if len(self._exact) < len(rows):  # two rows that look alike and are not: all their digits, then
            lines = ["  ".join(repr(value) for value in self._cells(row)) for row in rows]
            self._exact = dict(zip(lines, rows, strict=True))
        self._last = "\n".join(lines), tuple(rows)
        return self._last[0]

    def parse(self, text: str) -> tuple[R, ...]:
        """The rows of a text. Raises ValueError naming line and rule."""
        if text == self._last[0]:
            return self._last[1]
        lines = text.split("\n")
        if len(lines) > MAX_LINES:
            raise ValueError(f"at most {MAX_LINES} lines, got {len(lines)}")
        rows = tuple(self._parsed(k, line.strip()) for k, line in enumerate(lines, 1) if line.strip())
        self._last = text, rows
        return rows

    def _line(self, row: R) -> str:
        return "  ".join(f"{value:.{DIGITS}g}" for value in self._cells(row))

    def _parsed(self, k: int, line: str) -> R:
        if line in self._exact:
            return self._exact[line]
        cells = line.replace(",", " ").replace(";", " ").split()
        expected = f"{len(self._columns)} numbers, {' '.join(self._columns)}"
        if len(cells) != len(self._columns):
            raise ValueError(f"line {k}: expected {expected}, got {len(cells)} in “{line[:MAX_QUOTE]}”")
        try:
            return self._row([_number(cell) for cell in cells])
        except ValueError as error:
            raise ValueError(f"line {k}: {error}") from None


def _number(cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or "_" in cell:
        raise ValueError(f"“{cell[:MAX_QUOTE]}” is no number")
    return value
