"""Where a handle is held. Of what a browser says only this is believed: three finite numbers within 100 km."""

import math
from dataclasses import dataclass
from typing import Any, Literal

from rangenav.inputs import Vec3

MAX_REACH = 1e5
"""m from the origin, along each axis."""
HandleKind = Literal["anchor", "waypoint"]


@dataclass(frozen=True, kw_only=True)
class Grab:
    """Where a handle has been moved to."""

    kind: HandleKind
    index: int
    """Of the waypoint, from 0."""
    position: Vec3
    """m, inertial frame."""
    done: bool
    """It has been let go."""


@dataclass(eq=False)
class Grip:
    """A handle is held, from the press until its end has been taken."""

    home: Vec3
    """Where the handle was."""
    start: Any
    """Where the pointer took hold of it."""
    latest: Any = None
    """Where the pointer is now; as the browser says, unchecked."""
    news: bool = False
    done: bool = False
    good: Vec3 | None = None
    """The last place that was one."""


def place(grip: Grip, latest: Any, step: float) -> Vec3 | None:
    """Where a handle is held, None if that is no place. A coordinate that has not moved stays as it is, to the last
    digit; one that has is rounded."""
    start = grip.home if grip.start is None else grip.start
    if not (is_place(start) and is_place(latest)):
        return None
    moved = [
        a if abs(c - b) < step / 2 else round(a + c - b, round(-math.log10(step)))
        for a, b, c in zip(grip.home, start, latest, strict=True)
    ]
    return (moved[0], moved[1], moved[2]) if is_place(moved) else None


def is_place(sent: Any) -> bool:
    """Whether this is three finite numbers within reach."""
    return (
        isinstance(sent, tuple | list)
        and len(sent) == 3
        and all(isinstance(entry, float | int) for entry in sent)
        and all(abs(entry) <= MAX_REACH for entry in sent)  # false for NaN
    )
