"""The value of a dock or of a panel, where no session's loop takes over the controls."""

from typing import Protocol, TypeVar

T_co = TypeVar("T_co", covariant=True)


class Refreshable(Protocol[T_co]):
    """A dock, or a panel that needs no value of another one."""

    def refresh(self) -> None: ...
    def read(self) -> T_co: ...


def refreshed(panel: Refreshable[T_co]) -> T_co:
    """The value that the controls show now. Raises the errors of `refresh`."""
    panel.refresh()
    return panel.read()
