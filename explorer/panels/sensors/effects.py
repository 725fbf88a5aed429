"""The effects that the paper does not model: one control for each field of `Effects`, by the field's row."""

import html

from explorer.model.glossary import SENSING
from explorer.widgets.fields import FieldControls
from explorer.widgets.form import Form
from explorer.widgets.section import Section
from rangenav.sensors import Effects, effects

STYLE = "font-size:0.85em;line-height:1.4;padding:0 0.9em 0.6em"


HEADING = SENSING["unmodelled"].label.capitalize()


class EffectsFolder:
    """Biases, outliers, drop-outs, the lever arm. In the paper all of them are off."""

    def __init__(self, form: Form) -> None:
        self.description = form.gui.add_html("", visible=False)
        """A sentence for each effect that is on. It stands outside the folder, which may be closed."""
        self._section = section = Section(form, HEADING, expanded=False)
        with section:
            self.fields = FieldControls(section, Effects, effects.rows())

    def refresh(self) -> None:
        """Show below the controls why the effects are invalid. Raises InvalidInputError."""
        with self._section.catching():
            self.read()

    def read(self) -> Effects:
        """The effects chosen. Raises InvalidInputError."""
        return self.fields.read()

    def write(self, chosen: Effects, base: Effects) -> None:
        """Show the effects of some settings; `base` are those of the preset."""
        self.fields.write(chosen, base)

    def show(self, chosen: Effects) -> None:
        """Show effects; what the controls are reset to stays as it was."""
        self.fields.show(chosen)

    def describe(self, sentences: tuple[str, ...]) -> None:
        """Show the sentences about the effects that are on."""
        lines = "".join(f"<div>▲ {html.escape(sentence)}</div>" for sentence in sentences)
        self._section.caption(f"{HEADING}: {len(sentences)} on" if sentences else f"{HEADING}: none")
        content = f'<div style="{STYLE}">{lines}</div>'
        if content != self.description.content:
            self.description.content = content
            self.description.visible = bool(sentences)
