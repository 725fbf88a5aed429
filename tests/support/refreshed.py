"""A dock without a session's loop: its controls are taken over before they are read."""

from explorer.model.settings import Settings
from explorer.panels.dock import Dock


def refreshed(dock: Dock) -> Settings:
    """The settings that the controls show now. Raises the errors of `Dock.refresh`."""
    dock.refresh()
    return dock.read()
