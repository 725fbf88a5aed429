"""The settings that a visitor has chosen one after the other, for undo and redo.

Changes of the same control that follow each other within a moment are one step. A step holds only the parts that it
changes; the others are those of the step before it.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import msgspec

from explorer.model.settings import Settings

MOMENT = 0.7
"""s; changes of one control at shorter intervals, as while a slider is dragged, are one step."""
MAX_STEPS = 200


class History:
    """Past and future settings of one visitor; the newest of the past are on the page."""

    def __init__(self) -> None:
        self._past: list[Settings] = []
        self._future: list[Settings] = []
        self._changed_at = float("-inf")
        self._parts: frozenset[str] = frozenset()
        """The tables that the last step changed, as dotted paths."""
        self._drag: int | None = None
        """The number of the drag that the last step belongs to; None if it belongs to none."""

    @property
    def now(self) -> Settings | None:
        """The settings recorded last; None before the first."""
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
        separate: bool = False,
        drag: int | None = None,
    ) -> None:
        """Record settings that were chosen at `time` (s) and drawn at `shown` (s), by default the same.

        The pause between two changes is counted from `shown`, so that on a slow machine, which draws for a second,
        two moves of one slider are still one step. With `separate` the settings are a step of their own, however soon
        they follow. Settings with the same number of a `drag` of a handle are one step, however late they follow.
        """
        if settings == self.now:
            return
        parts = frozenset() if self.now is None else frozenset(differing(self.now, settings))
        soon = time - self._changed_at < MOMENT or (drag is not None and drag == self._drag)
        if not separate and soon and len(self._past) > 1 and parts <= self._parts:
            self._past.pop()
        else:
            self._parts = parts
        self._drag = None if separate else drag
        self._past.append(sharing(settings, self.now))
        del self._past[:-MAX_STEPS]
        self._future.clear()
        self._changed_at = float("-inf") if separate else time if shown is None else shown

    def steps(self, most: int) -> tuple[tuple[Settings, ...], tuple[Settings, ...]]:
        """The newest past settings and the next future ones, at most so many of each, for `restore`."""
        return tuple(self._past[-most:]), tuple(self._future[-most:])

    def restore(self, past: Sequence[Settings], future: Sequence[Settings]) -> None:
        """Take over the steps of an earlier visit; the next settings are a step of their own."""
        self._past, self._future = list(past[-MAX_STEPS:]), list(future[-MAX_STEPS:])
        self._break()

    def undo(self) -> Settings | None:
        """The settings one step back; None at the beginning."""
        if len(self._past) < 2:
            return None
        self._future.append(self._past.pop())
        self._break()
        return self._past[-1]

    def redo(self) -> Settings | None:
        """The settings that were undone last; None if there are none."""
        if not self._future:
            return None
        self._past.append(self._future.pop())
        self._break()
        return self._past[-1]

    def _break(self) -> None:
        """Make the next settings a step of their own, also while a handle is held."""
        self._changed_at, self._drag = float("-inf"), None


def sharing(after: Any, before: Any) -> Any:
    """The same value. Each table or vector in it that equals that of the earlier value is the earlier one itself, so
    that both share memory."""
    if after == before:
        return before
    inner = list(_inner(before, after))
    parts = {name: sharing(b, a) for name, a, b in inner if isinstance(b, msgspec.Struct | tuple)}
    if isinstance(after, tuple):
        return tuple(parts.get(str(k), entry) for k, entry in enumerate(after))
    return msgspec.structs.replace(after, **parts) if parts else after


def differing(before: Any, after: Any, where: str = "") -> Iterator[str]:
    """The innermost tables in which two values differ, as dotted paths: a tone, a waypoint, the gains of one block."""
    if before == after:
        return
    inner = list(_inner(before, after))
    changed = [(name, a, b) for name, a, b in inner if a != b]
    tables = [(name, a, b) for name, a, b in changed if isinstance(a, msgspec.Struct | tuple) and list(_inner(a, b))]
    if len(tables) < len(changed) or not changed:  # a number of this table, or another family
        yield where
    for name, a, b in tables:
        yield from differing(a, b, f"{where}.{name}")


def _inner(before: Any, after: Any) -> Iterator[tuple[str, Any, Any]]:
    """Name and both values of each part, if the two values have the same type and length."""
    if isinstance(before, msgspec.Struct) and type(before) is type(after):
        for name in before.__struct_fields__:
            yield name, getattr(before, name), getattr(after, name)
    elif isinstance(before, tuple) and isinstance(after, tuple) and len(before) == len(after) and _structs(before):
        for k, (a, b) in enumerate(zip(before, after, strict=True)):
            yield str(k), a, b


def _structs(entries: tuple[Any, ...]) -> bool:
    """Whether the entries are tones or waypoints; three numbers are one vector."""
    return any(isinstance(entry, msgspec.Struct) for entry in entries)
