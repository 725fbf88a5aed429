"""σ of the position at the end of every window in some stretches of starts, each with a fixed set of ranges.

The rows of all ranges around a pivot refer to one time, its stamp, so their triangles can be joined:
    R of ranges first … last  =  R of [ R of pivot … first (backwards);  R of pivot+1 … last ]
Both grow away from the pivot by one block of ranges at a time. Every set holds one pivot, and pivots are decomposed
together. At the end of a window that starts at t, u = (t + δ − pivot's stamp)/δ and σ² = ‖E_p + uE_v + ½u²E_g‖².
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import range_rows, rounding
from rangenav.progress import stop_if_unwanted
from rangenav.signals import Signal, curved_part

BERNSTEIN = np.array([[math.comb(j, i) / math.comb(4, i) for j in range(5)] for i in range(5)])
"""From the coefficients of a polynomial of degree 4 to numbers that it does not exceed on [0, 1]."""
UNEVEN, OWN = 16.0, 1.0
"""Margins of a column's rounding: in joined triangles, whose unit of time is the window but which hold half of it, and
in the rows of one window, whose unit is half the window."""
ROUNDED = 1e-5
"""The most that σ from joined triangles may be rounded by."""
AGAIN = 16
"""Sets that are decomposed from their own rows at once."""
CHUNK = 120_000
"""Rows that are held at once (12 MB)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Ranging:
    """A path, its ranges and the window."""

    path: Signal
    world: World
    window: float
    rate: float
    noise: float
    share: float
    count: int
    """Ranges in the flight."""


@dataclass(frozen=True, eq=False)
class Stretches:
    """Stretches of starts, and the whole blocks of ranges that every window starting in one holds."""

    start: Float[Array, "i"]
    stop: Float[Array, "i"]
    first: Int[Array, "i"]
    last: Int[Array, "i"]
    size: int
    """Ranges in a block."""

    def some(self, chosen: Array) -> "Stretches":
        """The chosen ones: indices, or a mask."""
        return Stretches(self.start[chosen], self.stop[chosen], self.first[chosen], self.last[chosen], self.size)


def greatest(ranging: Ranging, stretches: Stretches) -> tuple[Float[Array, "i"], Float[Array, "i"]]:
    """The largest σ (m) on each stretch, infinite where undetermined, and the start (s) at which it is reached.

    What the joined triangles leave undetermined or rounded is decomposed from its own rows, whose unit is half the
    window: that saves three digits. Once a set remains undetermined, so do those that were not decomposed again.
    """
    value, at = np.full(len(stretches.start), np.inf), stretches.start.copy()
    enough = (stretches.last - stretches.first + 1) * stretches.size >= STATES
    indices = np.flatnonzero(enough)
    if len(indices) == 0:
        return value, at
    spacing = int((stretches.last - stretches.first)[indices].min()) + 1
    pivot = stretches.last // spacing * spacing
    for inside in _grouped(pivot[indices], int((stretches.last - stretches.first).max()) * stretches.size):
        chosen = indices[inside]
        value[chosen], at[chosen] = _of_pivots(ranging, stretches.some(chosen), pivot[chosen])
    unknown = np.flatnonzero(enough & np.isinf(value))
    for k in range(0, len(unknown), AGAIN):
        stop_if_unwanted()
        chosen = unknown[k : k + AGAIN]
        value[chosen], at[chosen] = _of_own_rows(ranging, stretches.some(chosen))
        if np.isinf(value[chosen]).any():
            break
    return value, at


