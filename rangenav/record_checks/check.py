"""One check of a recorded flight: a pure function of the record, its question, and the flag that answers it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from rangenav.formats import units
from rangenav.formats.import_result import Question
from rangenav.formats.recorded_flight import Flight

Quantity = Literal["time", "gyro", "accel", "mag", "attitude", "position", "range"]
"""What a check is about, and what it relies on. Every check relies on the time."""
NEAR = 0.2
"""Relative: a factor this near to that of a unit suggests the unit."""


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """What contradicts a record, with figures, and the answer that would explain it."""

    text: str
    suggestion: str | None


Find = Callable[[Flight], Evidence | None]
"""The evidence against a record; None if there is none, or the record cannot tell."""


def _as_it_is(flight: Flight, _: str) -> Flight:
    return flight


@dataclass(frozen=True, kw_only=True)
class Check:
    """One row of the table of checks."""

    name: str
    """What is checked."""
    compares: str
    """How it is checked, for the documentation, a sentence without a full stop."""
    about: Quantity
    """What is in doubt where there is evidence."""
    uses: tuple[Quantity, ...] = ()
    """What else must be free of doubt for the check to mean anything."""
    find: Find
    key: str = ""
    """Of the question, in `confirm`; empty where no answer helps, and the record is not judged."""
    flag: str = ""
    asks: str = ""
    options: tuple[str, ...] = ()
    """Answers that are always possible. The last one takes the record as it is."""
    correct: Callable[[Flight, str], Flight] = _as_it_is
    """The record with an answer applied. Raises ValueError for a text that is no answer."""
    unit: str = ""
    """Of an answer that is a number, or several."""
    said: Mapping[str, str] = field(default_factory=dict)
    """What is said of answers that the name does not explain."""
    at_reading: bool = False
    """Whether the reader of the file applies the answer, as it does for units."""
    confirmable: bool = False
    """Whether a record that is taken as it is may be judged: a person knows more than the file."""
    default: str = ""
    """The answer that is applied and said without a question; empty where there is a question."""

    def confirmed(self, answer: str) -> str:
        """An answer as a clause."""
        return self.said.get(answer, f"{self.name} {answer}{f' {self.unit}' if self.unit else ''}")

    def question(self, evidence: Evidence) -> Question:
        """The question with its evidence; the suggestion is one of the options."""
        suggested = evidence.suggestion
        own = () if suggested is None or suggested in self.options else (suggested,)
        return Question(
            key=self.key,
            flag=self.flag,
            asks=self.asks,
            options=(*own, *self.options),
            suggestion=suggested,
            evidence=evidence.text,
            as_it_is="" if self.at_reading or self.confirmable or not self.options else self.options[-1],
        )


def unit_for(flight: Flight, kind: str, factor: float) -> str | None:
    """The unit that multiplies the values of a quantity by this factor, near enough; None if there is none."""
    known = units.UNITS[kind]
    current = known[flight.units.get(kind, units.SI[kind])]
    near = {unit: abs(known[unit] / (current * factor) - 1) for unit in known} if factor > 0 else {}
    unit = min(near, key=lambda one: near[one], default=None)
    return unit if unit is not None and near[unit] < NEAR and known[unit] != current else None


def unit_factor(flight: Flight, kind: str, unit: str) -> float:
    """The factor by which the values of a quantity change if its unit is another one."""
    known = units.UNITS[kind]
    return known[unit] / known[flight.units.get(kind, units.SI[kind])]
