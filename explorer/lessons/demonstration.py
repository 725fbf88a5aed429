"""The steps from some settings to those of a solution, one control at a time: what "show me" plays.

Settings that differ in several places are changed leaf by leaf, each change a valid input of its own. Changes that are
only valid together, such as another family of paths, are one step.
"""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import msgspec

from explorer.model.glossary import field_label
from explorer.model.settings import Settings

LEFT_OUT = ("origin", "edition", "drafts", "title", "story", "expect", "version", "source")
"""Fields that no control shows."""


class Step(NamedTuple):
    """One step: what was changed, by the label of its control, and the settings after it."""

    label: str
    settings: Settings


def steps(shown: Settings, solved: Settings) -> tuple[Step, ...]:
    """The steps from what is shown to a solution; the last one has all that the solution has."""
    table, wanted = msgspec.to_builtins(shown), msgspec.to_builtins(solved)
    found: list[Step] = []
    pending: list[str] = []
    for where, value in tuple(_differences(table, wanted, ())):
        _put(table, where, value)
        pending.append(field_label(".".join(key for key in where if key != "preset")))
        try:
            settings = msgspec.convert(table, Settings)
        except (msgspec.ValidationError, ValueError):
            continue  # valid together with the next changes
        found.append(Step(" and ".join(dict.fromkeys(pending)), settings))
        pending = []
    return tuple(found)


def _differences(table: Any, wanted: Any, where: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
    """The innermost places in which two tables differ, with the value that is wanted there."""
    for key, value in wanted.items():
        before, here = table.get(key), (*where, key)
        if key in LEFT_OUT or before == value:
            continue
        if isinstance(value, Mapping) and isinstance(before, Mapping) and before.get("kind") == value.get("kind"):
            yield from _differences(before, value, here)
        else:
            yield here, value


def _put(table: dict[str, Any], where: tuple[str, ...], value: Any) -> None:
    for key in where[:-1]:
        table = table[key]
    table[where[-1]] = value
