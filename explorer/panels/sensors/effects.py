"""The effects that the paper does not model: one control for each field of `Effects`, by the field's row."""

import html
from typing import Any

from explorer.widgets.controls import Control, Number, Vector
from explorer.widgets.dials import Dial
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.sensors import MODELLED, Effect, Effects, effects

STYLE = "font-size:0.85em;line-height:1.4;padding:0 0.9em 0.6em"
PERCENT = 100.0


class EffectsFolder:
    """Biases, outliers, drop-outs, the lever arm. In the paper all of them are off."""

    def __init__(self, form: Form) -> None:
        self.description = form.gui.add_html("", visible=False)
        """A sentence for each effect that is on. It stands outside the folder, which may be closed."""
        self._section = section = Section(form, "Not in the paper", expanded=False)
        with section:
            self.controls: dict[str, Control[Any]] = {
                field: _control(section, field, row) for field, row in effects.rows().items()
            }
            """The controls by the names of their fields."""

    def refresh(self) -> None:
        """Show below the controls why the effects are invalid. Raises InvalidInputError."""
        with self._section.catching():
            self.read()

    def read(self) -> Effects:
        """The effects chosen. Raises InvalidInputError."""
        with self._section.checking():
            return Effects(**{field: control.read() for field, control in self.controls.items()})

    def write(self, chosen: Effects, base: Effects) -> None:
        """Show the effects of some settings; `base` are those of the preset."""
        for field, control in self.controls.items():
            control.write(getattr(chosen, field), getattr(base, field))

    def show(self, chosen: Effects) -> None:
        """Show effects; what the controls are reset to stays as it was."""
        for field, control in self.controls.items():
            control.show(getattr(chosen, field))

    def describe(self, sentences: tuple[str, ...]) -> None:
        """Show the sentences about the effects that are on."""
        lines = "".join(f"<div>▲ {html.escape(sentence)}</div>" for sentence in sentences)
        content = f'<div style="{STYLE}">{lines}</div>'
        if content != self.description.content:
            self.description.content = content
            self.description.visible = bool(sentences)


def _control(section: Section, field: str, row: Effect) -> Control[Any]:
    """Three boxes for a vector, a slider where the row has ends for one, else a box for a number."""
    label = f"{row.label} ({row.shown_unit})"
    scale = PERCENT if row.percent else 1.0
    if isinstance(getattr(MODELLED, field), tuple):
        return Vector(section, label, step=row.step, hint=row.hint, scale=scale)
    if row.dial is not None:
        return Dial(section, label, row.dial, step=row.step, hint=row.hint, scale=scale)
    if row.percent:
        raise TypeError(f"Effects.{field}: a value shown in per cent needs a slider: give its row a dial")
    return Number(section, label, step=row.step, hint=row.hint)
