"""The content of a file that was read, what is wrong with it, and the questions that are open.

Nothing is converted silently. Where a unit, a frame or a sign is in doubt there is a `Question` with the answer that
the data suggest and the evidence, and `settled` raises until every question is answered.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.formats.recorded_flight import Flight, Frame
from rangenav.formats.text import Table
from rangenav.inputs import Vec3, require
from rangenav.results import result
from rangenav.signals import Signal

GRAVITY = 9.81
"""m/s², where a format says which way is down but not how strong."""
GAP = 1.75
"""A step longer than this many usual steps is a gap: at least one sample is missing."""
DROP = ("drop",)
"""What may be done with broken lines."""
FRAMES = ("z-up", "z-down")
OPTIONS_SHOWN, OPTION_SHOWN = 10, 80
"""Most options of a question that its sentence lists, and most characters of each."""
NAMED = 5
"""Most line numbers that a message lists; of more lines it gives the first ones and their count."""


@dataclass(frozen=True, kw_only=True)
class Question:
    """One thing that a file does not say."""

    key: str
    """Its key in `confirm`."""
    flag: str
    asks: str
    options: tuple[str, ...]
    suggestion: str | None
    evidence: str
    as_it_is: str = ""
    """The answer that takes a record as it is, against the evidence, so that it is not judged; empty if none does."""

    @property
    def text(self) -> str:
        """The question as one clause, with the evidence and the flag that answers it."""
        shown = [option if len(option) <= OPTION_SHOWN else f"{option[:OPTION_SHOWN]}…" for option in self.options]
        more = ["…"] if len(shown) > OPTIONS_SHOWN else []
        answer = self.suggestion or "|".join([*shown[:OPTIONS_SHOWN], *more])
        asked = f"{self.asks}? {self.evidence}: {typed_flag(self.flag, answer)}"
        if not self.as_it_is:
            return asked
        if answer == self.as_it_is:
            return f"{asked} takes the record as it is, and it is then not judged"
        return f"{asked} ({self.as_it_is} takes the record as it is, and it is then not judged)"


@result
class ImportResult:
    """What was read from a file."""

    source: str
    format: str
    rows: int
    rate: float | None
    """Hz, of the median step; None for a file without samples."""
    duration: float
    """s"""
    frame: Frame
    findings: tuple[str, ...]
    """Remarks on the file, one sentence each: units, gaps, jumps, missing columns, repeated stamps."""
    questions: tuple[Question, ...] = ()
    applied: tuple[Question, ...] = ()
    """Questions of checks to which the usual answer, the suggestion, is applied; another answer may be given."""
    path: Signal | None = None
    derivatives: Literal["file", "fit"] = "file"
    """Whether the derivatives up to snap stand in the file, or come from a fit."""
    fitted: str = ""
    """The kind of fit and its distance from the data; empty if the path is the file's own."""
    fit_error: float | None = None
    """m, the largest distance of the path from the file's positions; None if the path is the file's own."""
    unjudged: str | None = None
    """Why excitation cannot be judged from this path; None if it can."""
    flight: Flight | None = None
    columns: tuple[tuple[str, str], ...] = ()
    """The name of every column of a table, and the quantity that it is used for; empty if it is not used."""
    sha256: str = ""
    """SHA-256 of the file's bytes; empty for a folder."""


def unread(source: str, format: str, *, questions: tuple[Question, ...], rows: int = 0) -> ImportResult:
    """The result for a file that cannot be read before its questions are answered: there is nothing but them."""
    return ImportResult(
        source=source,
        format=format,
        rows=rows,
        rate=None,
        duration=0.0,
        frame="z-up",
        findings=(),
        questions=questions,
    )


class OpenQuestionsError(ValueError):
    """A file is not used, because it leaves something open; the sentence has every question, its evidence and flag."""

    def __init__(self, source: str, questions: tuple[Question, ...]) -> None:
        self.rule = f"{source}: not used before this is answered:"
        self.questions = questions
        super().__init__(f"{self.rule} {'; '.join(question.text for question in questions)}")


def typed_flag(flag: str, value: str) -> str:
    """A flag with its value as they are typed: -y+x+z alone would be taken for a flag, and three numbers are not."""
    return f"{flag}{'=' if value.startswith('-') and ' ' not in value else ' '}{value}"


def settled(result: ImportResult, *, also: tuple[Question, ...] = ()) -> ImportResult:
    """The result, if no question is open. Raises OpenQuestionsError if one is."""
    open_questions = (*result.questions, *also)
    if open_questions:
        raise OpenQuestionsError(result.source, open_questions)
    return result


