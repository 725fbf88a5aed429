"""The actions of the session that the panels offer as buttons."""

from collections.abc import Callable
from dataclasses import dataclass

from explorer.lessons.lesson import Place
from explorer.storage.bundle import Send
from explorer.widgets.form import Action


@dataclass(frozen=True, kw_only=True)
class SessionActions:
    """What only the session can do."""

    restart_preset: Action
    show_paper_figures: Action
    show_side_by_side: Action
    """Shows the pinned run A and the one on the page side by side."""
    download_preset: Action
    send: Send
    """Downloads a file: its name and its content."""
    go_to: Callable[[str], None]
    """Brings the control with a label into sight."""
    go_to_place: Callable[[Place], None]
    """The same of a label that several controls have."""
    rewind: Action
    """Goes to the beginning of the flight."""
    notify: Callable[[str, str], None]
    """Shows a title and a sentence for a few seconds."""
