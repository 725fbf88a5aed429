"""`python -m explorer.lessons [FOLDER]`: what every state of every lesson reaches, and what is wrong.

Without a folder it judges the lessons of this package and those of the folder that RANGENAV_LESSONS names.
"""

import sys
from pathlib import Path

from explorer.lessons import judging
from explorer.lessons.course import course, lessons_in


def main(arguments: list[str]) -> int:
    """Print the table and the faults; 1 if there is a fault, else 0."""
    found = lessons_in(Path(arguments[0])) if arguments else course()
    wrong = list(found.complaints)
    sound = []
    for lesson in found.lessons:
        faults = judging.faults(lesson)
        wrong += [f"{lesson.name}: {fault}" for fault in faults]
        if not faults:
            sound.append(lesson)
    if sound:
        print(judging.table(tuple(sound)))
    for sentence in wrong:
        print(sentence)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
