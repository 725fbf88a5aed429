"""Three boxes in one row for the components x, y and z of a vector: each takes a number as a person types it.

viser's own boxes for a vector drop the e of 5e3. A text box stands for each component, and what is typed stays as it
was typed; the model refuses what is out of range, and the reason appears below the control.
"""

import viser

from explorer.web.elements import Kind, of_kind
from explorer.widgets import typed_number
from explorer.widgets.controls import Control
from explorer.widgets.section import Section
from rangenav.inputs import Vec3

AXES = ("x", "y", "z")
MAX_TEXT = 8
"""Characters that a box shows of a long number."""
KINDS: tuple[Kind, Kind, Kind] = ("rn-x-", "rn-box-y-", "rn-box-z-")
"""Of the boxes: page.css draws those for y and z up into the row of x, and keeps their labels for readers of the
screen."""


class Vector(Control[Vec3]):
    """Three boxes. The value may be shown in another unit: value · scale."""

    def __init__(self, section: Section, label: str, *, hint: str, scale: float = 1.0) -> None:
        self._scale = scale
        self._boxes = tuple(
            _box(section, box_label(label, axis), kind, hint) for axis, kind in zip(AXES, KINDS, strict=True)
        )
        self._exact: Vec3 = (0.0, 0.0, 0.0)
        self._shown: tuple[str, ...] = ("0", "0", "0")
        """The texts of the value that was written. Where one of them stands, the exact component is meant."""
        super().__init__(section, label, self._boxes[0])
        for box in self._boxes[1:]:
            self._watch(box)

    @property
    def boxes(self) -> tuple[viser.GuiTextHandle, ...]:
        """All three."""
        return self._boxes

    @property
    def texts(self) -> tuple[str, ...]:
        """What the boxes hold."""
        return tuple(box.value for box in self._boxes)

    def type(self, axis: str, text: str) -> None:
        """Put a text into the box of an axis, as a visitor does."""
        self._boxes[AXES.index(axis)].value = text

    def read(self) -> Vec3:
        """The three values, which are not checked. Raises ValueError if a box holds no number."""
        return self._component(0), self._component(1), self._component(2)

    def show(self, value: Vec3) -> None:
        """Show a value; a text that already says its component stays as it was typed."""
        self._section.touch()
        for k, (box, entry) in enumerate(zip(self._boxes, value, strict=True)):
            if not self._says(k, entry):
                box.value = typed_number.text(entry * self._scale, MAX_TEXT)
        self._exact, self._shown = value, self.texts

    def reveal(self, *, visible: bool) -> None:
        """Show or hide the boxes."""
        for box in self._boxes:
            box.visible = visible

    def _says(self, k: int, value: float) -> bool:
        try:
            return self._component(k) == value
        except ValueError:
            return False

    def _component(self, k: int) -> float:
        text = self._boxes[k].value
        if text == self._shown[k]:
            return self._exact[k]
        try:
            return typed_number.parse(text) / self._scale
        except ValueError as error:
            raise ValueError(f"{self.name}, {AXES[k]}: {error}") from None


def box_label(label: str, axis: str) -> str:
    """The label of one of the boxes of a vector; that of x is the label of all."""
    return label if axis == AXES[0] else f"{label}: {axis}"


def _box(section: Section, label: str, kind: Kind, hint: str) -> viser.GuiTextHandle:
    with of_kind(kind):
        return section.gui.add_text(label, "0", hint=hint)
