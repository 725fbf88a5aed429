"""Piecewise polynomials in local time: evaluation at any order, jumps at knots, and bounds that are not samples.

At a knot the piece that begins there counts, at the end the last piece: derivatives are one-sided. A piece lies inside
the hull of its Bernstein coefficients, so the largest norm of a coefficient bounds the piece at every t.
"""

import math
from functools import lru_cache

import numpy as np
import scipy
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.results import result

JUMP_ORDERS = range(5)
"""C⁰ to C⁴: position to snap."""
JUMP_ROUNDING = 1e-9
"""Relative to the bound of the pieces: smaller jumps are rounding of a fit, larger jumps are in the data."""
CHUNK = 4096
"""Times evaluated together: all coefficients of that many pieces, a megabyte, stay in the cache."""


@result
class Pieces:
    """m polynomials Σ c_j (t − knot)ʲ, one after the other."""

    knots: Float[Array, "k"]
    """s, m + 1 of them, increasing."""
    tables: tuple[Float[Array, "_ m 3"], ...]
    """Ascending coefficients of each derivative: tables[order][j, piece]."""
    repeats: bool
    """Whether the curve begins anew after its end; else it is constant before the first knot and after the last."""

    @property
    def duration(self) -> float:
        """From the first knot to the last (s)."""
        return float(self.knots[-1] - self.knots[0])


def pieces(knots: Float[Array, "k"], coefficients: Float[Array, "d m 3"], *, repeats: bool) -> Pieces:
    """Pieces from the ascending coefficients of the signal itself."""
    tables = [np.ascontiguousarray(coefficients)]
    while len(tables[-1]) > 1:
        tables.append(tables[-1][1:] * np.arange(1, len(tables[-1]))[:, None, None])
    return Pieces(knots=knots, tables=tuple(tables), repeats=repeats)


def evaluate(curve: Pieces, t: Float[Array, "*n"], order: int) -> Float[Array, "*n 3"]:
    """The derivative of the given order at times t (s)."""
    t = np.asarray(t, dtype=float)
    if order >= len(curve.tables):
        return np.zeros((*t.shape, 3))
    table = _axes_first(curve.tables[order])  # times last: three long rows are added up, not many rows of three
    flat = t.ravel()
    every = np.empty((len(flat), 3))
    for first in range(0, len(flat), CHUNK):
        time = flat[first : first + CHUNK]
        piece, local = _place(curve, time)
        value = table[-1].take(piece, axis=1)
        term = np.empty_like(value)
        for coefficient in table[-2::-1]:
            value *= local
            value += coefficient.take(piece, axis=1, out=term, mode="clip")
        if order > 0 and not curve.repeats:
            value[:, (time < curve.knots[0]) | (time > curve.knots[-1])] = 0.0
        every[first : first + CHUNK] = value.T
    return every.reshape(*t.shape, 3)


def jet(curve: Pieces, t: Float[Array, "n"], highest: int) -> Float[Array, "o n 3"]:
    """The signal and its derivatives up to the highest order at times t (s), a third of the work of one by one.

    Each piece is developed anew about each of its times, by dividing by (t − t*) again and again (Horner's scheme).
    """
    every = np.empty((highest + 1, len(t), 3))
    table = _axes_first(curve.tables[0])
    degree, count = len(table) - 1, len(curve.knots) - 1
    rows = table.reshape(-1, count)
    for first in range(0, len(t), CHUNK):
        time = t[first : first + CHUNK]
        piece, local = _place(curve, time)
        coefficients = rows.take(piece, axis=1).reshape(degree + 1, 3, len(time))
        step = np.empty_like(coefficients[0])
        for order in range(min(highest, degree) + 1):
            for j in range(degree - 1, order - 1, -1):
                np.multiply(coefficients[j + 1], local, out=step)
                coefficients[j] += step
        if not curve.repeats:
            coefficients[1:, :, (time < curve.knots[0]) | (time > curve.knots[-1])] = 0.0
        for order in range(highest + 1):
            inside = every[order, first : first + CHUNK]
            inside[:] = math.factorial(order) * coefficients[order].T if order <= degree else 0.0
    return every


def knots_between(curve: Pieces, first: float, last: float) -> Float[Array, "k"]:
    """The knots strictly between two times (s), with all their repetitions."""
    knots = curve.knots
    if curve.repeats:
        turns = np.arange(
            math.floor((first - knots[0]) / curve.duration), math.floor((last - knots[0]) / curve.duration) + 1
        )
        knots = (knots[:-1] + turns[:, None] * curve.duration).ravel()
    return knots[(knots > first) & (knots < last)]


def most_knots_between(curve: Pieces, length: float) -> float:
    """An upper bound on the number of knots in any stretch of `length` seconds."""
    count = len(curve.knots)
    return (count - 1) * (length / curve.duration + 2) if curve.repeats else count


