"""The figures of the open screen: a job computes them, because some take most of a second, and the text follows.

read(name, state)     the figure, or "computing …"
compute(done)         begins a job for all figures that were read since `begin`, unless all of them are known
"""

from collections.abc import Callable

from explorer.lessons import figures
from explorer.lessons.state import State
from explorer.model.jobs import Jobs
from explorer.model.settings import Settings
from rangenav.progress import Cancelled, CancelledError, Progress

COMPUTING = "computing …"
KEPT = 256
"""Figures that are known at once when a screen is shown again."""
Key = tuple[str, Settings, tuple[str, bytes] | None]
"""The name of a figure, and all of a state that figures depend on."""


class ScreenFigures:
    """The figures that one screen shows, of the settings that it shows them for. The newest screen wins."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self._known: dict[Key, str] = {}
        self._wanted: dict[Key, State] = {}
        self._computed: frozenset[Key] = frozenset()
        """What the running job computes."""

    def begin(self) -> None:
        """A screen is written anew."""
        self._wanted = {}

    def read(self, name: str, state: State) -> str:
        """A figure of the screen as a text shows it; a word in its place until it is known."""
        key = name, state.settings, state.exported
        self._wanted[key] = state
        return self._known.get(key, COMPUTING)

    def compute(self, done: Callable[[], None], failed: Callable[[str], None]) -> None:
        """Have all figures of the screen computed if one is not known: `done` is called when all of them are."""
        wanted, running = dict(self._wanted), self._jobs.running is not None
        if wanted.keys() <= self._known.keys() or (running and self._computed == wanted.keys()):
            return

        def take(known: dict[Key, str]) -> None:
            self._known = dict([*self._known.items(), *known.items()][-KEPT:])
            done()

        self._computed = frozenset(wanted)
        self._jobs.start("the figures of the lesson", lambda *given: _computed(wanted, *given), take, failed)


def _computed(wanted: dict[Key, State], _progress: Progress, cancelled: Cancelled) -> dict[Key, str]:
    """The figures as texts. Where one cannot be computed, its text says why."""
    known = {}
    for key, state in wanted.items():
        if cancelled():
            raise CancelledError
        try:
            known[key] = figures.text(key[0], state)
        except ValueError as error:
            known[key] = f"not computed: {error}"
    return known
