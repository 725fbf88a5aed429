"""A constant: three numbers."""

from explorer.panels.motion.families.editor import SignalSlot
from explorer.widgets.controls import Vector
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.signals import Multisine


class ConstantEditor:
    """A constant signal: a Multisine of nothing but an offset."""

    def __init__(self, form: Form, slot: SignalSlot) -> None:
        self._section = section = Section(form)
        with section:
            self.value = Vector(section, f"value ({slot.unit})", step=slot.step, hint=f"{slot.unit}, at all times.")

    def refresh(self) -> None:
        """Show below the control why the constant is invalid. Raises InvalidInputError."""
        with self._section.catching():
            self.read()

    def read(self) -> Multisine:
        """The constant. Raises InvalidInputError."""
        with self._section.checking():
            return Multisine(offset=self.value.read())

    def write(self, signal: Multisine, base: Multisine | None) -> None:
        """Show a constant."""
        self.value.write(signal.offset, base and base.offset)

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        self._section.show(visible)
