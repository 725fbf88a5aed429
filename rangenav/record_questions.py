"""Every question about a recorded flight at once: the reader's, those of the checks, of anchor, gravity and field.

    asked = record_questions.read(lambda confirm: formats.read("flight.csv", "log", confirm=confirm), {})
    formats.settled(asked.imported)      raises until all of them are answered
A record is not checked before its units are known, and gravity and field are not asked for before it is checked. So
the file is read again as if the suggested answers were confirmed, only to see which questions follow from them.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

from rangenav import record_checks, rest
from rangenav.formats.import_result import ImportResult, Question
from rangenav.formats.recorded_flight import Flight
from rangenav.inputs import Vec3
from rangenav.results import result

ROUNDS = 4
"""Most times that a file is read again: broken lines, columns, units, and one more."""
ORIGIN: Vec3 = (0.0, 0.0, 0.0)
"""m; stands for an anchor that is not known, where none is used."""
Part = Callable[[Flight], Flight]
Reader = Callable[[Mapping[str, str]], ImportResult]


@result
class Asked:
    """What was read with the answers that are confirmed, and what the suggested answers would lead to."""

    imported: ImportResult
    """With every question that is open."""
    preview: Flight | None
    """The flight as the suggested answers would give it; None if there is none."""
    whole: Flight | None
    """The same before a part of it is cut out: its start at rest tells gravity, field and noise of every part."""
    certain: bool
    """Whether every question of the reader has a suggested answer. If not, the first option was taken for the preview,
    whose checks mean nothing."""


def read(reader: Reader, confirm: Mapping[str, str], *, anchor: Vec3 | None = None, part: Part | None = None) -> Asked:
    """Read and check a file with the answers `confirm`. Raises ValueError for what cannot be read at all.

    reader: reads the file with answers by the keys of their questions. anchor: see `record_checks.checked`.
    part: cuts the part out that is used; the whole is used if it is None.
    """

    def checked(answers: Mapping[str, str]) -> tuple[ImportResult, Flight | None]:
        read = reader(answers)
        if read.flight is None:
            return read, None
        used = read if part is None else replace(read, flight=part(read.flight))
        result = record_checks.checked(used, answers, anchor=anchor)
        suggested = {question.key: question.suggestion for question in result.questions if question.suggestion}
        return result, record_checks.corrected(read.flight, {**suggested, **answers})

    imported, whole = checked(confirm)
    preview = imported
    questions = {question.key: question for question in imported.questions}
    answers, certain = dict(confirm), True
    for _ in range(ROUNDS):
        if preview.flight is not None or preview.path is not None or not preview.questions:
            break
        certain = certain and all(question.suggestion for question in preview.questions)
        answers |= {question.key: question.suggestion or question.options[0] for question in preview.questions}
        try:
            preview, whole = checked(answers)
        except ValueError:  # it will be said once these answers are confirmed
            break
        if certain:
            questions |= {question.key: question for question in preview.questions if question.key not in questions}
    every = replace(imported, questions=tuple(questions.values()))
    return Asked(imported=every, preview=preview.flight, whole=whole, certain=certain)


def of_world(
    asked: Asked, *, vectors: tuple[Vec3, Vec3] | None, still: bool, synthetic: bool = False
) -> tuple[Question, ...]:
    """The questions where anchor, gravity and field of a record are that has ranges, as far as they can be asked.

    vectors: gravity and field that a person has given. still: whether the still start is confirmed for them. synthetic:
    whether ranges to an anchor that was given are made for it.
    """
    flight = asked.preview
    if flight is None or asked.whole is None or not (len(flight.range) or synthetic):
        return ()
    _, world, _ = rest.world_of(asked.whole, anchor=flight.anchor or ORIGIN, vectors=vectors, confirmed=still)
    anchor = () if synthetic or flight.anchor is not None else (_ANCHOR,)
    return (*(world if asked.certain else ()), *anchor)


_ANCHOR = Question(
    key="anchor",
    flag="--anchor",
    asks="where does the anchor stand",
    options=("X Y Z",),
    suggestion=None,
    evidence="the file does not say",
)
