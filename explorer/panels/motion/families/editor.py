"""What the editors of all families of signals offer, and what an editor knows of the signal that it edits.

editor = SinesEditor(form, slot)   its own sections, below the controls that are there already
editor.write(signal, base)         show a signal; base is the preset's signal if that is of this family, else None
editor.refresh()                   show what follows from the controls; raises InvalidInputError after saying why
editor.read()                      the signal; raises InvalidInputError, and leaves the page as it is
editor.show(visible)               a hidden editor keeps what was typed
"""

from dataclasses import dataclass
from typing import Protocol

from rangenav.signals import AngularVelocity


@dataclass(frozen=True, kw_only=True)
class SignalSlot:
    """The properties in which the edited signals (path, wiggle, angular velocity) differ on the page."""

    menu: str
    """The label of the menu of families."""
    unit: str
    amplitude: tuple[float, float]
    frequency: tuple[float, float]
    """Ranges of the sliders; a value beyond them widens them."""
    open_tones: int
    """The first so many tones show their sliders at once; the labels of the others show their formulas all the same."""


class Editor(Protocol):
    """What all editors offer."""

    def refresh(self) -> None: ...
    def read(self) -> AngularVelocity: ...
    def write(self, signal: AngularVelocity, base: AngularVelocity | None) -> None: ...
    def show(self, visible: bool) -> None: ...
