"""The controls that panels are made of. Each reads a checked value, and keeps a written one exactly.

viser rounds what a slider shows and checks nothing that a browser sends. So a control remembers the exact value it was
given and answers with it until the visitor moves the control; and what it reads is checked by the model, which raises
ValueError, never by the limits of a slider. A control calls `note` when the visitor, and only the visitor, changes it.
"""

import html
import math
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Generic, TypeVar

import viser

from rangenav.inputs import Vec3

Note = Callable[[], None]
"""Called from viser's threads: it may set an event and nothing else."""
WIDEN = 1.25
"""A slider that must show a value outside its range is widened to this much more than the value."""
LOG_DIGITS, MAX_EXPONENT = 2, 300
MAX_CLICKS = 32
"""Presses remembered while the session is busy; of more, the oldest are dropped."""
RED = "#b3261e"


class Refused(Exception):  # noqa: N818  (not an error of the program: the visitor has been told)
    """What is chosen is no valid input, and a sentence beside the control says why."""


T = TypeVar("T")


class Complaint:
    """A place for one sentence under the controls that caused it."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._line = gui.add_html("", visible=False)

    def say(self, sentence: str) -> None:
        """Show the sentence, marked by a sign as well as a colour."""
        style = f"color:{RED};font-weight:600;font-size:0.85em;padding:0.2em 0.8em 0.6em"
        self._line.content = f'<div role="alert" style="{style}">⚠ {html.escape(sentence)}</div>'
        self._line.visible = True

    def clear(self) -> None:
        """Nothing to complain about."""
        self._line.visible = False

    @contextmanager
    def catching(self) -> Iterator[None]:
        """Turn a ValueError into a sentence here, and into Refused for the caller."""
        try:
            yield
        except ValueError as error:
            self.say(str(error))
            raise Refused from error
        self.clear()


class Dial:
    """A linear slider with its number box. The value may be shown in another unit: value · scale."""

    def __init__(
        self,
        gui: viser.GuiApi,
        label: str,
        limits: tuple[float, float],
        *,
        step: float,
        hint: str,
        note: Note,
        scale: float = 1.0,
    ) -> None:
        low, high = limits
        self._scale, self._digits = scale, max(0, -math.floor(math.log10(step)))
        self._slider = gui.add_slider(label, low, high, step, low, hint=hint)
        self._exact, self._shown = low / scale, low
        when_moved(self._slider, note)

    def read(self) -> float:
        """The value as written, or as the visitor has moved it; not checked."""
        value = self._slider.value
        return self._exact if value == self._shown else value / self._scale

    def write(self, value: float) -> None:
        """Show a value; the slider is widened if need be."""
        self._exact, self._shown = value, round(value * self._scale, self._digits)
        _widen(self._slider, self._shown)
        self._slider.value = self._shown


class LogDial:
    """A slider over log10, with the value itself in its label. Far left may mean zero."""

    def __init__(
        self,
        gui: viser.GuiApi,
        symbol: str,
        limits: tuple[float, float],
        *,
        hint: str,
        note: Note,
        unit: str = "",
        zero_at_left: bool = False,
    ) -> None:
        low, high = (round(math.log10(limit), LOG_DIGITS) for limit in limits)
        self._symbol, self._unit, self._zero = symbol, unit, zero_at_left
        marks = ((low, "0" if zero_at_left else short(limits[0])), (high, short(limits[1])))
        hint = f"{hint} The slider and its box hold the power of ten." + (
            " Far left: none at all." if zero_at_left else ""
        )
        self._slider = gui.add_slider(symbol, low, high, 10.0**-LOG_DIGITS, low, hint=hint, marks=marks)
        self._exact, self._shown = 0.0 if zero_at_left else limits[0], low
        when_moved(self._slider, note)

    def read(self) -> float:
        """The value as written or moved; the label follows. Raises ValueError if it is no number."""
        exponent = self._slider.value
        if not abs(exponent) <= MAX_EXPONENT:
            raise ValueError(f"log10 of {self._symbol} must be a number between -{MAX_EXPONENT} and {MAX_EXPONENT}")
        at_left = self._zero and exponent == self._slider.min
        value = self._exact if exponent == self._shown else 0.0 if at_left else 10.0**exponent
        self._caption(value)
        return value

    def write(self, value: float) -> None:
        """Show a value; the slider is widened if need be."""
        at_left = self._zero and value == 0
        self._exact = value
        self._shown = self._slider.min if at_left else round(math.log10(value), LOG_DIGITS)
        _widen(self._slider, self._shown)
        self._slider.value = self._shown
        self._caption(value)

    def _caption(self, value: float) -> None:
        label = f"{self._symbol} = {short(value)} {self._unit}".rstrip()
        if label != self._slider.label:  # a message to the browser only if there is news
            self._slider.label = label


class Number:
    """A box for a number without a natural range."""

    def __init__(self, gui: viser.GuiApi, label: str, *, step: float, hint: str, note: Note) -> None:
        self._box = gui.add_number(label, 0.0, step=step, hint=hint)
        when_moved(self._box, note)

    def read(self) -> float:
        """The value in the box; not checked."""
        return self._box.value

    def write(self, value: float) -> None:
        """Show a value."""
        self._box.value = value


class Vector:
    """Three boxes."""

    def __init__(self, gui: viser.GuiApi, label: str, *, step: float, hint: str, note: Note) -> None:
        self._name = label
        self._box = gui.add_vector3(label, (0.0, 0.0, 0.0), step=step, hint=hint)
        when_moved(self._box, note)

    def read(self) -> Vec3:
        """The three values. Raises ValueError if the browser sent more or fewer."""
        value = self._box.value
        if len(value) != 3:
            raise ValueError(f"{self._name} must have three components, got {len(value)}")
        return value[0], value[1], value[2]

    def write(self, value: Vec3) -> None:
        """Show a vector."""
        self._box.value = value


class Choice(Generic[T]):
    """A dropdown: one of a few values, each under its own words."""

    def __init__(self, gui: viser.GuiApi, label: str, words: Mapping[T, str], *, hint: str, note: Note) -> None:
        self._name, self._words, self._values = label, dict(words), {text: value for value, text in words.items()}
        self._menu = gui.add_dropdown(label, tuple(words.values()), hint=hint)
        when_moved(self._menu, note)

    def read(self) -> T:
        """The chosen value. Raises ValueError if the browser sent one that was not offered."""
        if self._menu.value not in self._values:
            raise ValueError(f"{self._name} must be one of: {', '.join(self._values)}")
        return self._values[self._menu.value]

    def write(self, value: T) -> None:
        """Show a value."""
        self._menu.value = self._words[value]


class Switch:
    """A checkbox."""

    def __init__(self, gui: viser.GuiApi, label: str, *, hint: str, note: Note) -> None:
        self._box = gui.add_checkbox(label, False, hint=hint)
        when_moved(self._box, note)

    def read(self) -> bool:
        """Whether it is on."""
        return self._box.value

    def write(self, value: bool) -> None:
        """Show it on or off."""
        self._box.value = value


class Clicks:
    """The names of what the visitor has pressed, in order, until the session takes them."""

    def __init__(self, note: Note) -> None:
        self._names: deque[str] = deque(maxlen=MAX_CLICKS)
        self._note = note

    def add(self, name: str) -> None:
        """Called from viser's threads."""
        self._names.append(name)
        self._note()

    @property
    def waiting(self) -> bool:
        """Whether there is something to take."""
        return bool(self._names)

    def take(self) -> list[str]:
        """All names so far, oldest first."""
        return [self._names.popleft() for _ in range(len(self._names))]


def short(value: float) -> str:
    """Four digits, and no more characters than they need."""
    return f"{value:.4g}".replace("e-0", "e-").replace("e+0", "e")


def when_moved(handle: viser.GuiInputHandle, note: Note) -> None:
    """Note what a visitor changes; viser also calls back when the program assigns a value, then without a client."""
    handle.on_update(lambda event: note() if event.client_id is not None else None)


def _widen(slider: viser.GuiSliderHandle[float], value: float) -> None:
    if value < slider.min:
        slider.min = value * WIDEN if value < 0 else value / WIDEN
    if value > slider.max:
        slider.max = value * WIDEN if value > 0 else value / WIDEN
