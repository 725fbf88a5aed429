"""What differs first between two studies, as a clause for a person: `runs is 24 there, and 12 here`."""

from collections.abc import Mapping
from typing import Any

import msgspec

from rangenav.studies.study import Study

NOTHING = "nothing"
SHORT = 60
"""Characters of a value that is shown."""


def between(there: Study, here: Study) -> str:
    """What differs first between the study of a store and one from a file, and the title if nothing else does."""
    files: list[dict[str, Any]] = [msgspec.to_builtins(of.file) for of in (there, here)]
    ordered = [{**{name: of[name] for name in of if name != "title"}, "title": of["title"]} for of in files]
    first = _first(ordered[0], ordered[1], "")
    if first is not None:
        return first
    if there.names != here.names:
        return _clause("presets", ", ".join(there.names), ", ".join(here.names))
    for name, old, new in zip(here.names, there.bases, here.bases, strict=True):
        first = _first(msgspec.to_builtins(old), msgspec.to_builtins(new), "")
        if first is not None:
            return f"in the preset {name}, {first}"
    return "its text differs"


def _first(old: Any, new: Any, path: str) -> str | None:
    """A clause about the first entry that differs; entries of a list are counted from 1."""
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        pairs = {name: (old.get(name), new.get(name)) for name in (*old, *new)}
    elif isinstance(old, list | tuple) and isinstance(new, list | tuple) and len(old) == len(new):
        pairs = {str(k): pair for k, pair in enumerate(zip(old, new, strict=True), 1)}
    else:
        return None if old == new else _clause(path, _shown(old), _shown(new))
    clauses = (_first(*pair, f"{path}.{name}" if path else name) for name, pair in pairs.items())
    return next(filter(None, clauses), None)


def _clause(path: str, old: str, new: str) -> str:
    return f"{path} is {old} there, and {new} here"


def _shown(value: Any) -> str:
    """A value on one line, or how many entries it has."""
    if isinstance(value, list | tuple):
        text = ", ".join(map(str, value))
        plain = not any(isinstance(one, Mapping) for one in value) and len(text) <= SHORT
        return text if plain else f"a list of {len(value)}"
    return NOTHING if value is None else "a table" if isinstance(value, Mapping) else str(value)[:SHORT]
