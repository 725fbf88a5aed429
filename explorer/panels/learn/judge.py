"""The check of a lesson: it runs in a job on what the page shows, whenever nothing has changed for a moment."""

import math
from collections.abc import Callable, Mapping

from explorer.lessons.lesson import Lesson
from explorer.lessons.state import Outcome, State
from explorer.lessons.text import States
from explorer.model.compute import Picture
from explorer.model.jobs import Jobs
from explorer.model.settings import Settings

Exported = tuple[str, bytes]
"""The name of the format and the content of an exported file."""


class Judge:
    """What the check of the open lesson was asked about, and what came of it."""

    def __init__(
        self, jobs: Jobs, *, pinned: Callable[[], Settings | None], exported: Callable[[], Exported | None]
    ) -> None:
        """pinned: the settings of the run A. exported: the file that was exported last."""
        self._jobs, self._pinned, self._exported = jobs, pinned, exported
        self.picture: Picture | None = None
        """The picture on the page; None before the first one."""
        self.outcome: Outcome | None = None
        """What came of the check of what the page shows; None until it is known."""
        self._at_rest = False
        """Whether nothing has changed for a moment."""
        self._judged: State | None = None
        """What the last check was asked about."""
        self._earlier_export: Exported | None = None
        """What had been exported before the lesson was opened: it is no answer to the task."""

    def begin(self) -> None:
        """A lesson was opened."""
        self._earlier_export = self._exported()

    def forget(self) -> None:
        """Another state of the lesson is shown: nothing is known of it."""
        self.outcome = self._judged = None

    def moved(self, picture: Picture) -> None:
        """The page shows another picture: the old outcome is that of something else."""
        self._jobs.cancel()
        self.picture, self.outcome, self._at_rest = picture, None, False

    def rested(self, picture: Picture) -> None:
        """Nothing has changed for a moment."""
        self.picture, self._at_rest = picture, True

    def state(self, settings: Settings, answers: Mapping[str, str]) -> State:
        """What a check is asked about: settings, answers by their questions, the pinned run and the exported file."""
        exported = self._exported()
        fresh = None if exported is self._earlier_export else exported
        return State(settings=settings, pinned=self._pinned(), answers=dict(answers), exported=fresh)

    def states(self, lesson: Lesson, answers: Mapping[str, str]) -> States:
        """The states that a text may name; before the first picture what is shown is the lesson's first state."""
        picture = self.picture
        return lesson.states(lesson.start if picture is None else self.state(picture.settings, answers))

    def is_behind(self, answers: Mapping[str, str]) -> bool:
        """Whether something else was opened, answered, pinned or exported while the picture stayed."""
        picture = self.picture
        return picture is not None and self._at_rest and self.state(picture.settings, answers) != self._judged

    def check(self, lesson: Lesson, answers: Mapping[str, str], done: Callable[[], None]) -> None:
        """Check the picture on the page; `done` is called when the outcome is known."""
        if self.picture is None:
            return
        self._judged = state = self.state(self.picture.settings, answers)

        def take(outcome: Outcome) -> None:
            self.outcome = outcome
            done()

        def refuse(reason: str) -> None:
            take(Outcome(math.nan, False, f"The check could not judge this: {reason}"))

        self._jobs.start("the check of the lesson", lambda _progress, _cancelled: lesson.check(state), take, refuse)
