"""The part of the dock that panels use: all settings, read and written as one value."""

from typing import Protocol

from explorer.model.settings import Settings


class Page(Protocol):
    """The dock, for the panels in it."""

    def read(self) -> Settings:
        """What is chosen. Raises InvalidInputError if that is no valid input; the page then says why."""
        ...

    def write(self, settings: Settings) -> None:
        """Show other settings."""
        ...


class Belonging(Protocol):
    """A panel with texts or results that belong to the preset on the page."""

    def forget_preset(self) -> None:
        """Drop them, because another preset is opened."""
        ...