def gravity(frame: Frame) -> Vec3:
    """The gravity vector of a frame."""
    return (0.0, 0.0, -GRAVITY if frame == "z-up" else GRAVITY)


def answer(confirm: Mapping[str, str], key: str, options: tuple[str, ...]) -> str | None:
    """The answer to a question, None if there is none. Raises ValueError if it is none of the options."""
    answered = confirm.get(key)
    rule = f"{key} must be one of {', '.join(options)}, got {answered!r}"
    require(answered is None or answered in options, rule)
    return answered


def asked_frame(confirm: Mapping[str, str], evidence: str) -> tuple[Frame, tuple[Question, ...]]:
    """Which way z points, where the format does not say, and the question if it is open."""
    answered = answer(confirm, "frame", FRAMES)
    asked = Question(
        key="frame",
        flag="--frame",
        asks="which way does z point",
        options=FRAMES,
        suggestion="z-up",
        evidence=evidence,
    )
    return "z-down" if answered == "z-down" else "z-up", () if answered else (asked,)


def spacing(time: Float[Array, "n"], table: Table, findings: list[str]) -> float | None:
    """The median rate (Hz) of increasing stamps; None for a single row. Gaps are added to the findings."""
    if len(time) < 2:
        return None
    steps = np.diff(time)
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > GAP * usual)
    if len(gaps):
        worst = int(gaps[np.argmax(steps[gaps])])
        places = lines(table.lines[gaps + 1])
        count = "1 gap" if len(gaps) == 1 else f"{len(gaps)} gaps"
        findings.append(f"{count}, the longest {steps[worst]:.3g} s (usual {usual:.3g} s): before {places}")
    return 1 / usual if usual > 0 else None


def repeated(time: Float[Array, "n"]) -> Bool[Array, "n"]:
    """Rows whose stamp is not later than every stamp before."""
    before = np.maximum.accumulate(np.concatenate([[-np.inf], time[:-1]]))
    return np.asarray(~(time > before))


def lines(numbers: Array, *, counted: bool = False) -> str:
    """Line numbers for a message: a few one by one, of many the first ones and the last.

    counted: whether the sentence has their count already.
    """
    if len(numbers) <= NAMED:
        return ("line " if len(numbers) == 1 else "lines ") + ", ".join(str(int(number)) for number in numbers)
    named = ", ".join(str(int(number)) for number in numbers[:NAMED])
    return f"lines {named} … {int(numbers[-1])}{'' if counted else f' ({len(numbers)} in all)'}"


def increasing(time: Float[Array, "n"], table: Table) -> None:
    """Raise ValueError naming the lines whose stamps do not increase."""
    bad = repeated(time)
    if bad.any():
        raise ValueError(f"{table.source}: stamps must increase: they repeat or go back on {lines(table.lines[bad])}")


def in_order(
    table: Table, time: Float[Array, "n"], confirm: Mapping[str, str], findings: list[str]
) -> tuple[Table, tuple[Question, ...]]:
    """The rows whose stamps increase, and the question whether the other rows may be dropped.

    A last row that is identical to the row before it is dropped without a question: it holds nothing new.
    """
    twice = last_row_twice(table.values)
    if twice.any():
        findings.append(f"the last row repeats the row before it: {lines(table.lines[-1:])} is not used")
    bad = repeated(time) & ~twice
    evidence = f"stamps repeat or go back on {lines(table.lines[bad])}"
    return kept_rows(table, ~(bad | twice)), broken_lines(evidence, confirm, findings) if bad.any() else ()


def last_row_twice(values: Float[Array, "n c"]) -> Bool[Array, "n"]:
    """The last row, if it is identical to the row before it: exporters that append the end write it twice."""
    twice = np.zeros(len(values), dtype=bool)
    twice[-1:] = len(values) > 1 and np.array_equal(values[-1], values[-2], equal_nan=True)
    return twice


def broken_lines(evidence: str, confirm: Mapping[str, str], findings: list[str]) -> tuple[Question, ...]:
    """The question what to do with broken lines, if it is open; what is wrong with the lines is one of the findings."""
    answered = answer(confirm, "lines", DROP)
    findings.append(evidence + (": dropped, as asked" if answered else ""))
    asks = "what to do with broken lines"
    asked = Question(key="lines", flag="--lines", asks=asks, options=DROP, suggestion="drop", evidence=evidence)
    return () if answered else (asked,)


def kept_rows(table: Table, kept: Bool[Array, "n"]) -> Table:
    """The table with some of its rows; each keeps its line number."""
    return replace(table, values=table.values[kept], lines=table.lines[kept])
