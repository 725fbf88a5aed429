"""A record is checked before it is judged: every sensor against the others, gravity, the field, and the truth.

    read = formats.read("flight.csv", "log")
    checked = record_checks.checked(read, confirm={"accel-scale": "2"})     questions are in the result
    formats.settled(checked)                                                raises until they are answered
Each check is a row of `CHECKS`. Evidence against the record becomes a question, with the flag that answers it. An
answer that does not agree with the evidence is obeyed, and the record is then used and not judged. Ranges that are no
distances and poses that are lost are not used without an answer, and this is said.
"""

from collections.abc import Mapping
from dataclasses import replace

from rangenav.formats.import_result import ImportResult, Question
from rangenav.formats.recorded_flight import Flight
from rangenav.inputs import Vec3
from rangenav.number_format import vector
from rangenav.record_checks.check import Check, Evidence
from rangenav.record_checks.table import CHECKS, markdown
from rangenav.results import result

NAMED = 2
"""Most doubts that a reason lists."""


@result
class Checked:
    """A record with the answers applied, and what is left to ask and to doubt."""

    flight: Flight
    findings: tuple[str, ...]
    """What was corrected as confirmed, and what is not used."""
    questions: tuple[Question, ...]
    applied: tuple[Question, ...]
    """Those of checks with a usual answer, which is their suggestion; it is applied unless another one is given."""
    doubts: tuple[str, ...]
    """Evidence against the record that its answers leave."""

    @property
    def restriction(self) -> str | None:
        """Why the record is not judged, as one clause; None if nothing speaks against it."""
        return "; ".join(self.doubts[:NAMED]) or None


def check(flight: Flight, confirm: Mapping[str, str]) -> Checked:
    """Check a record. `confirm` holds answers by the keys of the questions. Raises ValueError for what is no answer."""
    flight, findings = _answered(flight, confirm)
    questions: dict[str, Question] = {}
    applied: list[Question] = []
    doubts: list[str] = []
    uncertain: set[str] = set()
    for row in CHECKS:
        if row.key in questions or uncertain.intersection(("time", row.about, *row.uses)):
            continue
        evidence = row.find(flight)
        if evidence is None:
            continue
        if not row.key:
            doubts.append(evidence.text)
            uncertain.add(row.about)
            continue
        answered = confirm.get(row.key)
        if row.default:
            applied.append(row.question(replace(evidence, suggestion=row.default)))
        if answered is None and row.default:
            flight = row.correct(flight, row.default)
            findings.append(f"{evidence.text}: {DEFAULTS[row.default]} ({row.flag} {row.options[-1]} uses them)")
        elif answered is None and evidence.suggestion is not None:
            questions[row.key] = row.question(evidence)
            flight = row.correct(flight, evidence.suggestion)  # what follows is checked as if it were confirmed
        else:
            uncertain.add(row.about)
            if answered is None:
                questions[row.key] = row.question(evidence)
            else:
                doubts.append(evidence.text)
    return Checked(
        flight=flight,
        findings=tuple(findings),
        questions=tuple(questions.values()),
        applied=tuple(applied),
        doubts=tuple(doubts),
    )


DEFAULTS = {"drop": "not used", "once": "counted once"}
"""What is said of an answer that is applied without a question."""


def corrected(flight: Flight, confirm: Mapping[str, str]) -> Flight:
    """The whole record with the answers applied: gravity, field and noise at its start are those of its sensors."""
    return _answered(flight, {key: answer for key, answer in confirm.items() if key != "gaps"})[0]


def _answered(flight: Flight, confirm: Mapping[str, str]) -> tuple[Flight, list[str]]:
    findings = []
    for row in {row.key: row for row in CHECKS if row.key}.values():
        answered = confirm.get(row.key)
        if answered is None or row.at_reading:
            continue
        before, flight = flight, row.correct(flight, answered)
        if row.key != "anchor" or before.anchor != flight.anchor:  # it may come from a person who was not asked
            findings.append(f"{row.confirmed(answered)}, as confirmed")
    return flight, findings


def checked(imported: ImportResult, confirm: Mapping[str, str], *, anchor: Vec3 | None = None) -> ImportResult:
    """The result of a reader with its flight checked: the flight corrected, findings and questions added.

    anchor: where the anchor stands (m, inertial), if a person says so. `unjudged` says why the flight is not judged.
    A path, or a flight with questions of its reader open, is returned as it is.
    """
    if imported.flight is None:
        return imported
    flight = imported.flight if anchor is None else replace(imported.flight, anchor=anchor)
    answers = dict(confirm) if anchor is None else {**confirm, "anchor": " ".join(repr(value) for value in anchor)}
    after_checks = check(flight, answers)
    return replace(
        imported,
        flight=after_checks.flight,
        findings=(*imported.findings, *_other_anchor(imported.flight, anchor), *after_checks.findings),
        questions=(*imported.questions, *after_checks.questions),
        applied=(*imported.applied, *after_checks.applied),
        unjudged=after_checks.restriction,
    )


def _other_anchor(flight: Flight, anchor: Vec3 | None) -> tuple[str, ...]:
    """That a person's anchor is not the one that the file states."""
    if anchor is None or flight.anchor is None or tuple(anchor) == tuple(flight.anchor):
        return ()
    return (f"anchor {vector(anchor)} m, given instead of {vector(flight.anchor)} m in the file",)


def restriction(flight: Flight) -> str | None:
    """The evidence against a record as it stands, as one clause; None if nothing speaks against it."""
    doubts, uncertain = [], set()
    for row in CHECKS:
        evidence = None if uncertain.intersection(("time", row.about, *row.uses)) else row.find(flight)
        if evidence is not None:
            doubts.append(evidence.text)
            uncertain.add(row.about)
    return "; ".join(doubts[:NAMED]) or None


__all__ = ["CHECKS", "Check", "Checked", "Evidence", "check", "checked", "corrected", "markdown", "restriction"]
