"""Columns of dates and times (ISO 8601, `2024-05-01T10:00:00.020Z`), read as seconds from the first one.

A time without a zone is taken as UTC, which shifts every stamp alike. Seconds from the first stamp keep microseconds.
"""

import re
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime

DATE = re.compile(r"\s*\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:[.,]\d+)?)?\s*(?:Z|[+-]\d\d(?::?\d\d)?)?\s*")
UNIT = "s"
SHOWN = 24
"""Most characters of a wrong entry that a message repeats."""


class Dates:
    """The columns (from 0) of one table that hold dates, and the first date of each."""

    def __init__(self, samples: Mapping[int, Sequence[str]]) -> None:
        """samples: entries of the first rows by column. A column holds dates if every one of its entries is one."""
        self.columns = tuple(k for k, entries in samples.items() if entries and all(map(DATE.fullmatch, entries)))
        self.first: dict[int, datetime] = {}
        self.zoned: dict[int, bool] = {}

    def replaced(self, row: Sequence[str], names: Sequence[str]) -> list[str]:
        """A row with its dates as seconds from the first. Raises ValueError naming the column of what is no date."""
        entries = list(row)
        for k in self.columns:
            text = entries[k].strip()
            if text:
                date = _date(text, names[k])
                self.zoned.setdefault(k, date.tzinfo is not None)
                date = date if date.tzinfo is not None else date.replace(tzinfo=UTC)
                entries[k] = repr((date - self.first.setdefault(k, date)).total_seconds())
        return entries

    def remarks(self, names: Sequence[str]) -> list[str]:
        """How the columns were understood, a clause for each."""
        return [
            f"column {names[k]} holds dates: read as seconds from {date.astimezone(UTC):%Y-%m-%d %H:%M:%S} UTC"
            + ("" if self.zoned[k] else ", as they name no zone")
            for k, date in self.first.items()
        ]


def _date(text: str, name: str) -> datetime:
    try:
        return datetime.fromisoformat(text.replace(" Z", "Z"))
    except ValueError:
        raise ValueError(f"{name[:SHOWN]} must be a date as in the rows before, got {text[:SHOWN]!r}") from None
