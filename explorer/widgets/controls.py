"""The controls that panels are made of: each shows a value of the settings, and the value that the preset has.

viser rounds what a slider shows, and checks nothing that a browser sends. A control therefore remembers the exact value
that was written, and reads it back until the visitor moves the control. The model checks what is read, and raises
ValueError; the limits of a slider check nothing. Where the value differs from the preset's, its base, the label is
marked with •, and the control can be reset.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Generic, TypeVar

import viser

from explorer.widgets import typed_number
from explorer.widgets.form import Wake
from explorer.widgets.section import Section

CHANGED = " •"
T = TypeVar("T")


class Control(ABC, Generic[T]):
    """A value on the page, and the preset's value."""

    def __init__(self, section: Section, name: str, handle: Any) -> None:
        self.name, self.handle, self._section = name, handle, section
        self._base: T | None = None
        self._text, self._marked = name, False
        self._last_value = self._value()
        self._by_visitor = False
        """Whether a visitor has changed the control since `moved` was asked last."""
        self._watch(handle)
        section.add(self)

    @property
    def boxes(self) -> tuple[viser.GuiTextHandle, ...]:
        """The text boxes into which the value is typed."""
        return ()

    @abstractmethod
    def read(self) -> T:
        """The value that was written, or to which the visitor has moved the control.

        Raises ValueError if the browser sent a value of another kind."""

    @abstractmethod
    def show(self, value: T) -> None:
        """Show a value."""

    def write(self, value: T, base: T | None) -> None:
        """Show a value, and remember the preset's value; None if the preset has none."""
        self._base = base
        self._section.touch()
        self.show(value)
        self._last_value = self._value()

    def mark(self) -> bool:
        """Whether the value differs from the preset's; the label says so."""
        self._marked = self._base is not None and self._value() != self._base
        self._relabel()
        return self._marked

    def moved(self) -> bool:
        """Whether the visitor has moved the control since the last call; what the page itself writes does not count."""
        if not self._by_visitor:
            return False
        self._by_visitor = False  # before reading, so that no change is lost
        before, self._last_value = self._last_value, self._value()
        return self._last_value != before

    def reset(self) -> None:
        """Show the preset's value."""
        if self._base is not None and self._value() != self._base:
            self.show(self._base)
            self._last_value = self._value()

    def _watch(self, handle: viser.GuiInputHandle) -> None:
        """Note every change of a handle, and then wake the loop if a visitor has changed it."""

        def changed(event: viser.GuiEvent[Any]) -> None:  # one callback: viser's threads may run two in any order
            self._by_visitor = self._by_visitor or event.client_id is not None
            self._section.touch()
            if event.client_id is not None:
                self._section.wake()

        handle.on_update(changed)

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
        if label != self.handle.label:  # so that an unchanged label sends no message
            self.handle.label = label


class Number(Control[float]):
    """A box for a number without a natural range. What is typed stays as it was typed.

    viser's own box for a number drops what its step does not foresee: 1.5 s becomes 15 s, and 5e3 becomes 53."""

    def __init__(self, section: Section, label: str, *, hint: str) -> None:
        self._box = section.gui.add_text(label, "0", hint=hint)
        self._exact, self._shown = 0.0, "0"
        super().__init__(section, label, self._box)

    @property
    def boxes(self) -> tuple[viser.GuiTextHandle, ...]:
        """The box."""
        return (self._box,)

    def read(self) -> float:
        """The value in the box, which is not checked. Raises ValueError if the box holds no number."""
        if self._box.value == self._shown:
            return self._exact
        try:
            return typed_number.parse(self._box.value)
        except ValueError as error:
            raise ValueError(f"{self.name}: {error}") from None

    def show(self, value: float) -> None:
        """Show a value; a text that already says it stays as it was typed."""
        self._section.touch()
        if self._value() != value:
            self._box.value = typed_number.text(value)
        self._exact, self._shown = value, self._box.value


class Choice(Control[T]):
    """A dropdown; each of its labels stands for a value."""

    def __init__(self, section: Section, label: str, labels: Mapping[T, str], *, hint: str) -> None:
        self._labels, self._values = dict(labels), {text_label: value for value, text_label in labels.items()}
        self._menu = section.gui.add_dropdown(label, tuple(self._values), hint=hint)
        super().__init__(section, label, self._menu)

    def read(self) -> T:
        """The chosen value. Raises ValueError if the browser sent one that was not offered."""
        if self._menu.value not in self._values:
            raise ValueError(f"{self.name} must be one of: {', '.join(self._values)}")
        return self._values[self._menu.value]

    def show(self, value: T) -> None:
        """Show a value."""
        self._menu.value = self._labels[value]

    def offer(self, labels: Mapping[T, str]) -> None:
        """Offer other values; the chosen one stays if it is among them."""
        if dict(labels) != self._labels:
            self._labels, self._values = dict(labels), {text_label: value for value, text_label in labels.items()}
            self._menu.options = tuple(self._values)
            self._section.touch()


class Switch(Control[bool]):
    """A checkbox."""

    def __init__(self, section: Section, label: str, *, hint: str) -> None:
        self._box = section.gui.add_checkbox(label, False, hint=hint)
        super().__init__(section, label, self._box)

    def read(self) -> bool:
        """Whether the checkbox is on."""
        return self._box.value

    def show(self, value: bool) -> None:
        """Show the checkbox on or off."""
        self._box.value = value


class Text(Control[str]):
    """A box for text of one or several lines. The text is never changed; a text that is far too long is refused."""

    def __init__(self, section: Section, label: str, *, hint: str, longest: int, lines: bool = False) -> None:
        self._longest = longest
        self._box = section.gui.add_text(label, "", multiline=lines, hint=hint)
        super().__init__(section, label, self._box)

    def read(self) -> str:
        """The text. Raises ValueError if it is longer than the box allows."""
        text = self._box.value
        if len(text) > self._longest:
            raise ValueError(f"{self.name.removesuffix(' =')}: at most {self._longest} characters, got {len(text)}")
        return text

    def show(self, value: str) -> None:
        """Show a text."""
        if value != self._box.value:  # so that nothing is sent back while the visitor types
            self._box.value = value


def when_moved(handle: viser.GuiInputHandle, wake: Wake) -> None:
    """Wake the loop when a visitor moves a control, after what was moved before; a move that acts like the press of a
    button belongs to `Form.when_moved`. For assigned values viser calls back without a client."""
    handle.on_update(lambda event: wake() if event.client_id is not None else None)
