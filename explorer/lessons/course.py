"""Every lesson in order: those in this folder, and those of a teacher's own folder."""

import os
from dataclasses import dataclass
from functools import lru_cache
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
    return _course(more or (Path(named) if named else None))


@lru_cache(maxsize=4)
def _course(folder: Path | None) -> Course:
    """Read once for all visitors: a lesson that is changed meanwhile is seen after the program has begun anew."""
    ours = lessons_in(OURS)
    if folder is None:
        return ours
    others = lessons_in(folder)
    return Course(ours.lessons + others.lessons, ours.complaints + others.complaints)


def lessons_in(folder: Path) -> Course:
    """The lessons of one folder, in the order of their names."""
    lessons, complaints = [], []
    try:
        folders = sorted(one for one in folder.iterdir() if one.is_dir())
    except OSError as error:
        return Course((), (f"{folder}: no folder of lessons: {error.strerror}",))
    for one in folders:
        if reading.NAME.fullmatch(one.name) or (one / "lesson.md").is_file():
            try:
                lessons.append(reading.read(one))
            except ValueError as error:
                complaints.append(str(error))
    return Course(tuple(lessons), tuple(complaints))
