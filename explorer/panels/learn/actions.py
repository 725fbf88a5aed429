"""What a lesson does outside its tab: it pins a run, rewinds the flight, downloads, and shows where a control is."""

from collections.abc import Callable
from dataclasses import dataclass

from explorer.lessons.lesson import Place
from explorer.model.settings import Settings
from explorer.widgets.form import Action


@dataclass(frozen=True, kw_only=True)
class LearnActions:
    """What only the session can do."""

    pin: Callable[[Settings | None], None]
    """Pins a run A by its settings, or unpins it."""
    pinned: Callable[[], Settings | None]
    rewind: Action
    """Goes to the beginning of the flight."""
    download: Callable[[str, bytes], None]
    """Downloads a file: its name and its content."""
    exported: Callable[[], tuple[str, bytes] | None]
    """The name of the format and the content of the file that was exported last."""
    go_to: Callable[[Place], None]
    """Brings a control into sight."""
