"""What is remembered of one visitor's page besides the settings: it changes no result, and is no step to undo.

The names of the fields are part of the file format of saved work.
"""

from explorer.model.chosen_map import ChosenMap
from explorer.model.comparison import Name
from explorer.model.learning import Learning
from explorer.model.settings import Settings
from rangenav.inputs import Input

MAX_STEPS = 50
"""Steps that are remembered for undo, and as many for redo."""


class View(Input, frozen=True, kw_only=True):
    """The moment that is shown, what the run is compared with, and the steps that can be undone."""

    time: float = 0.0
    """s; where the playhead stands."""
    speed: float = 1.0
    """Of the playback, in flight seconds per second."""
    loop: bool = True
    """Whether the playback begins again at the end."""
    estimators: tuple[Name, ...] = ()
    """The other estimators that are shown."""
    pinned: Settings | None = None
    """The settings of the pinned run A."""
    keep_pinned: bool = False
    """Whether the pinned run stays when another preset is opened."""
    learning: Learning = Learning()
    """Where the visitor is in the course."""
    map: ChosenMap | None = None
    """What is chosen under Studies; None for what a new page offers."""
    past: tuple[Settings, ...] = ()
    """What can be undone, the oldest first; the last one is what was on the page."""
    future: tuple[Settings, ...] = ()
    """What can be redone, the next one last."""
