"""Turns and mirrors about the anchor that change no accelerometer reading: orthogonal O with O p̈(s) = p̈(s) throughout.

Then q' = O q, q = p − p_anchor, has the same range and the same p̈. How many directions n have n·p̈ ≡ 0 decides:
    3 (hover, line)      every turn about the anchor
    2 (along one line)   turns about that line's direction, through the anchor
    1 (planar, helix)    the mirror q − 2(n·q)n
    0                    nothing but the identity
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability import windows
from rangenav.signals import Signal

NODES = 128
"""Times over a flight, spread unevenly (by the golden ratio) so that no tone is zero at all of them."""
GOLDEN = (math.sqrt(5) - 1) / 2
STRAIGHT, FLAT = 1e-9, 1e-12
"""m that p̈ along a direction bends the path over the flight, or its share of the largest: below them it is rounding."""


def moments(duration: float) -> Float[Array, "k"]:
    """The NODES times (s) at which a flight is sampled, increasing."""
    return np.sort((np.arange(NODES) + 0.5) * GOLDEN % 1.0) * duration


def unaccelerated(path: Signal, duration: float) -> Float[Array, "m 3"]:
    """An orthonormal basis of the directions n with n·p̈ ≡ 0 over a flight of `duration` (s).

    Raises ValueError for a path that is no signal, or a duration that is not positive.
    """
    windows.checked_one(path, 0.0, duration)
    _, singular, right = np.linalg.svd(path(moments(duration), 2) / math.sqrt(NODES), full_matrices=False)
    rounding = max(STRAIGHT * 2 / duration**2, FLAT * float(singular[0]))
    return right[singular <= rounding]


def mirror(normal: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """The reflection across a unit normal."""
    return np.eye(3) - 2 * np.outer(normal, normal)


def allowed(turn: Float[Array, "3"], directions: Float[Array, "m 3"]) -> Float[Array, "3"]:
    """The part of a turn (rad, a rotation vector) that changes no accelerometer reading; from `unaccelerated`."""
    if len(directions) == 3:
        return turn
    if len(directions) < 2:
        return np.zeros(3)
    axis = np.cross(*directions)
    return (axis @ turn) * axis


def axes(
    velocity: Float[Array, "3"], up: Float[Array, "3"], directions: Float[Array, "m 3"]
) -> list[Float[Array, "3"]]:
    """Axes of allowed turns. If all are allowed: the velocity (lines stay parallel), the vertical, two level axes."""
    if len(directions) < 3:
        return [np.cross(*directions)]
    speed = float(np.linalg.norm(velocity))
    level = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    level /= np.linalg.norm(level)
    return [*([velocity / speed] if speed > 0 else []), up, level, np.cross(up, level)]


def turn_towards(
    here: Float[Array, "3"], there: Float[Array, "3"], directions: Float[Array, "m 3"]
) -> Float[Array, "3"]:
    """The allowed turn (rad) that brings one point (relative to the anchor) as near as possible to another."""
    if len(directions) == 3:
        axis = np.cross(here, there)
        if not axis @ axis > 0:  # the same way, or the opposite one about any level axis
            axis = np.cross(here, np.eye(3)[int(np.argmin(np.abs(here)))])
    else:
        axis = allowed(np.ones(3), directions) if len(directions) < 2 else np.cross(*directions)
    length = float(np.linalg.norm(axis))
    if not length > 0:
        return np.zeros(3)
    axis = axis / length
    across = float(here @ there - (axis @ here) * (axis @ there))
    return axis * math.atan2(float(axis @ np.cross(here, there)), across)
