"""A lesson: a question, a prediction to commit, something to do, and a check by machine."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

from explorer.lessons import state as states
from explorer.lessons.state import Outcome, State
from rangenav.inputs import Input, require
from rangenav.number_format import NEVER, quantity

MAX_TITLE = 60
MISSING = "–"
MAX_CASES = 9
SEPARATOR = " / "
"""Between the tab, the folders and the label of a control."""
FIGURE = re.compile(r"\{(?:([a-z][a-z0-9-]*)\.)?([a-z][a-z0-9_]*)\}")
"""A number that the page computes: `{mu}` of what is shown, `{start.mu}` of the lesson's first state, `{case-1.mu}` of
its first case."""


class Prediction(Input, frozen=True, kw_only=True):
    """A question that is answered before the lesson shows what happens: one of some choices, or a number."""

    question: str
    choices: tuple[str, ...] = ()
    """Empty if the answer is a number."""
    right: int = 0
    """Which choice came true, from 1."""
    unit: str = ""
    figure: str = ""
    """The figure that holds the true number, such as `start.sigma`; it is shown next to the prediction."""
    because: str
    """Why this is the outcome, in one or two sentences."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.choices:
            require(len(self.choices) >= 2, "prediction: choices must be two or more")
            require(
                1 <= self.right <= len(self.choices),
                f"prediction: right must name one of the {len(self.choices)} choices",
            )
        else:
            require(
                bool(FIGURE.fullmatch(f"{{{self.figure}}}")), "prediction: a number needs a figure, such as start.mu"
            )


class Answer(Input, frozen=True, kw_only=True):
    """A question of the task itself, whose answer the check judges."""

    name: str
    question: str
    choices: tuple[str, ...]


class Goal(Input, frozen=True, kw_only=True):
    """What the check's metric must reach, for the bar beside the task."""

    label: str
    """What the metric is, a noun."""
    unit: str = ""
    value: float
    at_least: bool = True
    """False: the metric must not exceed the value."""
    log: bool = False
    """Whether the bar counts decades."""

    @property
    def wanted(self) -> str:
        """The goal as text: at least 100 m²/s⁷."""
        return f"{'at least' if self.at_least else 'at most'} {quantity(self.value, self.unit)}"

    def reading(self, metric: float) -> str:
        """A metric as text: a time that was not reached is “never”, and where there is no number yet a dash."""
        if math.isinf(metric) and self.unit == "s":
            return NEVER
        return quantity(metric, self.unit) if math.isfinite(metric) else MISSING


class Header(Input, frozen=True, kw_only=True):
    """The front matter of lesson.md."""

    title: str
    minutes: float
    needs: str
    """What a student should know, in a few words."""
    controls: tuple[str, ...]
    """The controls that the lesson uses, in their order: `Gains / attitude gain k1 (1/s)`.

    Where a tab has several controls of one label, the beginning of the label of a folder tells them apart:
    `Motion / z: / frequency ω (rad/s)`."""
    plots: tuple[str, ...] = ()
    """The plots that show what happens."""
    prediction: Prediction
    answers: tuple[Answer, ...] = ()
    cases: tuple[str, ...] = ()
    """What the states case-1.toml, case-2.toml, … are called, for a lesson that compares or searches several runs."""
    goal: Goal
    hints: tuple[str, str, str]
    """From a small push to nearly the whole solution."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(0 < len(self.title.strip()) <= MAX_TITLE, f"title must have 1 to {MAX_TITLE} characters")
        require(0 < self.minutes <= 60, f"minutes must lie between 0 and 60, got {self.minutes:g}")
        require(all(hint.strip() for hint in self.hints), "hints must not be empty")
        for control in self.controls:
            require(SEPARATOR in control, f"controls are named like “Motion / path made of”, got “{control}”")
        require(len(self.cases) <= MAX_CASES, f"at most {MAX_CASES} cases, got {len(self.cases)}")

    @property
    def places(self) -> tuple["Place", ...]:
        """Where each of the controls is."""
        parts = (control.split(SEPARATOR) for control in self.controls)
        return tuple(Place(tab, tuple(folders), label) for tab, *folders, label in parts)


class Place(NamedTuple):
    """Where a control is on the page."""

    tab: str
    folders: tuple[str, ...]
    """Beginnings of the labels of folders around it, the outermost first; empty if the first such control is meant."""
    label: str

    def holds(self, steps: Sequence[tuple[str, str]], label: str) -> bool:
        """Whether it is the place of a control of that label, inside tabs and folders, as ("tab", "Motion")."""
        if label != self.label or ("tab", self.tab) not in steps:
            return False
        around = iter(name for kind, name in steps if kind == "folder")
        return all(any(name.startswith(beginning) for name in around) for beginning in self.folders)


SectionName = Literal["Question", "Explanation", "Task", "What you see", "Insight"]
SECTIONS: tuple[SectionName, ...] = ("Question", "Explanation", "Task", "What you see", "Insight")
"""In this order. Question and explanation may be read without touching anything; the insight is shown at the end."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Lesson:
    """One lesson, read from its folder."""

    name: str
    """The name of its folder, `01-one-range`."""
    folder: Path
    header: Header
    sections: dict[SectionName, tuple[str, ...]]
    """The screens of each section, in Markdown; one idea a screen."""
    start: State
    solved: State
    cases: tuple[State, ...] = ()
    """The states of the cases that the header names."""
    check: Callable[[State], Outcome]
    """A pure function. An error inside it becomes a sentence of its outcome."""

    @property
    def number(self) -> int:
        """The number before its name."""
        return int(self.name.split("-", 1)[0])

    def failing(self) -> tuple[State, ...]:
        """States that look like a solution and do not pass; tests and the teacher's page use them."""
        return tuple(states.read(self.folder / f"failing-{k}.toml") for k in (1, 2))

    def states(self, shown: State) -> dict[str, State | None]:
        """Every state that a figure of the text may name, by the word before its dot; "" is what is shown."""
        pinned = None if shown.pinned is None else State(settings=shown.pinned)
        cases = {f"case-{k}": case for k, case in enumerate(self.cases, 1)}
        return {"": shown, "start": self.start, "solved": self.solved, "pinned": pinned, **cases}
