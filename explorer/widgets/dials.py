"""Sliders with numbers: a linear one, and a logarithmic one that shows its value in its label."""

import math

import viser

from explorer.widgets.controls import Control
from explorer.widgets.section import Section
from rangenav.number_format import significant

WIDEN = 1.25
"""A slider that must show a value outside its range is widened to this many times the value."""
LOG_DIGITS, MAX_EXPONENT = 2, 300
DIGITS = 4
"""Significant digits of a value in a caption."""


class Dial(Control[float]):
    """A linear slider with a number box. The value may be shown in another unit: value · scale."""

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
        """The value as written, or as the visitor has moved it; it is not checked."""
        value = self._slider.value
        return self._exact if value == self._shown else value / self._scale

    def show(self, value: float) -> None:
        """Show a value; the slider is widened if the value is outside its range."""
        self._exact, self._shown = value, round(value * self._scale, self._digits)
        _widen(self._slider, self._shown)
        self._slider.value = self._shown

    def reach(self, value: float) -> None:
        """Widen the slider until it reaches a value (in its own unit), which it does not show."""
        if not self._slider.min <= value * self._scale <= self._slider.max:
            _widen(self._slider, round(value * self._scale, self._digits))


class LogDial(Control[float]):
    """A slider over log10, with the value in its label. Its left end may mean zero."""

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
        """The value as written or moved. Raises ValueError if it is no number."""
        exponent = self._slider.value
        if not abs(exponent) <= MAX_EXPONENT:
            raise ValueError(f"log10 of {self._symbol} must be a number between -{MAX_EXPONENT} and {MAX_EXPONENT}")
        at_left = self._zero and exponent == self._slider.min
        return self._exact if exponent == self._shown else 0.0 if at_left else 10.0**exponent

    def mark(self) -> bool:
        """Bring the label up to date, and say whether the value differs from the preset's."""
        value = self._value()
        if value is not None:
            self._say(value)
        return super().mark()

    def show(self, value: float) -> None:
        """Show a value; the slider is widened if the value is outside its range."""
        at_left = self._zero and value == 0
        self._exact = value
        self._shown = self._slider.min if at_left else round(math.log10(value), LOG_DIGITS)
        if self._zero and not at_left and self._shown <= self._slider.min:  # so that zero has a position to the left
            self._slider.min = self._shown - 1
        _widen(self._slider, self._shown)
        self._slider.value = self._shown
        self._say(value)

    def _say(self, value: float) -> None:
        self._caption(f"{self._symbol} = {significant(value, DIGITS)} {self._unit}".rstrip())


def _widen(slider: viser.GuiSliderHandle[float], value: float) -> None:
    if value < slider.min:
        slider.min = value * WIDEN if value < 0 else value / WIDEN
    if value > slider.max:
        slider.max = value * WIDEN if value > 0 else value / WIDEN
