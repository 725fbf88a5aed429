"""Axes of a sensor as a signed permutation, written `+y+x-z`: the body's x, y and z in the sensor's axes.

There are 48: 24 rotations by quarter turns, and 24 with a reflection, which a left-handed sensor has.
"""

import itertools
import re
from collections.abc import Iterable

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import require

AS_IT_IS = "+x+y+z"
WRITTEN = re.compile(r"[+-][xyz][+-][xyz][+-][xyz]")


def matrix(text: str) -> Float[Array, "3 3"]:
    """The matrix A of body = A sensor. Raises ValueError for a text that is no signed permutation."""
    rule = f"axes must name x, y and z with their signs, as +y+x-z does, got {text!r}"
    require(WRITTEN.fullmatch(text) is not None and {*text[1::2]} == {*"xyz"}, rule)
    turn = np.zeros((3, 3))
    for row, (sign, axis) in enumerate(zip(text[::2], text[1::2], strict=True)):
        turn[row, "xyz".index(axis)] = 1.0 if sign == "+" else -1.0
    return turn


EVERY: tuple[str, ...] = tuple(
    "".join(sign + axis for sign, axis in zip(signs, order, strict=True))
    for order in itertools.permutations("xyz")
    for signs in itertools.product("+-", repeat=3)
)
"""All 48, the first of which is the identity."""
MATRICES: Float[Array, "48 3 3"] = np.array([matrix(text) for text in EVERY])
ROTATIONS = tuple(k for k, turn in enumerate(MATRICES) if np.linalg.det(turn) > 0)
REFLECTIONS = tuple(k for k, turn in enumerate(MATRICES) if np.linalg.det(turn) < 0)
"""Places in EVERY of the 24 rotations, the first of which is the identity, and of the 24 others."""


def simplest(places: Iterable[int]) -> str:
    """Of axes that explain a record equally well, a rotation that leaves as many axes as they are as it can."""
    return EVERY[max(places, key=lambda k: (k in ROTATIONS, float(np.trace(MATRICES[k])), -k))]


def handedness(text: str) -> str:
    """A clause on axes that are a reflection of the body's; empty for a rotation."""
    return ", which is left-handed" if np.linalg.det(matrix(text)) < 0 else ""