def _grouped(pivot: Int[Array, "i"], reach: int) -> Iterator[Array]:
    """Groups of stretches, by a few pivots each."""
    pivots, each = np.unique(pivot), max(1, CHUNK // (2 * reach + 1))
    for k in range(0, len(pivots), each):
        stop_if_unwanted()
        yield np.flatnonzero(np.isin(pivot, pivots[k : k + each]))


def _of_pivots(
    ranging: Ranging, stretches: Stretches, pivot: Int[Array, "i"]
) -> tuple[Float[Array, "i"], Float[Array, "i"]]:
    """As `greatest`, of stretches whose blocks include one of a few pivots."""
    pivots, own = np.unique(pivot, return_inverse=True)
    before, after = int((pivot - stretches.first).max()) + 1, int((stretches.last - pivot).max())
    stamp = (pivots + 1) * stretches.size - 1
    index = stamp[:, None] + np.arange(1 - before * stretches.size, after * stretches.size + 1)
    reference = stamp / ranging.rate
    rows, size = _rows(ranging, index, reference, ranging.window)
    blocks = rows.reshape(len(pivots), before + after, stretches.size, STATES)
    backward, forward = _grown(blocks[:, before - 1 :: -1]), _grown(blocks[:, before:])
    both = np.concatenate([backward[pivot - stretches.first + 1, own], forward[stretches.last - pivot, own]], axis=1)
    value, at, loss = _of_rows(ranging, stretches, both, size[own], reference[own], ranging.window, UNEVEN)
    return np.where(loss < ROUNDED, value, np.inf), at


def _of_own_rows(ranging: Ranging, stretches: Stretches) -> tuple[Float[Array, "i"], Float[Array, "i"]]:
    """As `greatest`, of a few stretches, each with its own middle and half the window for its unit of time."""
    first, last = stretches.first * stretches.size, (stretches.last + 1) * stretches.size - 1
    index = np.minimum(first[:, None] + np.arange(int((last - first).max()) + 1), last[:, None] + 1)
    middle = (first + last) / 2 / ranging.rate
    rows, size = _rows(ranging, index, middle, ranging.window / 2)
    rows[index > last[:, None]] = 0.0
    return _of_rows(ranging, stretches, rows, size, middle, ranging.window / 2, OWN)[:2]


def _of_rows(
    ranging: Ranging,
    stretches: Stretches,
    rows: Float[Array, "i k 13"],
    size: Float[Array, "i 9"],
    reference: Float[Array, "i"],
    unit: float,
    margin: float,
) -> tuple[Float[Array, "i"], Float[Array, "i"], Float[Array, "i"]]:
    """As `greatest`, from the weighted rows of each set, which refer to u = (time − reference)/unit.

    σ is made larger by its relative rounding, which is the third result, so that it stays a bound.
    """
    inverse, loss, known = range_rows.errors(np.asarray(np.linalg.qr(rows, mode="r")), size, margin)
    value, at = np.full(len(rows), np.inf), stretches.start.copy()
    length = (stretches.stop - stretches.start)[known]
    u = (stretches.start[known] + ranging.window - reference[known]) / unit
    largest, share = _largest(inverse[known], u, length / unit)
    value[known] = np.sqrt(largest) * (1 + loss[known])
    at[known] += share * length
    return value, at, loss


def _rows(
    ranging: Ranging, index: Int[Array, "p k"], reference: Float[Array, "p"], unit: float
) -> tuple[Float[Array, "p k 13"], Float[Array, "p 9"]]:
    """The weighted rows of ranges by their indices, in u = (time − reference)/unit; zeros outside the flight."""
    within = np.clip(index, 0, ranging.count - 1)
    time = within / ranging.rate
    curve, position = curved_part(ranging.path), ranging.path(time)
    curved, ends = np.ascontiguousarray(curve(time).swapaxes(1, 2)), np.stack([time[:, 0], time[:, -1]])
    amplitude = rounding.sizes(ranging.path, ends, position.swapaxes(1, 2), curved, curve(ends, 1))
    u = (time - reference[:, None]) / unit
    rows, large = range_rows.columns(u, curved, ranging.world.gravity, unit)
    distance2 = np.sum((position - np.asarray(ranging.world.anchor)) ** 2, axis=-1)
    weight = ranging.share / (distance2 * ranging.noise**2 + ranging.noise**4 / 2)
    return rows * np.sqrt(weight * (within == index))[..., None], amplitude[:, None] + large


def _grown(blocks: Float[Array, "p l s 13"]) -> Float[Array, "m p 13 13"]:
    """R of none, of the first, of the first two … blocks of rows."""
    grown = np.zeros((blocks.shape[1] + 1, len(blocks), STATES, STATES))
    for k in range(blocks.shape[1]):
        stop_if_unwanted()
        grown[k + 1] = np.linalg.qr(np.concatenate([grown[k], blocks[:, k]], axis=1), mode="r")
    return grown


def _largest(
    inverse: Float[Array, "i 9 9"], u: Float[Array, "i"], length: Float[Array, "i"]
) -> tuple[Float[Array, "i"], Float[Array, "i"]]:
    """The largest ‖E_p + uE_v + ½u²E_g‖² from u to u + length, and at which share of the length it is reached."""
    p, v, g = inverse[:, 0:3], inverse[:, 3:6], inverse[:, 6:9]
    at, h = u[:, None, None], length[:, None, None]
    terms = (p + at * v + at**2 / 2 * g, h * (v + at * g), h**2 / 2 * g)
    power = np.zeros((len(u), 5))
    for i, one in enumerate(terms):
        for j, other in enumerate(terms):
            power[:, i + j] += np.einsum("iab,iab->i", one, other)
    ends = np.stack([power[:, 0], power.sum(axis=1)])
    value, share = ends.max(axis=0), ends.argmax(axis=0).astype(float)
    bernstein = power @ BERNSTEIN
    for k in np.flatnonzero(bernstein.max(axis=1) > value):
        turning = np.polynomial.Polynomial(power[k]).deriv().roots()
        inner = turning.real[(np.abs(turning.imag) < 1e-9) & (turning.real > 0) & (turning.real < 1)]
        for x in inner.tolist():
            reached = float(np.polynomial.polynomial.polyval(x, power[k]))
            if reached > value[k]:
                value[k], share[k] = reached, x
    return value, share
