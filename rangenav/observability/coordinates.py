"""The change of coordinates M of `gramian_rank`, whose columns keep what polynomials leave of the 13 functions.

    [L₀ … L₃ | Pᵢ, u Pᵢ + k₄ᵢ L₄, u² Pᵢ + d₄ᵢ L₄ + d₅ᵢ L₅] M = [1, τ, τ²/2, τ³/6, Dᵢ, τDᵢ, ½τ²Dᵢ],  D = P + Σ₀³ Kₖ Lₖ(u)

M is block triangular. Only its block of the polynomials by the unknowns differs from window to window, and it is linear
in K. So is that of M⁻¹. M can be inverted for every K.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability.cubic_fit import CUBIC
from rangenav.observability.rows import Moment
from rangenav.results import result

UNKNOWNS = 9
"""The coordinates besides the polynomials: position, velocity, gravity."""
STATES = CUBIC + UNKNOWNS
TIMES_U = np.diag([(k + 1) / (2 * k + 1) for k in range(CUBIC + 1)], -1)
TIMES_U += np.diag([k / (2 * k + 1) for k in range(1, CUBIC + 2)], 1)
"""u Lₖ = ((k + 1) Lₖ₊₁ + k Lₖ₋₁)/(2k + 1), on coefficients of L₀ … L₅."""
TIMES_U_TWICE = (TIMES_U @ TIMES_U)[:, :CUBIC]


@result
class Coordinates:
    """What M and its inverse have in common in all windows, and their blocks for K = 1 in each place."""

    columns: Float[Array, "13 13"]
    states: Float[Array, "13 13"]
    columns_of_departure: Float[Array, "12 36"]
    states_of_departure: Float[Array, "12 36"]


def of(moment: Moment, turn: Float[Array, "3 3"]) -> Coordinates:
    """Those of states at the windows' starts or ends, in axes turned by `turn`."""
    return _of(1.0 if moment == "start" else -1.0, turn.tobytes())


@lru_cache(maxsize=16)
def _of(s: float, turn: bytes) -> Coordinates:
    """s: 1 at the starts, −1 at the ends."""
    shift = (TIMES_U + s * np.eye(CUBIC + 2)) / 2  # the matrix of τ/δ
    powers = [np.eye(CUBIC + 2)[0]]
    for k in (1, 2, 3):
        powers.append(shift @ powers[-1] / k)
    scalars = np.linalg.inv(np.stack(powers, axis=1)[:CUBIC])
    unpowered = np.linalg.inv(np.kron(_powers(s), np.eye(3)))
    unknown_states = np.linalg.inv(np.kron(_powers(s), np.frombuffer(turn).reshape(3, 3)))
    unknowns = np.linalg.inv(unknown_states)
    K = np.zeros((3 * CUBIC, CUBIC + 2, 3))
    K[:, :CUBIC] = np.eye(3 * CUBIC).reshape(-1, CUBIC, 3)
    of_unknowns = np.concatenate([K, shift @ K, shift @ shift @ K / 2], axis=2)[:, :CUBIC]  # in D, τD and ½τ²D
    return Coordinates(
        columns=_diagonal(np.linalg.inv(scalars), unknowns),
        states=_diagonal(scalars, unknown_states),
        columns_of_departure=(of_unknowns @ (unpowered @ unknowns)).reshape(len(K), -1),
        states_of_departure=(-scalars @ of_unknowns @ unpowered).reshape(len(K), -1),
    )


def _diagonal(scalars: Float[Array, "4 4"], unknowns: Float[Array, "9 9"]) -> Float[Array, "13 13"]:
    matrix = np.zeros((STATES, STATES))
    matrix[:CUBIC, :CUBIC], matrix[CUBIC:, CUBIC:] = scalars, unknowns
    matrix.flags.writeable = False
    return matrix


def _powers(s: float) -> Float[Array, "3 3"]:
    """1, τ/δ and ½(τ/δ)² in powers of u: τ/δ = (u + s)/2."""
    return np.array([[1.0, s / 2, s * s / 8], [0.0, 0.5, s / 4], [0.0, 0.0, 0.125]])
