"""The words of the page: one table of terms, from which labels, hints, sentences and docs/glossary.md are made.

No label, hint or message shows a key of a preset's file: `field_label` names a key, `in_labels` a whole sentence.
"""

import re

from explorer.model.glossary.gains import PAPER_GAINS, PHYSICAL_GAINS, START
from explorer.model.glossary.motion import MOTION
from explorer.model.glossary.sensing import SENSING
from explorer.model.glossary.studies import STUDIES
from explorer.model.glossary.term import Term
from explorer.model.glossary.verdict import COMPARE, VERDICT
from rangenav import fields
from rangenav.sensors import Effects

CHAPTERS: dict[str, dict[str, Term]] = {
    "The verdict": VERDICT,
    "Motion and world": MOTION,
    "Sensors": SENSING,
    "Gains in the paper's letters": PAPER_GAINS,
    "Gains as physical quantities": PHYSICAL_GAINS,
    "Where the observer starts": START,
    "Comparing and tuning": COMPARE,
    "Maps of two parameters": STUDIES,
}
TERMS: dict[str, Term] = {key: term for chapter in CHAPTERS.values() for key, term in chapter.items()}
"""Every term by its key."""
EFFECTS = {f"sensors.unmodelled.{name}": row.label for name, row in fields.of(Effects).items()}
BY_FIELD: dict[str, str] = EFFECTS | {field: term.label for term in TERMS.values() for field in term.fields}
"""Key of a preset's file, with dots → label on the page."""
PARTS = {"path": "path", "angular_velocity": "angular velocity", "wiggle": "second motion", "base": "first motion"}
INDEX = re.compile(r"\[(\d+)\]")
KEY = re.compile(r"\b[a-z][a-z0-9]*(?:_[a-z0-9]+|\.[a-z][a-z0-9_]*)+(?![a-z0-9_(])")
"""A key in a sentence: a word with an underscore or a dot inside."""
EXPONENT = re.compile(r"(\d)e(?:\+|(-))0*(\d)")
"""1e+08 is written as 1e8 and 1e-09 as 1e-9, as a person types them."""
SUBJECT = re.compile(r"(?:^|(?<=: ))(noise )?([a-z][a-z0-9]*)(?= must )")
"""A key of one word is recognised at the beginning of a rule only: “q must lie between …”."""


def _by_last() -> dict[str, str]:
    """Last part of a key → label, where the part names one label only."""
    names: dict[str, set[str]] = {}
    for key, label in (*BY_FIELD.items(), *((name, term.label) for name, term in PHYSICAL_GAINS.items())):
        names.setdefault(key.rsplit(".", 1)[-1], set()).add(label)
        if key.startswith("gains.riccati."):
            names.setdefault(key.removeprefix("gains.riccati."), set()).add(label)
    return {last: next(iter(labels)) for last, labels in names.items() if len(labels) == 1}


LAST = _by_last()


def hint(key: str) -> str:
    """The hint of a term. Raises KeyError for a key without a term, which a test rules out."""
    return TERMS[key].hint


def field_label(where: str) -> str:
    """What the page calls a key of a preset's file: gains.riccati.q → range weight q.

    A key without a term is named by its parts: path.tones[2].phase → path, tone 2, phase φ₀."""
    if where in BY_FIELD:
        return BY_FIELD[where]
    names = []
    for part in where.split("."):
        name, index = INDEX.sub("", part), INDEX.search(part)
        word = PARTS.get(name) or (TERMS[name].label if name in TERMS else LAST.get(name, name.replace("_", " ")))
        names.append(f"{word.removesuffix('s')} {index[1]}" if index else word)
    return ", ".join(names)


def in_labels(sentence: str) -> str:
    """A sentence of the library with the labels of the page in place of the keys of a preset's file."""
    sentence = EXPONENT.sub(r"\1e\2\3", sentence)
    text = KEY.sub(lambda match: _known(match[0]), sentence)
    return SUBJECT.sub(lambda match: (BY_FIELD if match[1] else LAST).get(match[0], match[0]), text)


def _known(key: str) -> str:
    """The label of a key; a word with a dot that is no key, such as a file's name, stays as it is."""
    label = BY_FIELD.get(key) or LAST.get(key)
    return label or (key if "." in key else key.replace("_", " "))


def markdown() -> str:
    """The glossary as a page: a table for each chapter."""
    lines = []
    for title, chapter in CHAPTERS.items():
        lines += [f"## {title}", "", "| term | meaning | equation | place |", "|---|---|---|---|"]
        for term in sorted(chapter.values(), key=lambda term: term.label.lower()):
            cells = (f"**{term.caption}**", term.meaning, f"`{term.formula}`" if term.formula else "", term.place)
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
        lines.append("")
    return "\n".join(lines).rstrip()