def jumps(curve: Pieces, orders: range = JUMP_ORDERS) -> Float[Array, "k o 3"]:
    """The derivatives after each knot minus those before; at the ends the signal stops, or begins anew."""
    length = np.diff(curve.knots)
    every = np.zeros((len(curve.knots), len(orders), 3))
    for column, order in enumerate(orders):
        if order >= len(curve.tables):
            break
        table = curve.tables[order]
        before, after = _horner(table, length), table[0]
        steps = every[:, column]
        steps[1:-1] = after[1:] - before[:-1]
        if curve.repeats:
            steps[0] = steps[-1] = after[0] - before[-1]
        elif order == 0:  # standing still at either end keeps the position and ends the derivatives
            steps[0] = steps[-1] = 0.0
        else:
            steps[0], steps[-1] = after[0], -before[-1]
    return every


def bound(curve: Pieces, order: int) -> float:
    """A bound on the derivative's norm at every t; infinite if a lower one jumps, as no number bounds its rate."""
    lower = range(min(order, len(curve.tables)))
    largest = np.linalg.norm(jumps(curve, lower), axis=-1).max(axis=0)
    if not all(is_rounding(curve, k, size) for k, size in zip(lower, largest.tolist(), strict=True)):
        return math.inf
    return hull(curve, order) if order < len(curve.tables) else 0.0


def is_rounding(curve: Pieces, order: int, jump: float) -> bool:
    """Whether a jump of the derivative is no larger than the rounding of a fit: that of the hull of all pieces.

    The values at the beginnings of the pieces are corners of the hull, so few jumps need the other corners.
    """
    corners = np.linalg.norm(curve.tables[order][0], axis=-1) if order < len(curve.tables) else np.zeros(1)
    return jump <= JUMP_ROUNDING * float(corners.max()) or jump <= JUMP_ROUNDING * hull(curve, order)


@lru_cache(maxsize=64)
def hull(curve: Pieces, order: int) -> float:
    """The largest norm of any Bernstein coefficient of the derivative; cached by the identity of the pieces."""
    return float(_hull_of_each(curve, order).max())


def hulls(curve: Pieces, order: int, t: Float[Array, "n"]) -> Float[Array, "n"]:
    """The `hull` of the single piece at each time (s); 0 where the signal is constant."""
    if order >= len(curve.tables):
        return np.zeros(len(t))
    sizes = _hull_of_each(curve, order)[_place(curve, t)[0]]
    if order > 0 and not curve.repeats:
        sizes[(t < curve.knots[0]) | (t > curve.knots[-1])] = 0.0
    return sizes


def _hull_of_each(curve: Pieces, order: int) -> Float[Array, "m"]:
    corners = bernstein(curve.tables[order], np.diff(curve.knots))
    return np.linalg.norm(corners, axis=-1).max(axis=0) * (1 + 1e-12)


def rounding(curve: Pieces, latest: float) -> float:
    """A bound of the rounding of values up to a time (s), in units of ε: n Σ|c_j| hʲ of Horner's rule, and the speed
    times the rounding of the time since a knot, which is that of numbers as large as the time and the knots.
    """
    length, table = np.diff(curve.knots), np.abs(curve.tables[0])
    powers = (length[None, :] ** np.arange(len(table))[:, None])[..., None]
    sums = np.linalg.norm((table * powers).sum(axis=0), axis=-1)
    speed = hull(curve, 1) if len(curve.tables) > 1 else 0.0
    return len(table) * float(sums.max()) + 2 * speed * (latest + float(np.abs(curve.knots).max()))


def bernstein(table: Float[Array, "d m 3"], length: Float[Array, "m"]) -> Float[Array, "d m 3"]:
    """Bernstein coefficients of each piece on its own stretch: b_i = Σ_{j≤i} C(i,j)/C(n,j) c_j hʲ."""
    degree = len(table) - 1
    scaled = table * (length[None, :] ** np.arange(degree + 1)[:, None])[..., None]
    return np.einsum("ij,jmk->imk", _bernstein_weights(degree), scaled)


@lru_cache
def _bernstein_weights(degree: int) -> Float[Array, "d d"]:
    i, j = np.meshgrid(np.arange(degree + 1), np.arange(degree + 1), indexing="ij")
    return np.where(j <= i, scipy.special.comb(i, j) / scipy.special.comb(degree, j), 0.0)


def _horner(table: Array, local: Array) -> Array:
    value = table[-1]
    for coefficient in table[-2::-1]:
        value = value * local[:, None] + coefficient
    return value


def _place(curve: Pieces, time: Array) -> tuple[Array, Array]:
    """The piece at each time, and the time since its beginning (s)."""
    first, last = curve.knots[0], curve.knots[-1]
    time = first + np.mod(time - first, last - first) if curve.repeats else np.clip(time, first, last)
    piece = np.searchsorted(curve.knots[1:-1], time, side="right")
    return piece, time - curve.knots[piece]


def _axes_first(table: Float[Array, "d m 3"]) -> Float[Array, "d 3 m"]:
    return np.ascontiguousarray(table.transpose(0, 2, 1))
