"""σ of the position at the end of every window in some stretches of starts, each with a fixed set of ranges.

The rows of all ranges around a pivot refer to one time, its stamp, so their triangles can be joined:
    R of ranges first … last  =  R of [ R of pivot … first (backwards);  R of pivot+1 … last ]
Both grow away from the pivot by one block of ranges at a time. Every set holds one pivot, and pivots are decomposed
together. At the end of a window that starts at t, u = (t + δ − pivot's stamp)/δ and σ² = ‖E_p + uE_v + ½u²E_g‖².
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import joined_triangles, range_rows, rounding
from rangenav.progress import stop_if_unwanted
from rangenav.signals import Signal, curved_part

BERNSTEIN = np.array([[math.comb(j, i) / math.comb(4, i) for j in range(5)] for i in range(5)])
"""From the coefficients of a polynomial of degree 4 to numbers that it does not exceed on [0, 1]."""
UNEVEN, OWN = 16.0, 1.0
"""Margins of a column's rounding: in joined triangles, whose unit of time is the window but which hold half of it, and
in the rows of one window, whose unit is half the window."""
ROUNDED = 1e-5
"""The most that σ from joined triangles may be rounded by."""
ROUGH = 1e-6
"""The rounding, as `range_rows.CLEAR`, that a search of some stretches does not look into."""
BEST = 3
"""Stretches around which others are looked at, of those from some pivots."""
AGAIN = 16
"""Sets that are decomposed from their own rows at once."""
CHUNK, CACHED = 120_000, 2
"""Rows that are held at once (12 MB); and lists of rows that are kept for another anchor or other noise."""


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
    compiled: bool = False
    """By compiled code: see `joined_triangles`."""


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


def greatest(ranging: Ranging, stretches: Stretches, *, every: int = 1) -> tuple[Float[Array, "i"], Float[Array, "i"]]:
    """The largest σ (m) on each stretch, infinite where undetermined, and the start (s) at which it is reached.

    What the joined triangles leave undetermined or rounded is decomposed from its own rows, whose unit is half the
    window: that saves three digits. Once a set remains undetermined, so do those that were not decomposed again.
    With `every` > 1 only every so many-th stretch is looked at, and those around the largest; of what is rounded, the
    largest few are decomposed again. The others have −∞.
    """
    value, at, loss = np.full(len(stretches.start), np.inf), stretches.start.copy(), np.ones(len(stretches.start))
    enough = (stretches.last - stretches.first + 1) * stretches.size >= STATES
    indices = np.flatnonzero(enough)
    if len(indices) == 0:
        return value, at
    spacing = int((stretches.last - stretches.first)[indices].min()) + 1
    pivot = stretches.last // spacing * spacing
    for inside in _grouped(pivot[indices], int((stretches.last - stretches.first).max()) * stretches.size):
        chosen = indices[inside]
        grown = _Grown(ranging, stretches.some(chosen), pivot[chosen])
        value[chosen], at[chosen], loss[chosen] = grown.greatest(every)
    unknown = np.flatnonzero(enough & (loss >= ROUNDED))
    if every > 1:
        largest = unknown[np.argsort(-value[unknown], kind="stable")[:AGAIN]]
        value[unknown], unknown = -np.inf, largest
    value[unknown] = np.inf
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
        few = pivots[k : k + each]
        yield np.flatnonzero((pivot >= few[0]) & (pivot <= few[-1]))


class _Grown:
    """The triangles that grow from a few pivots, for the stretches whose blocks include one of them."""

    def __init__(self, ranging: Ranging, stretches: Stretches, pivot: Int[Array, "i"]) -> None:
        pivots, self._own = np.unique(pivot, return_inverse=True)
        self._ranging, self._stretches, self._pivot, each = ranging, stretches, pivot, stretches.size
        before, after = int((pivot - stretches.first).max()) + 1, int((stretches.last - pivot).max())
        stamp = (pivots + 1) * each - 1
        index = stamp[:, None] + np.arange(1 - before * each, after * each + 1)
        self._reference = stamp / ranging.rate
        rows, self._size = _rows(ranging, index, self._reference, ranging.window)
        middle = before * each
        self._backward = joined_triangles.grown(rows[:, middle - 1 :: -1], each, compiled=ranging.compiled)
        self._forward = joined_triangles.grown(rows[:, middle:], each, compiled=ranging.compiled)

    def greatest(self, every: int) -> tuple[Float[Array, "i"], Float[Array, "i"], Float[Array, "i"]]:
        """As `greatest`, infinite where σ is undetermined; and by which share it is rounded."""
        count = len(self._pivot)
        if every == 1:
            return self._of(np.arange(count), range_rows.CLEAR)
        value, at, loss = np.full(count, -np.inf), self._stretches.start.copy(), np.zeros(count)
        spread = np.arange(0, count, every)
        value[spread], at[spread], loss[spread] = self._of(spread, ROUGH)
        best = spread[np.argsort(-value[spread], kind="stable")[:BEST]]
        near = np.unique(np.clip(best[:, None] + np.arange(1 - every, every), 0, count - 1))
        value[near], at[near], loss[near] = self._of(near, ROUGH)
        return value, at, loss

    def _of(
        self, chosen: Int[Array, "c"], clear: float
    ) -> tuple[Float[Array, "c"], Float[Array, "c"], Float[Array, "c"]]:
        stretches, pivot, own = self._stretches.some(chosen), self._pivot[chosen], self._own[chosen]
        back, ahead = pivot - stretches.first + 1, stretches.last - pivot
        both, unit = joined_triangles.joined(self._backward, back, self._forward, ahead, own), self._ranging.window
        errors = range_rows.errors(both, self._size[own], UNEVEN, clear=clear, compiled=self._ranging.compiled)
        value, at = _of_errors(self._ranging, stretches, errors, self._reference[own], unit)
        return value, at, errors[1]


def _of_own_rows(ranging: Ranging, stretches: Stretches) -> tuple[Float[Array, "i"], Float[Array, "i"]]:
    """As `greatest`, of a few stretches, each with its own middle and half the window for its unit of time."""
    first, last = stretches.first * stretches.size, (stretches.last + 1) * stretches.size - 1
    index = np.minimum(first[:, None] + np.arange(int((last - first).max()) + 1), last[:, None] + 1)
    middle = (first + last) / 2 / ranging.rate
    rows, size = _rows(ranging, index, middle, ranging.window / 2)
    rows[index > last[:, None]] = 0.0
    errors = range_rows.errors(np.asarray(np.linalg.qr(rows, mode="r")), size, OWN)
    return _of_errors(ranging, stretches, errors, middle, ranging.window / 2)


def _of_errors(
    ranging: Ranging,
    stretches: Stretches,
    errors: tuple[Float[Array, "i 9 9"], Float[Array, "i"], Bool[Array, "i"]],
    reference: Float[Array, "i"],
    unit: float,
) -> tuple[Float[Array, "i"], Float[Array, "i"]]:
    """As `greatest`, from what `range_rows.errors` says of each set, whose rows refer to u = (time − reference)/unit.

    σ is made larger by its relative rounding, so that it stays a bound.
    """
    inverse, loss, known = errors
    value, at = np.full(len(known), np.inf), stretches.start.copy()
    length = (stretches.stop - stretches.start)[known]
    u = (stretches.start[known] + ranging.window - reference[known]) / unit
    largest, share = _largest(inverse[known], u, length / unit)
    value[known] = np.sqrt(largest) * (1 + loss[known])
    at[known] += share * length
    return value, at


def _rows(
    ranging: Ranging, index: Int[Array, "p k"], reference: Float[Array, "p"], unit: float
) -> tuple[Float[Array, "p k 13"], Float[Array, "p 9"]]:
    """The weighted rows of ranges by their indices, in u = (time − reference)/unit; zeros outside the flight."""
    within = np.clip(index, 0, ranging.count - 1)
    gravity, taken = ranging.world.gravity, (within.tobytes(), reference.tobytes())
    rows, size, position = _unweighted(ranging.path, gravity, ranging.rate, unit, *taken)
    distance2 = np.sum((position - np.asarray(ranging.world.anchor)[:, None]) ** 2, axis=1)
    weight = ranging.share / (distance2 * ranging.noise**2 + ranging.noise**4 / 2)
    return rows * np.sqrt(weight * (within == index))[..., None], size


@lru_cache(maxsize=CACHED)
def _unweighted(
    path: Signal, gravity: Vec3, rate: float, unit: float, indices: bytes, references: bytes
) -> tuple[Float[Array, "p k 13"], Float[Array, "p 9"], Float[Array, "p 3 k"]]:
    """What rows have of neither anchor nor noise: the rows, the size of what is subtracted in each column (m), and the
    positions (m). The indices, and the references (s), are bytes of arrays."""
    reference = np.frombuffer(references)
    index = np.frombuffer(indices, dtype=np.int64).reshape(len(reference), -1)
    known, place = np.unique(index, return_inverse=True)
    curve, time = curved_part(path), known / rate
    each = np.stack([path(time), curve(time)])[:, place.reshape(index.shape)]
    position, curved = np.ascontiguousarray(each.swapaxes(2, 3))
    ends = np.stack([index[:, 0], index[:, -1]]) / rate
    amplitude = rounding.sizes(path, ends, position, curved, curve(ends, 1))
    rows, large = range_rows.columns((index / rate - reference[:, None]) / unit, curved, gravity, unit)
    return rows, amplitude[:, None] + large, position


def _largest(
    inverse: Float[Array, "i 9 9"], u: Float[Array, "i"], length: Float[Array, "i"]
) -> tuple[Float[Array, "i"], Float[Array, "i"]]:
    """The largest ‖E_p + uE_v + ½u²E_g‖² from u to u + length, and at which share of the length it is reached."""
    p, v, g = inverse[:, 0:3], inverse[:, 3:6], inverse[:, 6:9]
    at, h = u[:, None, None], length[:, None, None]
    terms = (p + at * v + at**2 / 2 * g, h * (v + at * g), h**2 / 2 * g)
    power = np.zeros((len(u), 5))
    for i, one in enumerate(terms):
        for j, other in enumerate(terms[i:], start=i):
            power[:, i + j] += (1 if i == j else 2) * np.einsum("iab,iab->i", one, other)
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
