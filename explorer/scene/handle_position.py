"""The position of a dragged handle: position = origin + (pointer now − pointer at the press), for each axis.

A browser may send anything. A position is accepted only if it is three finite numbers within 100 km of the origin.
"""

import math
from dataclasses import dataclass
from typing import Any, Literal

from rangenav.inputs import Vec3

MAX_REACH = 1e5
"""m from the origin, along each axis."""
HandleKind = Literal["anchor", "waypoint"]


@dataclass(frozen=True, kw_only=True)
class HandleMove:
    """A handle was moved to a position."""

    kind: HandleKind
    index: int
    """The index of the waypoint, from 0."""
    position: Vec3
    """m, inertial frame."""
    done: bool
    """Whether the visitor has released the handle."""


@dataclass(eq=False)
class Drag:
    """A drag in progress, from the press until the session has taken the release."""

    origin: Vec3
    """m; the position of the handle at the press."""
    start: Any
    """The position of the pointer at the press, unchecked; None when the gizmo moves the handle."""
    latest: Any = None
    """The latest position of the pointer, unchecked."""
    moved: bool = False
    """Whether `latest` is newer than the last `take_moves`."""
    done: bool = False
    last_valid: Vec3 | None = None
    """m; the last position that was accepted."""


def dragged_position(drag: Drag, latest: Any, step: float) -> Vec3 | None:
    """The handle's position (m) for a pointer at `latest`; None if that is no position.

    A coordinate that has moved by less than half a `step` (m) keeps all its digits; any other is rounded to `step`.
    """
    start = drag.origin if drag.start is None else drag.start
    if not (is_position(start) and is_position(latest)):
        return None
    moved = [
        a if abs(c - b) < step / 2 else round(a + c - b, round(-math.log10(step)))
        for a, b, c in zip(drag.origin, start, latest, strict=True)
    ]
    return (moved[0], moved[1], moved[2]) if is_position(moved) else None


def is_position(value: Any) -> bool:
    """Whether a value from the browser is three finite numbers within reach."""
    return (
        isinstance(value, tuple | list)
        and len(value) == 3
        and all(isinstance(entry, float | int) for entry in value)
        and all(abs(entry) <= MAX_REACH for entry in value)  # false for NaN
    )
