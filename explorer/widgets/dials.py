"""Dials: a slider and a box over a range of numbers; linear, over powers of ten, or of the inverse."""

import math

from explorer.widgets.dial_control import DIGITS, DialControl, widen_to
from explorer.widgets.section import Section
from rangenav.inputs import require_within
from rangenav.number_format import significant

LOG_DIGITS, MAX_EXPONENT = 2, 300
ROUNDED = 9
"""Decimals to which a number in another unit is compared with its limits: what is beyond is rounding."""


class Dial(DialControl):
    """A linear slider. The value may be shown in another unit: value · scale."""

    def __init__(
        self,
        section: Section,
        label: str,
        limits: tuple[float, float],
        *,
        step: float,
        hint: str,
        scale: float = 1.0,
        allowed: tuple[float, float] | None = None,
        ends: bool = True,
    ) -> None:
        """`allowed` are the least and the largest number in the unit that is shown, for a value in another unit: the
        model would name the limits in its own. `ends`: whether the ends are written below the slider, which viser can
        do only once."""
        self._allowed = allowed
        self._scale, self._digits = scale, max(0, -math.floor(math.log10(step)))
        marks = tuple((end, significant(end, DIGITS)) for end in limits) if ends else ()
        super().__init__(section, label, limits, step, limits[0] / scale, hint=hint, marks=marks)

    def read(self) -> float:
        """As in the base class. Raises ValueError for a number that is not allowed, in the unit that is shown."""
        value = super().read()
        if self._allowed is not None:
            require_within(self.name, round(value * self._scale, ROUNDED), *self._allowed)
        return value

    def reach(self, value: float) -> None:
        """Widen the slider until it reaches a value (in its own unit), which it does not show."""
        if not self._slider.min <= value * self._scale <= self._slider.max:
            widen_to(self._slider, round(value * self._scale, self._digits))

    def span(self, high: float) -> None:
        """Another right end of the slider (in the unit that is shown), not below the number that it shows."""
        if high != self._slider.max:
            self._slider.max = high

    def _number_at(self, position: float) -> float:
        return position

    def _position_of(self, number: float) -> float | None:
        return round(number, self._digits)

    def _value_of(self, number: float) -> float:
        return number / self._scale

    def _number_of(self, value: float) -> float:
        return value if self._scale == 1.0 else round(value * self._scale, self._digits)


class LogDial(DialControl):
    """A slider over powers of ten. Its left end may mean zero."""

    def __init__(
        self,
        section: Section,
        label: str,
        limits: tuple[float, float],
        *,
        hint: str,
        zero_at_left: bool = False,
    ) -> None:
        low, high = (round(math.log10(limit), LOG_DIGITS) for limit in limits)
        self._zero = zero_at_left
        marks = ((low, "0" if zero_at_left else significant(limits[0], DIGITS)), (high, significant(limits[1], DIGITS)))
        hint = f"{hint} Far left: none at all." if zero_at_left else hint
        first = 0.0 if zero_at_left else self._value_of(limits[0])
        super().__init__(section, label, (low, high), 10.0**-LOG_DIGITS, first, hint=hint, marks=marks)

    def show(self, value: float) -> None:
        """Show a value; the slider is widened if the value is outside its range."""
        position = self._position_of(self._number_of(value))
        if self._zero and value != 0 and position is not None and position <= self._slider.min:
            self._slider.min = position - 1  # so that zero has a position to the left
        super().show(value)

    def _number_at(self, position: float) -> float:
        if abs(position) > MAX_EXPONENT:
            raise ValueError(f"{self.name} must be a number, got 10 to the power of {position:g}")
        return 0.0 if self._zero and position == self._slider.min else 10.0**position

    def _position_of(self, number: float) -> float | None:
        if number == 0 and self._zero:
            return self._slider.min
        return round(math.log10(number), LOG_DIGITS) if number > 0 else None


class InverseDial(LogDial):
    """A logarithmic slider and a box for the inverse of the value."""

    def _value_of(self, number: float) -> float:
        return 1 / number if number else math.inf

    def _number_of(self, value: float) -> float:
        return 1 / value
