"""The editor of a family whose fields are numbers and vectors: one control for each, made from the field's entry."""

from collections.abc import Mapping
from typing import Generic, TypeVar

from explorer.panels.motion.families.editor import SignalSlot
from explorer.widgets.fields import FieldControls
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.fields import NumberField
from rangenav.signals.base import SignalBase

S = TypeVar("S", bound=SignalBase)


class NumbersEditor(Generic[S]):
    """The controls of the fields that have an entry; all other fields keep their defaults."""

    def __init__(self, form: Form, slot: SignalSlot, *, kind: type[S], entries: Mapping[str, NumberField]) -> None:
        self._section = section = Section(form)
        with section:
            self.fields = FieldControls(section, kind, entries, signal_unit=slot.unit)

    def refresh(self) -> None:
        """Show below the controls why the signal is invalid. Raises InvalidInputError."""
        with self._section.catching():
            self.read()

    def read(self) -> S:
        """The signal that the controls show. Raises InvalidInputError."""
        return self.fields.read()

    def write(self, signal: S, base: S | None) -> None:
        """Show a signal."""
        self.fields.write(signal, base)

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        self._section.show(visible)
