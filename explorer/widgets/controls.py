"""The controls that panels are made of. Each reads a checked value, and keeps a written one exactly.

viser rounds what a slider shows and checks nothing that a browser sends. So a control remembers the exact value it was
given and answers with it until the visitor moves the control; and what it reads is checked by the model, which raises
ValueError, never by the limits of a slider. Beside its value a control knows its base, what the preset says: where they
differ its label is marked with •, and it can be reset.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Generic, TypeVar

import viser

from explorer.widgets.form import Section, Wake
from rangenav.inputs import Vec3
from rangenav.number_format import significant

WIDEN = 1.25
"""A slider that must show a value outside its range is widened to this much more than the value."""
LOG_DIGITS, MAX_EXPONENT = 2, 300
DIGITS = 4
"""Significant digits of a value in a caption."""
CHANGED = " •"
MAX_SHOWN_TEXT = 20_000
"""Characters; a browser that is sent megabytes for one box stands still."""
T = TypeVar("T")


class Control(ABC, Generic[T]):
    """A value on the page, and what the preset says it is."""

    def __init__(self, section: Section, name: str, handle: Any) -> None:
        self.name, self._handle = name, handle
        self._base: T | None = None
        self._text, self._marked = name, False
        self._seen = self._value()
        when_moved(handle, section.wake)
        section.add(self)

    @abstractmethod
    def read(self) -> T:
        """The value as written, or as the visitor has moved it. Raises ValueError if the browser sent what is none."""

    @abstractmethod
    def show(self, value: T) -> None:
        """Show a value."""

    def write(self, value: T, base: T | None) -> None:
        """Show a value, and remember what the preset says; None if it says nothing of the kind."""
        self._base = base
        self.show(value)
        self._seen = self._value()

    def mark(self) -> bool:
        """Whether the value differs from the preset's; the label says so."""
        self._marked = self._base is not None and self._value() != self._base
        self._relabel()
        return self._marked

    def moved(self) -> bool:
        """Whether the visitor has moved it since the last call."""
        before, self._seen = self._seen, self._value()
        return self._seen != before

    def reset(self) -> None:
        """Back to what the preset says."""
        if self._base is not None and self._value() != self._base:
            self.show(self._base)
            self._seen = self._value()

    def _value(self) -> T | None:
        try:
            return self.read()
        except ValueError:
            return None

    def _caption(self, text: str) -> None:
        self._text = text
        self._relabel()

    def _relabel(self) -> None:
        label = self._text + (CHANGED if self._marked else "")
        if label != self._handle.label:  # a message to the browser only if there is news
            self._handle.label = label


class Dial(Control[float]):
    """A linear slider with its number box. The value may be shown in another unit: value · scale."""

    def __init__(
        self,
        section: Section,
        label: str,
        limits: tuple[float, float],
        *,
        step: float,
        hint: str,
        scale: float = 1.0,
    ) -> None:
        low, high = limits
        self._scale, self._digits = scale, max(0, -math.floor(math.log10(step)))
        self._slider = section.gui.add_slider(label, low, high, step, low, hint=hint)
        self._exact, self._shown = low / scale, low
        super().__init__(section, label, self._slider)

    def read(self) -> float:
        """The value as written, or as the visitor has moved it; not checked."""
        value = self._slider.value
        return self._exact if value == self._shown else value / self._scale

    def show(self, value: float) -> None:
        """Show a value; the slider is widened if need be."""
        self._exact, self._shown = value, round(value * self._scale, self._digits)
        _widen(self._slider, self._shown)
        self._slider.value = self._shown


class LogDial(Control[float]):
    """A slider over log10, with the value itself in its label. Far left may mean zero."""

    def __init__(
        self,
        section: Section,
        symbol: str,
        limits: tuple[float, float],
        *,
        hint: str,
        unit: str = "",
        zero_at_left: bool = False,
    ) -> None:
        low, high = (round(math.log10(limit), LOG_DIGITS) for limit in limits)
        self._symbol, self._unit, self._zero = symbol, unit, zero_at_left
        marks = ((low, "0" if zero_at_left else significant(limits[0], DIGITS)), (high, significant(limits[1], DIGITS)))
        hint = f"{hint} The slider and its box hold the power of ten." + (
            " Far left: none at all." if zero_at_left else ""
        )
        self._slider = section.gui.add_slider(symbol, low, high, 10.0**-LOG_DIGITS, low, hint=hint, marks=marks)
        self._exact, self._shown = 0.0 if zero_at_left else limits[0], low
        super().__init__(section, symbol, self._slider)

    def read(self) -> float:
        """The value as written or moved; the label follows. Raises ValueError if it is no number."""
        exponent = self._slider.value
        if not abs(exponent) <= MAX_EXPONENT:
            raise ValueError(f"log10 of {self._symbol} must be a number between -{MAX_EXPONENT} and {MAX_EXPONENT}")
        at_left = self._zero and exponent == self._slider.min
        value = self._exact if exponent == self._shown else 0.0 if at_left else 10.0**exponent
        self._say(value)
        return value

    def show(self, value: float) -> None:
        """Show a value; the slider is widened if need be."""
        at_left = self._zero and value == 0
        self._exact = value
        self._shown = self._slider.min if at_left else round(math.log10(value), LOG_DIGITS)
        if self._zero and not at_left and self._shown <= self._slider.min:  # leave a place for zero, left of it
            self._slider.min = self._shown - 1
        _widen(self._slider, self._shown)
        self._slider.value = self._shown
        self._say(value)

    def _say(self, value: float) -> None:
        self._caption(f"{self._symbol} = {significant(value, DIGITS)} {self._unit}".rstrip())


