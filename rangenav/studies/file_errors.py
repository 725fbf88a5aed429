"""Errors of a study's file in the words of the file: what the parser says of JSON and of Python becomes field and rule.

    Invalid value 'lin' - at `$.parameters[0].kind`    →    parameters.1.kind: there is no 'lin'; there are list, …
Entries of a list are counted from 1, as in a path.
"""

import difflib
import re
from collections.abc import Iterable
from typing import Any

from rangenav import toml_limits

AT = re.compile(r"(?P<words>.*?) - at `\$\.?(?P<place>[^`]*)`", re.DOTALL)
QUOTED = re.compile(r"`([^`]*)`")
PLAIN = {"str": "a text", "float": "a number", "int": "a whole number", "bool": "true or false", "array": "a list"}
PLAIN |= {"object": "a table", "null": "nothing"}
NEAREST = 3


def near(name: str, names: Iterable[str]) -> str:
    """`there is no x; did you mean y? There are …`, the likeliest names first."""
    return f"there is no {name}; {_names(name, names, 'there are')}"


def unknown_key(name: str, names: Iterable[str]) -> str:
    """The same of a key of a table."""
    return f"no key is named {name}; {_names(name, names, 'the keys are')}"


def _names(name: str, names: Iterable[str], before: str) -> str:
    known = list(names)
    likely = difflib.get_close_matches(name, known, NEAREST, cutoff=0.5)
    meant = f"did you mean {' or '.join(likely)}? {before.capitalize()}" if likely else before
    return f"{meant} {', '.join(known)}"


def explained(sentence: str, text: str, fields: dict[str, dict[str, tuple[str, ...]]]) -> str:
    """A parser's sentence about `text` as field and rule.

    fields: of each table of the file, by its name (empty for the file's own), and by its kind, the names of its fields.
    """
    match = AT.fullmatch(sentence)
    words, place = (match["words"], match["place"]) if match else (sentence, "")
    counted = re.sub(r"\[(\d+)\]", lambda index: f".{int(index[1]) + 1}", place)
    table = counted.split(".")[0]
    kinds = fields.get(table, fields[""])
    return f"{counted}: {_rule(words, place, text, kinds)}" if counted else _rule(words, place, text, kinds)


def _rule(words: str, place: str, text: str, kinds: dict[str, tuple[str, ...]]) -> str:
    quoted = QUOTED.findall(words)
    if words.startswith("Object contains unknown field"):
        kind = str(_entry(text, f"{place}.kind"))
        others = [name for name, keys in kinds.items() if name and quoted[0] in keys]
        if others and kind in kinds:
            of = f"{quoted[0]} is a key of {', '.join(others)}, not of {kind}"
            return f"{of}; the keys of {kind} are {', '.join(kinds[kind])}"
        return unknown_key(quoted[0], kinds.get(kind, kinds.get("", ())))
    if words.startswith("Object missing required field"):
        return f"{quoted[0]} is missing"
    if words.startswith("Invalid value") and place.endswith("kind"):
        return near(str(_entry(text, place)), (kind for kind in kinds if kind))
    if words.startswith("Invalid enum value") and place == "version":
        return f"must be 1, got {_entry(text, place)}"
    if words.startswith("Expected `") and len(quoted) > 1:
        wanted, got = (PLAIN.get(one.split(" | ")[0], one) for one in quoted[:2])
        other = ""
        if ".values" in place:
            other = '; kind = "list" takes numbers, and kind = "choices" takes texts'
        return f"must be {wanted}, got {got}{other}"
    return words.replace("Illegal character '\\n'", "the line ends within a text")


def _entry(text: str, place: str) -> Any:
    """What the file has at a place of the parser, such as parameters[0].kind; empty if it has nothing."""
    try:
        value: Any = toml_limits.decode(text, dict)
        for part in re.findall(r"[^.\[\]]+", place):
            value = value[int(part)] if isinstance(value, list) else value[part]
    except (ValueError, KeyError, IndexError, TypeError):
        return ""
    return value
