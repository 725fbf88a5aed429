"""What panels need of the dock: all that is chosen, read and shown as one value."""

from typing import Protocol

from explorer.model.settings import Settings


class Page(Protocol):
    """The dock, for the panels in it."""

    def read(self) -> Settings:
        """What is chosen. Raises Refused if it is no valid input, and the visitor has been told."""
        ...

    def write(self, settings: Settings) -> None:
        """Show something else."""
        ...
