"""One number or word of an input by its path, as in a preset's file: gains.riccati.q, path.tones.1.amplitude.

A number after a dot counts entries from 1, as the page does; the components of a vector are x, y, z: world.anchor.x.
"""

import re
from collections.abc import Iterator, Mapping
from typing import Any, TypeVar

import msgspec

from rangenav.inputs import Input, require, shortened

AT = re.compile(r" - at `\$[^`]*`")
"""Where the parser found an error; a path says it already, in the words of the file."""
COMPONENTS = {"x": 0, "y": 1, "z": 2}
Kind = TypeVar("Kind", bound=Input)


def value(of: Input, path: str, *, below: str = "") -> float:
    """The number. `below` names a field of `of` in which the path begins; messages leave it out.

    Raises ValueError with one sentence if the path names no number.
    """
    entry = _entry(_table(of), path, below)
    require(isinstance(entry, int | float) and not isinstance(entry, bool), f"{path}: names no number")
    return float(entry)


def word(of: Input, path: str) -> str:
    """The word, such as gains.mode. Raises ValueError with one sentence if the path names none."""
    entry = _entry(_table(of), path, "")
    require(isinstance(entry, str), f"{path}: names no word")
    return entry


def replaced(of: Kind, values: Mapping[str, float | str], *, below: str = "") -> Kind:
    """The input with other numbers and words at these paths; it is checked once, as a whole.

    Raises ValueError with one sentence if a path names nothing, or if the values do not fit.
    """
    table = _table(of)
    for path, entry in values.items():
        old = _entry(table, path, below)
        *parts, last = _parts(path, below)
        inner = table
        for part in parts:
            inner = inner[_key(inner, part, path)]
        whole = isinstance(old, int) and isinstance(entry, float) and entry.is_integer()
        inner[_key(inner, last, path)] = int(entry) if whole else entry
    try:
        return msgspec.convert(table, type(of))
    except (msgspec.ValidationError, ValueError) as error:
        stated = ", ".join(f"{path} = {_shown(entry)}" for path, entry in values.items())
        raise ValueError(f"{stated}: {shortened(AT.sub('', str(error)))}") from None


def paths(of: Input) -> Iterator[str]:
    """The paths of all numbers and words."""
    yield from _below(_table(of), "")


def _below(entry: Any, path: str) -> Iterator[str]:
    if isinstance(entry, dict):
        for name, inner in entry.items():
            yield from _below(inner, f"{path}.{name}" if path else name)
    elif isinstance(entry, list):
        for name, inner in zip(
            COMPONENTS if _vector(entry) else map(str, range(1, len(entry) + 1)), entry, strict=True
        ):
            yield from _below(inner, f"{path}.{name}")
    elif entry is not None and not isinstance(entry, bool):
        yield path


def _table(of: Input) -> Any:
    """Dictionaries, and lists, which take an entry."""
    return msgspec.json.decode(msgspec.json.encode(of))


def _parts(path: str, below: str) -> list[str]:
    return [*([below] if below else []), *path.split(".")]


def _entry(table: Any, path: str, below: str) -> Any:
    for part in _parts(path, below):
        table = table[_key(table, part, path)]
    return table


def _key(table: Any, part: str, path: str) -> Any:
    """The key of one part in a table or a list. Raises ValueError if there is none."""
    if isinstance(table, dict):
        require(part in table, f"{path}: there is no {part}; there are {', '.join(map(str, table))}")
        return part
    require(isinstance(table, list), f"{path}: nothing lies below {part}")
    index = COMPONENTS.get(part, int(part) - 1 if part.isdecimal() else -1)
    rule = f"lie between 1 and {len(table)}" + (", or be x, y or z" if _vector(table) else "")
    require(0 <= index < len(table), f"{path}: {part} must {rule}")
    return index


def _vector(table: list[Any]) -> bool:
    return len(table) == len(COMPONENTS) and not any(isinstance(one, dict | list) for one in table)


def _shown(entry: float | str) -> str:
    return entry if isinstance(entry, str) else f"{entry:g}"
