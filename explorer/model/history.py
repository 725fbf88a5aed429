"""Undo and redo: the settings a visitor has been through. One thing moved again within a moment is one step."""

from collections.abc import Iterator
from typing import Any

import msgspec

from explorer.model.settings import Settings

MOMENT = 0.7
"""s: changes of one thing that follow each other faster, as while a slider is dragged, are undone together."""
DEPTH = 200


class History:
    """Past and future of one visitor's settings; the last of the past is what is shown."""

    def __init__(self) -> None:
        self._past: list[Settings] = []
        self._future: list[Settings] = []
        self._changed = float("-inf")
        self._parts: frozenset[str] = frozenset()
        """What the last step changed."""
        self._hold: int | None = None

    @property
    def now(self) -> Settings | None:
        """What is shown, as far as the history knows."""
        return self._past[-1] if self._past else None

    @property
    def depth(self) -> tuple[int, int]:
        """How many steps can be undone, and redone."""
        return max(len(self._past) - 1, 0), len(self._future)

    def record(
        self,
        settings: Settings,
        time: float,
        *,
        shown: float | None = None,
        apart: bool = False,
        hold: int | None = None,
    ) -> None:
        """Take in what was chosen at a time (s) and shown at another, by default the same: a slow machine that draws
        for a second between two moves of a slider does not tear them apart. `apart` makes it a step of its own,
        however soon it comes; what comes under the same number of a `hold`, as while a handle is held, belongs
        together however late it comes."""
        if settings == self.now:
            return
        parts = frozenset() if self.now is None else frozenset(differing(self.now, settings))
        soon = time - self._changed < MOMENT or (hold is not None and hold == self._hold)
        if not apart and soon and len(self._past) > 1 and parts <= self._parts:
            self._past.pop()
        else:
            self._parts = parts
        self._hold = None if apart else hold
        self._past.append(settings)
        del self._past[:-DEPTH]
        self._future.clear()
        self._changed = float("-inf") if apart else time if shown is None else shown

    def undo(self) -> Settings | None:
        """The settings before, None at the beginning."""
        if len(self._past) < 2:
            return None
        self._future.append(self._past.pop())
        self._break()
        return self._past[-1]

    def redo(self) -> Settings | None:
        """The settings that were undone last, None if there are none."""
        if not self._future:
            return None
        self._past.append(self._future.pop())
        self._break()
        return self._past[-1]

    def _break(self) -> None:
        """Whatever comes next is a step of its own, also while a handle is still held."""
        self._changed, self._hold = float("-inf"), None


def differing(before: Any, after: Any, where: str = "") -> Iterator[str]:
    """The innermost tables in which two values differ, as dotted paths: a tone, a waypoint, the gains of one block."""
    if before == after:
        return
    inner = list(_inner(before, after))
    changed = [(name, a, b) for name, a, b in inner if a != b]
    tables = [(name, a, b) for name, a, b in changed if isinstance(a, msgspec.Struct | tuple) and list(_inner(a, b))]
    if len(tables) < len(changed) or not changed:  # a number of its own, or another family
        yield where
    for name, a, b in tables:
        yield from differing(a, b, f"{where}.{name}")


def _inner(before: Any, after: Any) -> Iterator[tuple[str, Any, Any]]:
    """The parts of two values side by side, if they are of one kind and one length."""
    if isinstance(before, msgspec.Struct) and type(before) is type(after):
        for name in before.__struct_fields__:
            yield name, getattr(before, name), getattr(after, name)
    elif isinstance(before, tuple) and isinstance(after, tuple) and len(before) == len(after) and _structs(before):
        for k, (a, b) in enumerate(zip(before, after, strict=True)):
            yield str(k), a, b


def _structs(entries: tuple[Any, ...]) -> bool:
    """Whether these are tones or points, and not three numbers that are one vector."""
    return any(isinstance(entry, msgspec.Struct) for entry in entries)
