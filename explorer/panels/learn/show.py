"""The playback of "show me": one step after the other, each a moment after the last."""

import math

from explorer.lessons.demonstration import Step

PERIOD = 1.5
"""s between two steps: long enough to see what a step has changed."""


class Show:
    """The steps that are still to be shown, and when the next one is due."""

    def __init__(self) -> None:
        self._steps: tuple[Step, ...] = ()
        self._due = math.inf

    def begin(self, steps: tuple[Step, ...], now: float) -> None:
        """Show these steps, the first one at once; without any, end."""
        self._steps, self._due = steps, now if steps else math.inf

    def end(self) -> None:
        """Show no more."""
        self._steps, self._due = (), math.inf

    @property
    def ended(self) -> bool:
        """Whether no step is left."""
        return not self._steps

    def wait(self, now: float) -> float | None:
        """How long (s) until the next step; None if there is none."""
        return None if self.ended else max(0.0, self._due - now)

    def take(self, now: float) -> Step | None:
        """The step that is due, which then has been shown; None if none is."""
        if self.ended or now < self._due:
            return None
        step, *rest = self._steps
        self._steps, self._due = tuple(rest), now + PERIOD if rest else math.inf
        return step
