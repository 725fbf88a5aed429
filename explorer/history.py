"""Undo and redo: the settings a visitor has been through. What follows itself within a moment is one step."""

from explorer.settings import Settings

MOMENT = 0.7
"""s: changes that follow each other faster, as while a slider is dragged, are undone together."""
DEPTH = 200


class History:
    """Past and future of one visitor's settings; the last of the past is what is shown."""

    def __init__(self) -> None:
        self._past: list[Settings] = []
        self._future: list[Settings] = []
        self._changed = float("-inf")

    @property
    def now(self) -> Settings | None:
        """What is shown, as far as the history knows."""
        return self._past[-1] if self._past else None

    @property
    def depth(self) -> tuple[int, int]:
        """How many steps can be undone, and redone."""
        return max(len(self._past) - 1, 0), len(self._future)

    def note(self, settings: Settings, time: float, *, apart: bool = False) -> None:
        """Take in what is shown at a time (s); `apart` makes it a step of its own, however soon it comes."""
        if settings == self.now:
            return
        together = not apart and time - self._changed < MOMENT and len(self._past) > 1
        if together:
            self._past.pop()
        self._past.append(settings)
        del self._past[:-DEPTH]
        self._future.clear()
        self._changed = float("-inf") if apart else time

    def undo(self) -> Settings | None:
        """The settings before, None at the beginning."""
        if len(self._past) < 2:
            return None
        self._future.append(self._past.pop())
        self._changed = float("-inf")
        return self._past[-1]

    def redo(self) -> Settings | None:
        """The settings that were undone last, None if there are none."""
        if not self._future:
            return None
        self._past.append(self._future.pop())
        self._changed = float("-inf")
        return self._past[-1]
