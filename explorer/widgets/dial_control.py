"""A slider and a box for one number: which of the two was moved last, and what each shows of the other.

viser's own box beside a slider cuts what is out of range, drops the e of 5e3, and on a logarithmic slider holds the
exponent. It is hidden, and a text box stands in its place (page.css). What is typed stays as it was typed; the model
refuses what is out of range, and the reason appears below the control.
"""

import math
from abc import abstractmethod
from typing import Literal

import viser

from explorer.web.elements import element_id, of_kind
from explorer.widgets import typed_number
from explorer.widgets.controls import CHANGED, Control
from explorer.widgets.section import Section
from rangenav.number_format import significant

WIDEN = 1.25
"""A slider that must show a value outside its range is widened to this many times the value."""
DIGITS = 4
"""Significant digits of a value in a caption, and of one that a slider has made."""
MAX_TEXT = 8
"""Characters that the box shows of a long number."""
BOX_LABEL = "number"
"""Behind the slider's label, the label of the box. It is read aloud, and not seen."""


class DialControl(Control[float]):
    """A slider with a box. The slider has positions, the box has the number; the one moved last counts."""

    def __init__(
        self,
        section: Section,
        label: str,
        positions: tuple[float, float],
        step: float,
        first: float,
        *,
        hint: str,
        marks: tuple[tuple[float, str], ...],
    ) -> None:
        """`first` is the value shown first."""
        low, high = positions
        with of_kind("rn-slider-"):
            self._slider = section.gui.add_slider(label, low, high, step, low, hint=hint, marks=marks)
        with of_kind("rn-box-number-"):
            self._box = section.gui.add_text(f"{label}: {BOX_LABEL}", "")
        self._exact, self._source = first, "exact"
        self._seen_position, self._seen_text = low, ""
        self._shown: tuple[float, str] = self._seen_position, self._seen_text
        """Position and text of the value that was written. Where a visitor goes back to one of them, the exact value
        is meant, and not the rounded one that slider and box show."""
        super().__init__(section, label, self._slider)
        self._watch(self._box)

    _source: Literal["exact", "slider", "box"]
    """What holds the value: it was written, or the slider was moved last, or the box was typed into last."""

    @abstractmethod
    def _number_at(self, position: float) -> float:
        """The number for the box at a position of the slider."""

    @abstractmethod
    def _position_of(self, number: float) -> float | None:
        """The position of a number of the box; None if it has none."""

    def _value_of(self, number: float) -> float:
        """The control's value for a number of the box."""
        return number

    def _number_of(self, value: float) -> float:
        """The number that the box shows for a value."""
        return value

    @property
    def handles(self) -> tuple[viser.GuiSliderHandle[float], viser.GuiTextHandle]:
        """The slider and the box."""
        return self._slider, self._box

    @property
    def boxes(self) -> tuple[viser.GuiTextHandle, ...]:
        """The box."""
        return (self._box,)

    @property
    def text(self) -> str:
        """What the box holds."""
        return self._box.value

    def type(self, text: str) -> None:
        """Put a text into the box, as a visitor does."""
        self._box.value = text

    def read(self) -> float:
        """The value as written, moved or typed. Raises ValueError if the box holds no number, or the slider sent none.

        Whether the value is within its range is not checked here."""
        self._look()
        position, text = self._shown
        if self._source == "exact" or (self._source == "slider" and self._slider.value == position):
            return self._exact
        if self._source == "box":
            if self._box.value == text:
                return self._exact
            try:
                return self._value_of(typed_number.parse(self._box.value))
            except ValueError as error:
                raise ValueError(f"{self.name}: {error}") from None
        if not math.isfinite(self._slider.value):
            raise ValueError(f"{self.name} must be a finite number")
        return self._value_of(self._number_at(self._slider.value))

    def show(self, value: float) -> None:
        """Show a value; the slider is widened if the value is outside its range."""
        self._section.touch()
        number = self._number_of(value)
        self._exact, self._source = value, "exact"
        self._move_slider(number, widen=True)
        self._write_box(number)
        self._shown = self._seen_position, self._seen_text = self._slider.value, self._box.value

    def mark(self) -> bool:
        """Let the slider follow what was typed, and the box what the slider says; and mark what differs."""
        self._look()
        value = self._value()
        refused = self._section.complaint.is_about(element_id(self._box))
        if value is not None and self._source == "box" and not refused:
            self._move_slider(self._number_of(value), widen=False)
            self._seen_position = self._slider.value
        elif value is not None and self._source == "slider":
            self._box.value = self._seen_text = significant(self._number_of(value), DIGITS)
        return super().mark()

    def _look(self) -> None:
        """Notice which of the two was moved since the last look."""
        if self._box.value != self._seen_text:
            self._source, self._seen_text, self._seen_position = "box", self._box.value, self._slider.value
        elif self._slider.value != self._seen_position:
            self._source, self._seen_position = "slider", self._slider.value

    def _move_slider(self, number: float, *, widen: bool) -> None:
        position = self._position_of(number)
        if position is None:
            return
        if widen:
            widen_to(self._slider, position)
        self._slider.value = min(max(position, self._slider.min), self._slider.max)

    def _write_box(self, number: float) -> None:
        """Show a number; a text that already says it stays as it was typed."""
        try:
            if typed_number.parse(self._box.value) == number:
                return
        except ValueError:
            pass
        self._box.value = typed_number.text(number, MAX_TEXT)

    def _relabel(self) -> None:
        super()._relabel()
        label = f"{self._text}: {BOX_LABEL}{CHANGED if self._marked else ''}"
        if label != self._box.label:
            self._box.label = label


def widen_to(slider: viser.GuiSliderHandle[float], value: float) -> None:
    """Widen a slider that does not reach a value."""
    if value < slider.min:
        slider.min = value * WIDEN if value < 0 else value / WIDEN
    if value > slider.max:
        slider.max = value * WIDEN if value > 0 else value / WIDEN
