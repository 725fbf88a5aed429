"""What a class shares while it lasts: what the teacher shows, what the teacher asks of all, and where each student is.

teacher   show(…)  freeze(…)  send(…)           changes it, and wakes the sessions of all
students  state, report(…)                      read it in their own loops, and say where they are
Nothing of it is written to a file. Safe for threads.
"""

import csv
import io
import threading
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from explorer.model.listeners import Listener, Listeners
from explorer.model.settings import Settings
from rangenav.inputs import Vec3

RETURN = 20.0
"""s within which a page that presents may be loaded again, and the presentation goes on."""
MAX_NAME = 24
"""Characters of a name that a student chooses."""


@dataclass(frozen=True, kw_only=True)
class Camera:
    """From where the scene is seen (m, inertial frame)."""

    position: Vec3
    look_at: Vec3


@dataclass(frozen=True, kw_only=True)
class Shown:
    """What the teacher's page shows."""

    settings: Settings
    time: float
    """s, of the playhead at the moment `at`."""
    at: float
    """s, monotonic."""
    playing: bool
    speed: float
    loop: bool
    camera: Camera | None
    control: str
    """The label of the control that the teacher moved last; empty if there is none."""


@dataclass(frozen=True, kw_only=True)
class Request:
    """What the teacher asks of every student's page, once."""

    number: int
    """Counts from 1: a page does each request once."""
    settings: Settings | None = None
    lesson: int | None = None


@dataclass(frozen=True, kw_only=True)
class Member:
    """What one student's page has said of itself."""

    name: str
    following: bool = False
    copies: bool = False
    """Whether the page shows a copy of what the teacher showed."""
    lesson: str = ""
    """The title of the open lesson; empty while the list is shown."""
    screen: int = 0
    screens: int = 0
    """How many the open lesson has."""
    predictions: Mapping[str, str] = field(default_factory=dict)
    """What was predicted, by the titles of the lessons."""
    passed: frozenset[str] = frozenset()
    """The titles of the lessons that were passed."""


@dataclass(frozen=True, kw_only=True)
class State:
    """What the sessions of students read."""

    shown: Shown | None = None
    """None while the teacher does not present."""
    frozen: bool = False
    """Whether all pages show nothing but what the teacher shows."""
    request: Request | None = None
    """The newest request; who comes later does it, too."""
    left: float | None = None
    """When (s, monotonic) the page that presents was closed, as by a reload; None while it is open."""
    answers_wait: bool = False
    """Whether no page goes on from a committed prediction, so that the class can discuss it first."""


class Classroom:
    """One class, from the start of the page, or the end of the class before, to its own end."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._state = State()
        self._requests = 0
        self._members: dict[int, Member] = {}
        self._done: dict[int, int] = {}
        """The newest request that each student's page has done."""
        self._listeners = Listeners()

    @property
    def state(self) -> State:
        """What students' pages follow now."""
        return self._state

    @property
    def members(self) -> dict[int, Member]:
        """The students by the numbers of the visitors, in the order of coming in."""
        with self._lock:
            return dict(sorted(self._members.items()))

    def listen(self, listener: Listener) -> Listener:
        """Have a listener called after every change. Returns a function that ends this."""
        return self._listeners.add(listener)

    def show(self, shown: Shown | None) -> None:
        """Show what the teacher's page shows; None ends the presentation, and lets frozen pages go."""
        self._change(lambda state: replace(state, shown=shown, frozen=state.frozen and shown is not None, left=None))

    def leave(self, now: float) -> None:
        """The page that presents was closed at a time (s, monotonic): what it showed stays for `RETURN` s."""
        self._change(lambda state: replace(state, left=now if state.shown is not None else None))

    def end_if_left(self, now: float) -> None:
        """End the presentation if its page was closed, and no other has gone on with it in time."""
        left = self._state.left
        if left is not None and now - left >= RETURN:
            self.show(None)

    def freeze(self, frozen: bool) -> None:
        """Have all pages show what the teacher shows and take no input, or let them go."""
        self._change(lambda state: replace(state, frozen=frozen and state.shown is not None))

    def hold_answers(self, wait: bool) -> None:
        """Have all pages wait at a committed prediction, or let them go on to its answer."""
        self._change(lambda state: replace(state, answers_wait=wait))

    def send(self, *, settings: Settings | None = None, lesson: int | None = None) -> None:
        """Have every student's page open these settings, or a lesson, as a step that undo takes back."""
        self._requests += 1
        request = Request(number=self._requests, settings=settings, lesson=lesson)
        self._change(lambda state: replace(state, request=request))

    def take_request(self, student: int) -> Request | None:
        """The newest request, if this student's page has not done it yet."""
        with self._lock:
            request = self._state.request
            if request is None or self._done.get(student, 0) >= request.number:
                return None
            self._done[student] = request.number
            return request

    def report(self, number: int, member: Member) -> None:
        """Take what a student's page says of itself."""
        with self._lock:
            same = self._members.get(number) == member
            self._members[number] = member
        if not same:
            self._listeners.call()

    def forget(self, number: int) -> None:
        """Forget one student, who was sent out."""
        with self._lock:
            self._members.pop(number, None)
            self._done.pop(number, None)
        self._listeners.call()

    def clear(self) -> None:
        """Forget all students and what was shown: the class is over."""
        with self._lock:
            self._members.clear()
            self._done.clear()
        self._change(lambda _: State())

    def _change(self, change: Callable[[State], State]) -> None:
        with self._lock:
            self._state = change(self._state)
        self._listeners.call()


def histogram(members: Mapping[int, Member], lesson: str) -> dict[str, int]:
    """How often each prediction was made in a lesson, the most frequent first."""
    made = Counter(member.predictions[lesson] for member in members.values() if lesson in member.predictions)
    return dict(sorted(made.items(), key=lambda pair: (-pair[1], pair[0])))


def results(members: Mapping[int, Member], lessons: Mapping[int, str]) -> bytes:
    """A table for spreadsheets: a row for each student, and for each lesson the prediction and whether it was passed.

    lessons: titles by numbers."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["student", *(f"{n} {kind}" for n in lessons for kind in ("prediction", "passed"))])
    for member in members.values():
        row = [member.name]
        for title in lessons.values():
            row += [member.predictions.get(title, ""), "yes" if title in member.passed else ""]
        table.writerow([as_text(cell) for cell in row])
    return text.getvalue().encode()


def as_text(cell: str) -> str:
    """A cell that no spreadsheet takes for a formula: students choose their names."""
    return f"'{cell}" if cell[:1] in ("=", "+", "-", "@", "\t") else cell


def chosen_name(text: str) -> str:
    """A name as it was typed, on one line. Raises ValueError if it is too long."""
    name: str = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    if len(name) > MAX_NAME:
        raise ValueError(f"your name: at most {MAX_NAME} characters, got {len(name)}")
    return name