class Number(Control[float]):
    """A box for a number without a natural range."""

    def __init__(self, section: Section, label: str, *, step: float, hint: str) -> None:
        self._box = section.gui.add_number(label, 0.0, step=step, hint=hint)
        super().__init__(section, label, self._box)

    def read(self) -> float:
        """The value in the box; not checked."""
        return self._box.value

    def show(self, value: float) -> None:
        """Show a value."""
        self._box.value = value


class Vector(Control[Vec3]):
    """Three boxes. The value may be shown in another unit: value · scale."""

    def __init__(self, section: Section, label: str, *, step: float, hint: str, scale: float = 1.0) -> None:
        self._label, self._scale, self._digits = label, scale, max(0, -math.floor(math.log10(step)))
        self._box = section.gui.add_vector3(label, (0.0, 0.0, 0.0), step=step, hint=hint)
        self._exact: Vec3 = (0.0, 0.0, 0.0)
        self._shown: tuple[float, ...] = self._exact
        super().__init__(section, label, self._box)

    def read(self) -> Vec3:
        """The three values. Raises ValueError if the browser sent none such."""
        value = tuple(self._box.value)
        if len(value) != 3:
            raise ValueError(f"{self._label} must have three components, got {len(value)}")
        if not all(isinstance(entry, float) for entry in value):
            raise ValueError(f"{self._label} must have three components that are numbers")
        if value == self._shown:
            return self._exact
        return value[0] / self._scale, value[1] / self._scale, value[2] / self._scale

    def show(self, value: Vec3) -> None:
        """Show a value; another unit is rounded for reading."""
        self._exact = self._shown = value
        if self._scale != 1.0:
            self._shown = tuple(round(entry * self._scale, self._digits) for entry in value)
        self._box.value = (self._shown[0], self._shown[1], self._shown[2])


class Choice(Control[T]):
    """A dropdown over words, each standing for a value."""

    def __init__(self, section: Section, label: str, words: Mapping[T, str], *, hint: str) -> None:
        self._words, self._values = dict(words), {word: value for value, word in words.items()}
        self._menu = section.gui.add_dropdown(label, tuple(self._values), hint=hint)
        super().__init__(section, label, self._menu)

    def read(self) -> T:
        """The value chosen. Raises ValueError if the browser sent one that was not offered."""
        if self._menu.value not in self._values:
            raise ValueError(f"{self.name} must be one of: {', '.join(self._values)}")
        return self._values[self._menu.value]

    def show(self, value: T) -> None:
        """Show a value."""
        self._menu.value = self._words[value]

    def offer(self, words: Mapping[T, str]) -> None:
        """Other values to choose from; what is chosen stays if it is still among them."""
        if dict(words) != self._words:
            self._words, self._values = dict(words), {word: value for value, word in words.items()}
            self._menu.options = tuple(self._values)


class Switch(Control[bool]):
    """A checkbox."""

    def __init__(self, section: Section, label: str, *, hint: str) -> None:
        self._box = section.gui.add_checkbox(label, False, hint=hint)
        super().__init__(section, label, self._box)

    def read(self) -> bool:
        """Whether it is on."""
        return self._box.value

    def show(self, value: bool) -> None:
        """Show it on or off."""
        self._box.value = value


class Text(Control[str]):
    """A box for text, of one line or of several. Nothing typed is ever changed; a far too long one is refused."""

    def __init__(self, section: Section, label: str, *, hint: str, longest: int, lines: bool = False) -> None:
        self._longest = longest
        self._box = section.gui.add_text(label, "", multiline=lines, hint=hint)
        super().__init__(section, label, self._box)

    def read(self) -> str:
        """What was typed. Raises ValueError if it is too long to look at."""
        text = self._box.value
        if len(text) > self._longest:
            raise ValueError(f"{self.name.removesuffix(' =')}: at most {self._longest} characters, got {len(text)}")
        return text

    def show(self, value: str) -> None:
        """Show a text."""
        if value != self._box.value:  # while it is being typed, nothing is sent back
            self._box.value = value


def when_moved(handle: viser.GuiInputHandle, wake: Wake) -> None:
    """Note what a visitor changes; viser also calls back when the program assigns a value, then without a client."""
    handle.on_update(lambda event: wake() if event.client_id is not None else None)


def _widen(slider: viser.GuiSliderHandle[float], value: float) -> None:
    if value < slider.min:
        slider.min = value * WIDEN if value < 0 else value / WIDEN
    if value > slider.max:
        slider.max = value * WIDEN if value > 0 else value / WIDEN
