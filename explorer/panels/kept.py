"""A panel's value, kept until one of its controls is touched: the drag of a waypoint reads no dial of a sensor."""

from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

from explorer.widgets.form import Form, FormSection

V_co = TypeVar("V_co", covariant=True)
V = TypeVar("V")


class Readable(Protocol[V_co]):
    """A panel whose controls hold one value."""

    def refresh(self) -> None: ...
    def read(self) -> V_co: ...


P = TypeVar("P", bound=Readable[Any])


class Kept(Generic[V]):
    """What a panel held when it was read last."""

    def __init__(self, panel: Readable[V], sections: frozenset[FormSection]) -> None:
        """sections: all that hold controls of the panel."""
        self._panel, self._sections = panel, sections
        self._value: tuple[V] | None = None
        """None if a control may have been touched since."""

    def touch(self, sections: frozenset[FormSection] | None) -> None:
        """Note that controls in these sections may have been touched; None stands for all sections."""
        if sections is None or not self._sections.isdisjoint(sections):
            self._value = None

    def refresh(self) -> None:
        """Take over what was touched. Raises InvalidInputError after showing the reason below the control."""
        if self._value is None:
            self._panel.refresh()
            self._value = (self._panel.read(),)

    @property
    def value(self) -> V:
        """What the panel holds; `refresh` comes before."""
        assert self._value is not None, "refresh comes before value"
        return self._value[0]


def kept(form: Form, build: Callable[[], P]) -> tuple[P, Kept[Any]]:
    """A panel that is built now, and its value; its sections are those that the form gets meanwhile."""
    before = len(form.sections)
    panel = build()
    return panel, Kept(panel, frozenset(form.sections[before:]))
