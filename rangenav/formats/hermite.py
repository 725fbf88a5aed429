"""Pieces of degree 7 through position, velocity, acceleration and jerk at their knots: C³, with what that costs.

Without jerk the pieces have degree 5 and are C².

On the unit interval c_j = d_j/j! for j < 4, and the upper four solve Σ_j j!/(j − k)! c_j = what the right end still
lacks of its k-th derivative. With knots h apart the position is off by h⁸ p⁽⁸⁾/(2⁸ 8!): a third of the fastest turn is
good to a tenth of a millimetre on a one-metre path; rounding ε of the data becomes 840 ε/h⁴ in the snap.
"""

import math
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import Piece, Polynomials
from rangenav.signals.polynomials import ZERO, Coefficients

DEGREE = 7


@lru_cache
def _weights(given: int) -> tuple[Float[Array, "g"], Float[Array, "g g"], Float[Array, "g g"]]:
    """Factorials, derivatives of the lower powers at 1, and the inverse of those of the upper powers."""
    lower = np.array([[math.perm(j, k) for j in range(given)] for k in range(given)], dtype=float)
    upper = np.array([[math.perm(j, k) for j in range(given, 2 * given)] for k in range(given)], dtype=float)
    return np.array([math.factorial(j) for j in range(given)], dtype=float), lower, np.linalg.inv(upper)


def coefficients(knots: Float[Array, "k"], derivatives: Float[Array, "k g c"]) -> Float[Array, "m 8 c"]:
    """Ascending coefficients of every piece in local time, from derivatives 0 to g − 1 ≤ 3 at the knots (s)."""
    given = derivatives.shape[1]
    factorials, below, inverse = _weights(given)
    h = np.diff(knots)[:, None, None]
    scale = h ** np.arange(given)[:, None]
    left, right = derivatives[:-1] * scale, derivatives[1:] * scale
    lower = left / factorials[:, None]
    upper = inverse @ (right - below @ lower)
    table = np.concatenate([lower, upper], axis=1) / h ** np.arange(2 * given)[:, None]
    return np.pad(table, ((0, 0), (0, DEGREE + 1 - 2 * given), (0, 0)))


def polynomials(
    knots: Float[Array, "k"], derivatives: Float[Array, "k g 3"], *, yaw: Float[Array, "k 4"] | None = None
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
