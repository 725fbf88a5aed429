"""The screens of a lesson in the order in which they are read.

    question → prediction → explanation → task → what you see → insight

A screen holds one idea. The prediction is committed before anything is shown that answers it.
"""

from dataclasses import dataclass
from typing import Literal

from explorer.lessons.lesson import Lesson, SectionName

Kind = Literal["text", "prediction", "task", "outcome"]
KINDS: dict[SectionName, Kind] = {
    "Question": "text",
    "Explanation": "text",
    "Task": "task",
    "What you see": "outcome",
    "Insight": "text",
}


@dataclass(frozen=True)
class Screen:
    """One screen: the heading of its section, and its Markdown; a prediction has none."""

    kind: Kind
    heading: str
    markdown: str = ""


def screens(lesson: Lesson) -> tuple[Screen, ...]:
    """All screens of a lesson."""
    pages: list[Screen] = []
    for name, texts in lesson.sections.items():
        pages += [Screen(KINDS[name], name, text) for text in texts]
        if name == "Question":
            pages.append(Screen("prediction", "Your prediction"))
    return tuple(pages)


def shown(lesson: Lesson, number: int) -> tuple[Screen, int, int]:
    """The screen of a number, its number, and how many there are; beyond the last one it is the last."""
    pages = screens(lesson)
    k = min(number, len(pages) - 1)
    return pages[k], k, len(pages)
