"""The rows of a path that was sampled: the unit of their stamps, the part that is used, and the gaps between them.

What the stamps leave open is asked: a unit other than the format's, and a gap through which a curve would be the fit's
alone. The path begins at t = 0 with the first row that is used.
"""

import math
from collections.abc import Mapping

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import units
from rangenav.formats.import_result import Question, answer, in_order, kept_rows, spacing
from rangenav.formats.text import Table
from rangenav.inputs import require
from rangenav.results import result

LONG_GAP, LONG_STEPS = 0.25, 4.0
"""A gap of more seconds and of more usual steps than these is asked about; through a shorter one a curve is sure."""
GAPS = ("longest", "bridge")
"""Use the longest part without a gap, or draw the curve through the gaps."""
Part = tuple[float | None, float | None]
"""Begin and end (s, from the first row) of what is used; None: there is no limit."""
FLIGHT: Part = (None, None)
"""All of a path but the ramps from hover and back that an export has (`hover_ramps`)."""
WHOLE: Part = (0.0, None)
"""All of a file."""


@result
class SampledRows:
    """The rows that are used."""

    table: Table
    time: Float[Array, "n"]
    """s from the first row that is used, increasing."""
    rate: float | None
    """Hz, of the median step; None for a single row."""
    unit: str
    """That of the stamps."""
    confirmed: bool
    """Whether a person has confirmed the unit; otherwise it is the format's."""
    questions: tuple[Question, ...]
    """Without an answer to these nothing is to be fitted, unless they are about lines only."""

    @property
    def fits(self) -> bool:
        """Whether unit and gaps are settled, so that a curve may be fitted."""
        return not any(question.key in ("time", "gaps") for question in self.questions)

    def summary(self, conventions: str) -> str:
        """The number of rows, their length, the format's conventions and the unit of the stamps, as one clause."""
        length = f"{len(self.time)} rows, {self.time[-1]:.4g} s"
        if self.confirmed:
            return f"{length}; {conventions} as the format has it, stamps in {self.unit} as confirmed"
        return f"{length}; {conventions} and stamps in {self.unit} as the format has it"


def sampled(
    table: Table,
    stamps: Float[Array, "n"],
    *,
    unit: str,
    confirm: Mapping[str, str],
    part: Part,
    least: int,
    findings: list[str],
) -> SampledRows:
    """The rows to be used of a table whose stamps have the format's unit, and what is open.

    least: the number of rows that make a path. Raises ValueError if fewer are left.
    """
    require(len(stamps) >= least, f"{table.source}: {len(stamps)} rows are no path: at least {least}")
    order, questions = in_order(table, stamps, confirm, findings)
    stamps = stamps[np.isin(table.lines, order.lines)]
    require(len(stamps) >= least, f"{table.source}: {len(stamps)} rows with increasing stamps are no path")
    factor, asked = _factor(stamps, unit, confirm)
    questions += asked
    time = (stamps - stamps[0]) * factor
    if stamps[0] != 0:
        findings.append(f"the first row is at {stamps[0] * factor:.10g} s, which is t = 0 of the path")
    inside = _between(time, part, table.source, findings)
    used, time = kept_rows(order, inside), time[inside]
    inside, asked = _without_gaps(used, time, confirm, findings)
    questions += asked
    used, time = kept_rows(used, inside), time[inside]
    require(len(time) >= least, f"{table.source}: {len(time)} rows are left, which are no path: at least {least}")
    rate = spacing(time, used, findings)
    return SampledRows(
        table=used,
        time=time - time[0],
        rate=rate,
        unit=confirm.get("time", unit),
        confirmed="time" in confirm,
        questions=tuple(questions),
    )


def _factor(stamps: Array, unit: str, confirm: Mapping[str, str]) -> tuple[float, tuple[Question, ...]]:
    """Seconds in a unit of the stamps, and the question for the unit if the stamps' steps contradict the format's."""
    known = units.UNITS["time"]
    answered = answer(confirm, "time", tuple(known))
    if answered is not None:
        return known[answered], ()
    guess = units.guess("time", stamps[:, None], time=stamps)
    if guess.unit == unit:
        return known[unit], ()
    asked = Question(
        key="time",
        flag="--time-unit",
        asks="in which unit are the stamps",
        options=tuple(known),
        suggestion=guess.unit,
        evidence=f"the format has {unit}, but {guess.evidence}",
    )
    return known[guess.unit or unit], (asked,)


def _between(time: Array, part: Part, source: str, findings: list[str]) -> Array:
    """The rows of a part of the file, as a mask."""
    begin, end = (-math.inf if part[0] is None else part[0]), (math.inf if part[1] is None else part[1])
    rule = f"{source}: the part from {begin:g} s to {end:g} s is none of the {time[-1]:.6g} s of the file"
    require(begin < end and begin < time[-1] and end > 0, rule)
    inside = np.asarray((time >= begin) & (time <= end))
    if not inside.all():
        used = time[inside]
        require(len(used) > 0, rule)
        findings.append(f"used: {used[0]:.6g} s to {used[-1]:.6g} s of the file's {time[-1]:.6g} s")
    return inside


def _without_gaps(
    table: Table, time: Array, confirm: Mapping[str, str], findings: list[str]
) -> tuple[Array, tuple[Question, ...]]:
    """The rows to be used, as a mask, and the question what to do with long gaps."""
    every, answered = np.ones(len(time), dtype=bool), answer(confirm, "gaps", GAPS)
    steps = np.diff(time)
    gaps = np.flatnonzero(steps > max(LONG_GAP, LONG_STEPS * float(np.median(steps)))) if len(steps) else steps[:0]
    if len(gaps) == 0:
        return every, ()
    worst = int(gaps[np.argmax(steps[gaps])])
    edges = np.concatenate([[0], gaps.astype(int) + 1, [len(time)]])
    longest = int(np.argmax(time[edges[1:] - 1] - time[edges[:-1]]))
    first, last = int(edges[longest]), int(edges[longest + 1]) - 1
    kept = f"from {time[first]:.6g} s to {time[last]:.6g} s"
    where = (
        f"no rows for {steps[worst]:.3g} s between line {table.lines[worst]} at {time[worst]:.6g} s and line "
        f"{table.lines[worst + 1]} at {time[worst + 1]:.6g} s"
    )
    more = "" if len(gaps) == 1 else f" ({len(gaps)} such gaps)"
    if answered == "bridge":
        findings.append(f"{where}{more}: the curve is drawn through, as asked")
        return every, ()
    if answered == "longest":
        findings.append(f"{where}{more}: used {kept} of the file, as asked")
        index = np.arange(len(time))
        return np.asarray((index >= first) & (index <= last)), ()
    evidence = (
        f"{where}{more}; longest uses the part {kept}, bridge draws the curve through, begin and end cut anywhere"
    )
    asks = "what to do with the gap" if len(gaps) == 1 else "what to do with the gaps"
    asked = Question(key="gaps", flag="--gaps", asks=asks, options=GAPS, suggestion="longest", evidence=evidence)
    return every, (asked,)
