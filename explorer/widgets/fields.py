"""Controls for the fields of a value: one for each number or vector, made from the field's entry (rangenav.fields)."""

from collections.abc import Mapping
from typing import Any, Generic, TypeVar

from explorer.widgets.controls import Control, Number
from explorer.widgets.dials import Dial
from explorer.widgets.section import Section
from explorer.widgets.vector import Vector
from rangenav import fields
from rangenav.fields import SIGNAL_UNIT, NumberField
from rangenav.inputs import Input, Vec3

S = TypeVar("S", bound=Input)
PERCENT = 100.0


class FieldControls(Generic[S]):
    """Controls in one section that make a value of one class. A field that has no entry keeps its default."""

    def __init__(
        self, section: Section, kind: type[S], entries: Mapping[str, NumberField], *, signal_unit: str = ""
    ) -> None:
        self._section, self._kind = section, kind
        types = fields.types(kind)
        self.controls: dict[str, Control[Any]] = {
            name: _control(section, f"{kind.__name__}.{name}", types[name], entry, signal_unit)
            for name, entry in entries.items()
        }
        """The controls by the names of their fields."""

    def read(self) -> S:
        """The value chosen. Raises InvalidInputError."""
        with self._section.checking():
            return self._kind(**{name: control.read() for name, control in self.controls.items()})

    def write(self, value: S, base: S | None) -> None:
        """Show a value, and remember the preset's; None if the preset has none."""
        for name, control in self.controls.items():
            control.write(getattr(value, name), None if base is None else getattr(base, name))

    def show(self, value: S) -> None:
        """Show a value; what the controls are reset to stays as it was."""
        for name, control in self.controls.items():
            control.show(getattr(value, name))


def _control(section: Section, field: str, kind: Any, entry: NumberField, signal_unit: str) -> Control[Any]:
    """Three boxes for a vector, a slider where the entry has ends for one, else a box for a number."""
    unit, hint = (text.replace(SIGNAL_UNIT, signal_unit) for text in (entry.shown_unit, entry.hint))
    label = f"{entry.label} ({unit})" if unit else entry.label
    scale = PERCENT if entry.percent else 1.0
    if kind == Vec3:
        return Vector(section, label, hint=hint, scale=scale)
    if kind is not float:
        raise TypeError(f"{field}: only a number or a vector has a control made from its entry, not {kind}")
    if entry.dial is not None:
        low, high = (PERCENT * end for end in entry.limits)
        allowed = (low, high - entry.step if entry.excluded else high) if entry.percent else None
        return Dial(section, label, entry.dial, step=entry.step, hint=hint, scale=scale, allowed=allowed)
    if entry.percent:
        raise TypeError(f"{field}: a value shown in per cent needs a slider: give its entry a dial")
    return Number(section, label, hint=hint)
