"""One number of some settings by its path, as in a preset's file: gains.riccati.q, path.tones.1.amplitude, time_scale.

A number after a dot counts entries from 1, as the page does; the components of a vector are x, y, z.
"""

import re
from typing import Any

import msgspec

from explorer.model.glossary import field_label
from explorer.model.settings import Settings
from rangenav.inputs import require, shortened

COMPONENTS = {"x": 0, "y": 1, "z": 2}
OF_SETTINGS = ("time_scale", "twin_turn")
"""The first parts of paths that do not lead into the preset."""


def value(settings: Settings, path: str) -> float:
    """The number. Raises ValueError with one sentence if the path names none."""
    table = msgspec.json.decode(msgspec.json.encode(settings))  # lists, which take an entry
    for part in _parts(path):
        table = table[_key(table, part, path)]
    require(isinstance(table, int | float) and not isinstance(table, bool), f"{path}: names no number")
    return float(table)


def replaced(settings: Settings, path: str, number: float) -> Settings:
    """The settings with another number. Raises ValueError with one sentence if it does not fit."""
    value(settings, path)
    table = msgspec.json.decode(msgspec.json.encode(settings))  # lists, which take an entry
    inner, *parts = table, *_parts(path)
    for part in parts[:-1]:
        inner = inner[_key(inner, part, path)]
    key = _key(inner, parts[-1], path)
    inner[key] = int(number) if isinstance(inner[key], int) and number.is_integer() else number
    try:
        return msgspec.convert(table, Settings)
    except (msgspec.ValidationError, ValueError) as error:
        raise ValueError(f"{path} = {number:g}: {shortened(str(error))}") from None


def label(path: str) -> str:
    """What the page calls it: path.tones.3.amplitude → path, tone 3, amplitude."""
    return field_label(re.sub(r"\.(\d+)", r"[\1]", path))


def _parts(path: str) -> list[str]:
    parts = path.split(".")
    return parts if parts[0] in OF_SETTINGS else ["preset", *parts]


def _key(table: Any, part: str, path: str) -> Any:
    """The key of one part in a table or a list. Raises ValueError if there is none."""
    if isinstance(table, dict):
        require(part in table, f"{path}: there is no {part}; there are {', '.join(map(str, table))}")
        return part
    require(isinstance(table, list | tuple), f"{path}: nothing lies below {part}")
    index = COMPONENTS.get(part, int(part) - 1 if part.isdecimal() else -1)
    require(0 <= index < len(table), f"{path}: {part} must lie between 1 and {len(table)}")
    return index
