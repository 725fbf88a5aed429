"""Every lesson in order: those in this folder, and those of a teacher's own folder."""

import os
from dataclasses import dataclass
from pathlib import Path

from explorer.lessons import reading
from explorer.lessons.lesson import Lesson

FOLDERS_VARIABLE = "RANGENAV_LESSONS"
"""The environment variable that names a teacher's folder of lessons."""
OURS = Path(__file__).parent


@dataclass(frozen=True, eq=False)
class Course:
    """The lessons that could be read, and why others could not."""

    lessons: tuple[Lesson, ...]
    complaints: tuple[str, ...] = ()

    def lesson(self, number: int) -> Lesson | None:
        """The lesson of that number; ours, if a teacher has used the number too."""
        return next((lesson for lesson in self.lessons if lesson.number == number), None)


def course(more: Path | None = None) -> Course:
    """Our lessons, then those in the folder `more`, or else in the one that RANGENAV_LESSONS names."""
    named = os.environ.get(FOLDERS_VARIABLE, "")
    folder = more or (Path(named) if named else None)
    lessons, complaints = _lessons(OURS)
    if folder is not None:
        if not folder.is_dir():
            return Course(lessons, (*complaints, f"{folder}: no such folder of lessons"))
        others, reasons = _lessons(folder)
        lessons, complaints = lessons + others, complaints + reasons
    return Course(lessons, complaints)


def _lessons(folder: Path) -> tuple[tuple[Lesson, ...], tuple[str, ...]]:
    lessons, complaints = [], []
    for one in sorted(folder.iterdir()):
        if reading.NAME.fullmatch(one.name) or (one / "lesson.md").is_file():
            try:
                lessons.append(reading.read(one))
            except ValueError as error:
                complaints.append(str(error))
    return tuple(lessons), tuple(complaints)
