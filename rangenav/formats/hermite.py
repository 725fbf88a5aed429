"""Pieces of degree 7 through position, velocity, acceleration and jerk at their knots: C³, with what that costs.

On the unit interval c_j = d_j/j! for j < 4, and the upper four solve Σ_j j!/(j − k)! c_j = what the right end still
lacks of its k-th derivative. With knots h apart the position is off by h⁸ p⁽⁸⁾/(2⁸ 8!): a third of the fastest turn is
good to a tenth of a millimetre on a one-metre path; rounding ε of the data becomes 840 ε/h⁴ in the snap.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import Piece, Polynomials
from rangenav.signals.polynomials import ZERO, Coefficients

GIVEN = 4
"""Position to jerk."""
DEGREE = 7
ROWS = np.array([[math.perm(j, k) for j in range(GIVEN, DEGREE + 1)] for k in range(GIVEN)], dtype=float)
BELOW = np.array([[math.perm(j, k) for j in range(GIVEN)] for k in range(GIVEN)], dtype=float)
UPPER = np.linalg.inv(ROWS)
FACTORIALS = np.array([math.factorial(j) for j in range(GIVEN)], dtype=float)


def coefficients(knots: Float[Array, "k"], derivatives: Float[Array, "k 4 c"]) -> Float[Array, "m 8 c"]:
    """Ascending coefficients of every piece in local time, from derivatives 0 to 3 at the knots (s)."""
    h = np.diff(knots)[:, None, None]
    scale = h ** np.arange(GIVEN)[:, None]
    left, right = derivatives[:-1] * scale, derivatives[1:] * scale
    lower = left / FACTORIALS[:, None]
    upper = UPPER @ (right - BELOW @ lower)
    return np.concatenate([lower, upper], axis=1) / h ** np.arange(DEGREE + 1)[:, None]


def polynomials(
    knots: Float[Array, "k"], derivatives: Float[Array, "k 4 3"], *, yaw: Float[Array, "k 4"] | None = None
) -> Polynomials:
    """The pieces as a signal that begins at t = 0; yaw (rad) is kept for the file."""
    table = coefficients(knots, derivatives)
    turn = None if yaw is None else coefficients(knots, yaw[:, :, None])[..., 0]
    pieces = []
    for k, (duration, piece) in enumerate(zip(np.diff(knots), table, strict=True)):
        x, y, z = (_eight(piece[:, axis]) for axis in range(3))
        pieces.append(Piece(duration=float(duration), x=x, y=y, z=z, yaw=ZERO if turn is None else _eight(turn[k])))
    return Polynomials(pieces=tuple(pieces))


def _eight(values: Float[Array, "8"]) -> Coefficients:
    a, b, c, d, e, f, g, h = values.tolist()
    return a, b, c, d, e, f, g, h
