"""What a teacher takes from the course: the answers to all predictions, and a worksheet to print."""

from collections.abc import Callable, Sequence

from explorer.lessons import teaching
from explorer.lessons.lesson import Lesson
from explorer.model.jobs import Jobs
from explorer.storage.bundle import Send


class ForTeachers:
    """The answers, once somebody has asked for them. The figures of all lessons take a second the first time."""

    def __init__(self, jobs: Jobs, lessons: Sequence[Lesson], send: Send) -> None:
        """send downloads a file: its name and its content."""
        self._jobs, self._lessons, self._send = jobs, tuple(lessons), send
        self.guide: list[tuple[str, ...]] = []
        """The rows of the table of answers; empty until they were asked for."""

    def answers(self, done: Callable[[], None], refused: Callable[[str], None]) -> None:
        """Compute the answers."""

        def take(guide: list[tuple[str, ...]]) -> None:
            self.guide = guide
            done()

        self._jobs.start("the answers", lambda *_: teaching.guide(self._lessons), take, refused)

    def worksheet(self, refused: Callable[[str], None]) -> None:
        """Make and download the worksheet."""

        def take(content: bytes) -> None:
            self._send("worksheet.html", content)

        self._jobs.start("the worksheet", lambda *_: teaching.worksheet(self._lessons), take, refused)
