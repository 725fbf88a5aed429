"""One editor for each family of signals. All are made, shown, read and written alike.

editor = Editor(sheet, place, lasts=...)   its own sections, below what is there already
editor.write(signal, base)       show a signal; base is the preset's if that is of this family, else None
editor.read()                    the signal; raises Refused after saying why beside the control
editor.show(visible)             hidden, it keeps what was typed
"""

from dataclasses import dataclass
from typing import Protocol

from rangenav.signals import Turning


@dataclass(frozen=True, kw_only=True)
class SignalSlot:
    """What tells the edited signals apart on the page."""

    unit: str
    amplitude: tuple[float, float]
    frequency: tuple[float, float]
    """Ranges of sliders; a value beyond them widens them."""
    step: float
    """Of boxes, in the unit."""
    open_tones: int
    """Tones whose sliders are open at first; the labels of the others show their formula all the same."""


class Editor(Protocol):
    """What all editors offer."""

    def read(self) -> Turning: ...
    def write(self, signal: Turning, base: Turning | None) -> None: ...
    def show(self, visible: bool) -> None: ...
