"""The text about a twin, or about why there is none, from the numbers that `search` computes."""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability import blindness

ZERO = 1e-9
"""Components of a unit vector below this are rounding."""
STEADY = 0.01
"""A twin whose distance varies by less than this share has one distance in the text."""
ITS_OWN_TWIN = (
    "no turn or mirror leaves its acceleration alone",
    "the anchor lies in its plane, so its mirror image is the motion itself",
    "the anchor lies on its line, so what is turned about that is the motion itself",
    "it stands at the anchor, so what is turned about that is the motion itself",
)
"""Why there is no exact twin, by the number of directions along which p̈ is zero."""


def mirror(normal: Float[Array, "3"]) -> str:
    """How a mirrored twin is made."""
    return f"the mirror image in the plane through the anchor with normal {along(normal)}"


def turn(vector: Float[Array, "3"]) -> str:
    """How a turned twin is made, by its rotation vector (rad)."""
    angle = float(np.linalg.norm(vector))
    about = f" about {along(vector / angle)}" if angle else ""
    return f"turned by {math.degrees(angle):.3g}°{about} through the anchor"


def displacement(shift: Float[Array, "3"], drift: Float[Array, "3"]) -> str:
    """How a nearby twin is made: Δp (m) and Δv (m/s)."""
    return f"moved by {_numbers(shift)} m and {_numbers(drift)} m/s"


def summary(how: str, *, nearest: float, farthest: float, mismatch: float, same: float) -> str:
    """How a twin is made, its distance and the difference of the ranges (m), which counts as none below `same`."""
    away = f"{nearest:.3g} to {farthest:.3g} m away"
    if farthest - nearest <= STEADY * farthest:
        away = f"{farthest:.3g} m away throughout"
    agreement = "is the same" if mismatch < same else f"differs by at most {mismatch:.2g} m"
    return f"{how}: {away}, and its range {agreement}"


def no_ambiguity(*, apart: float, mismatch: float, tolerance: float) -> str:
    """The best candidate at a distance `apart` (m) exceeds the tolerance (m)."""
    nearest = f"of the motions {apart:g} m (RMS) away, the range of the most similar one differs by {mismatch:.2g} m"
    return f"{nearest}, more than the tolerance of {tolerance:g} m"


def too_near(twin: str, *, apart: float, others: str) -> str:
    """There is a twin, but nearer than `apart` (m)."""
    return f"no twin {apart:g} m away, only this one, {twin}; {others}"


def locally_blind(shift: Float[Array, "3"], *, directions: int, apart: float, later: float, others: str) -> str:
    """The range is constant to first order along `shift`, and yet there is no twin."""
    return (
        f"locally blind, no twin: to first order no range changes with a step along {along(_unit(shift))}, but "
        f"{ITS_OWN_TWIN[directions]}, and {apart:g} m of it changes the range by {later:.2g} m; {others}"
    )


def observable(sensitivity: float, *, others: str) -> str:
    """Every small offset and velocity changes the range. sensitivity: m of range for 1 m of difference, both RMS."""
    least = f"changes the range by {sensitivity:.2g} m (RMS) or more"
    return f"no twin: to first order, every offset and constant velocity of 1 m (RMS) {least}; {others}"


def lever_arm(length: float) -> str:
    """The clause for an antenna that is not at the body's origin: its lever arm has a length (m)."""
    return f"; so it is for an antenna at the body's origin, and here a lever arm of {length:.2g} m is left out"


def along(direction: Float[Array, "3"]) -> str:
    """The name of a line's direction, whose sign does not matter."""
    direction = np.where(np.abs(direction) < ZERO, 0.0, direction)
    return blindness.name(direction if direction[np.argmax(np.abs(direction))] > 0 else -direction)


def _unit(vector: Array) -> Array:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else vector


def _numbers(vector: Array) -> str:
    return "(" + ", ".join(f"{value:z.2g}" for value in vector) + ")"
