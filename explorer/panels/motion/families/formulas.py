"""Formulas: one expression in t for each axis, with a pointer to a mistake; and the yaw of a body that is flown."""

import msgspec

from explorer.panels.motion.families.editor import SignalSlot
from explorer.widgets.complaint import InvalidInputError
from explorer.widgets.controls import Text
from explorer.widgets.dial_control import DIGITS
from explorer.widgets.form import Form
from explorer.widgets.section import Section, complaining
from explorer.widgets.vector import Vector
from rangenav.number_format import significant
from rangenav.signals import AXES, Flown, Formula
from rangenav.signals.expressions import MAX_LENGTH
from rangenav.signals.formula import IDENTITY

MAX_TEXT = 20 * MAX_LENGTH
"""Characters of a box; a longer text is refused before it is parsed, and no valid formula is a tenth as long."""
ALLOWED = "+ − * / **, pi, e, sin, cos, tan, exp, log, sqrt, tanh and their relatives"


class FormulaEditor:
    """Three boxes. A rotation or scaling of the path is stored separately from the formulas."""

    def __init__(self, form: Form, slot: SignalSlot) -> None:
        self._signal = Formula()
        self._section = section = Section(form)
        with section:
            hint = f"An expression in t (s), in {slot.unit}: {ALLOWED}. Derivatives are exact."
            self.texts = {axis: Text(section, f"{axis}(t) =", hint=hint, longest=MAX_TEXT) for axis in AXES}
        self._offset_section = offset_section = Section(form, "Offset and drift", expanded=False)
        with offset_section:
            hint = "Added to the formulas. A path is then elsewhere, seen from the anchor, with the same excitation."
            self._offset = Vector(offset_section, f"offset ({slot.unit})", hint=hint)
            hint = "A constant rate added to the formulas. It has no snap, so it excites nothing."
            self._drift = Vector(offset_section, f"drift ({slot.unit}/s)", hint=hint)
            self._line = form.gui.add_markdown("", visible=False)
            self._forget_button = form.button(
                "Forget turning and scaling", self._forget_map, hint="The formulas count as typed again."
            )

    def refresh(self) -> None:
        """Show below the boxes why the formulas are invalid. Raises InvalidInputError."""
        with complaining(self._section, self._offset_section):
            self.read()

    def read(self) -> Formula:
        """The formulas as typed. Raises InvalidInputError."""
        with self._section.checking():
            texts = {axis: text.read() for axis, text in self.texts.items()}
        try:
            formula = msgspec.structs.replace(self._signal, **texts)
        except ValueError as error:
            raise InvalidInputError(self._section.complaint, texts.get(str(error)[:1], "")) from error
        with self._offset_section.checking():
            return msgspec.structs.replace(formula, offset=self._offset.read(), drift=self._drift.read())

    def write(self, signal: Formula, base: Formula | None) -> None:
        """Show formulas."""
        self._signal = signal
        for axis, text in self.texts.items():
            text.write(getattr(signal, axis), getattr(base, axis) if base is not None else None)
        self._offset.write(signal.offset, base and base.offset)
        self._drift.write(signal.drift, base and base.drift)
        self._describe_map()

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        self._section.show(visible)
        self._offset_section.show(visible)

    def _describe_map(self) -> None:
        """Show the time scale and the matrix that are applied to the formulas."""
        signal, parts = self._signal, []
        if signal.slower != 1:
            parts.append(f"run {significant(signal.slower, DIGITS)} times slower")
        if signal.mix != IDENTITY:
            rows = "; ".join(" ".join(significant(value, DIGITS) for value in row) for row in signal.mix)
            parts.append(f"multiplied by [{rows}]")
        self._line.content = f"The formulas are {' and '.join(parts)}." if parts else ""
        self._line.visible = self._forget_button.visible = bool(parts)

    def _forget_map(self) -> None:
        self._signal = msgspec.structs.replace(self._signal, slower=1.0, mix=IDENTITY)
        self._describe_map()


class FlownEditor:
    """The body axes follow from the path; only the yaw is chosen."""

    def __init__(self, form: Form, slot: SignalSlot) -> None:
        del slot  # the yaw is an angle whatever the signal's unit
        self._section = section = Section(form)
        with section:
            form.gui.add_markdown(
                "Thrust points along the specific force p̈ − g, as in a multirotor; the path decides the attitude, its "
                "rate follows from jerk and snap, and the initial attitude is not asked."
            )
            hint = f"rad, an expression in t (s): the turn about the thrust axis. {ALLOWED}."
            self._yaw = Text(section, "yaw(t) =", hint=hint, longest=MAX_TEXT)

    def refresh(self) -> None:
        """Show below the control why the yaw is invalid. Raises InvalidInputError."""
        with self._section.catching():
            self.read()

    def read(self) -> Flown:
        """The yaw as typed. Raises InvalidInputError."""
        with self._section.checking():
            yaw = self._yaw.read()
        with self._section.checking(yaw):
            return Flown(yaw=yaw)

    def write(self, signal: Flown, base: Flown | None) -> None:
        """Show a yaw."""
        self._yaw.write(signal.yaw, base and base.yaw)

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        self._section.show(visible)
