"""A dock without a session's loop: its controls are taken over before they are read."""

from explorer.model.settings import Settings
from explorer.panels.dock import Dock


def refreshed(dock: Dock) -> Settings:
    """What the controls say now. Raises what `Dock.refresh` raises."""
    dock.refresh()
    return dock.read()
