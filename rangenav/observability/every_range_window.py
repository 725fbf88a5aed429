"""The largest predicted σ of the position at the end of a window, over every window of a flight, from its own ranges.

Ranges are measured at k/f, k = 0, 1, …, so the window [t, t + δ] holds another set only after t or t + δ has passed a
stamp: between such events the set stays, and with it the errors of p, v and g at any fixed time. At t + δ
    p(t + δ) = p + τv + ½τ²g + known,     σ²(t) = ‖E_p + τE_v + ½τ²E_g‖²,
a polynomial of degree 4 in t, whose maximum between two events is taken. So σ is that of every window, and no sample.

Each set is decomposed afresh from rows of its own (`range_triangles`): taking rows out of a decomposition would lose
the small singular values. Long flights are searched with blocks of ranges first: a window knows no less than the whole
blocks in it, so their σ is a bound, and single ranges are needed only where that bound exceeds the largest σ so far.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from jaxtyping import Int
from numpy import ndarray as Array

from rangenav.arguments import number
from rangenav.inputs import require
from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import windows
from rangenav.observability.range_triangles import Ranging, Stretches, greatest
from rangenav.results import result
from rangenav.signals import Signal

SAME = 1e-9
"""Share of the time between two ranges; events nearer than this are one event."""
TIE = 1e-6
"""Windows whose σ differs by less than this share are equally bad, and the first one is named."""
BLOCKS, FINER = 2500, 4
"""A flight of more ranges is searched in so many blocks first, then in blocks with a fourth of the ranges each time."""
EVERY, TURN = 4, 0.32
"""Of the windows that end just before a range, every so many-th at most is looked at first, within so many rad of the
fastest tone: σ along the starts has peaks that are not much wider."""
MAX_WINDOW, MAX_SETS = 4096, 50_000
"""The most blocks in a window, and the most sets in one search; what would be more is bounded by larger blocks."""


@result
class RangeWindows:
    """The largest 1-σ of the position (m) at the end of a window, over all windows within a flight."""

    sigma: float
    """Of the worst window; infinite where its ranges do not determine the position."""
    bound: float
    """No window has more. It exceeds sigma by a share of 1e-6 at most, but for flights of very many ranges."""
    at: float
    """s, where the worst window starts; there a range may enter or leave, and the limit on one side counts."""
    first: int
    last: int
    """Its ranges are those at first/f to last/f."""
    sets: int
    """Sets of ranges that were decomposed."""

    @property
    def ranges(self) -> int:
        """How many ranges the worst window holds."""
        return self.last - self.first + 1


def worst(
    path: Signal,
    world: World,
    duration: float,
    window: float,
    *,
    sigma: float,
    rate: float,
    share: float = 1.0,
    compiled: bool = False,
) -> RangeWindows:
    """The worst window of a flight (s) with ranges of noise sigma (m) at k/rate (Hz), from 0 to its end.

    With a share of the ranges lost at random, σ is that of the expected information. Without noise σ is 0 where the
    position is determined. compiled: see `joined_triangles`.
    Raises ValueError as `windows.checked_one` does, and for a window longer than the flight.
    """
    checked = _checked(path, world, duration, window, sigma=sigma, rate=rate, share=share, compiled=compiled)
    return _exact(sigma, _search(*checked))


def _checked(
    path: Signal,
    world: World,
    duration: float,
    window: float,
    *,
    sigma: float,
    rate: float,
    share: float,
    compiled: bool,
) -> tuple[Ranging, float]:
    """What is searched, and the start (s) of the last window."""
    _, window = windows.checked_one(path, 0.0, window)
    rate, duration = number("rate", rate), number("duration", duration)
    require(rate > 0, f"rate must be positive, got {rate:g} Hz")
    require(window <= duration, f"window must be no longer than the flight, {duration:g} s, got {window:g} s")
    count, noise = math.floor(duration * rate + SAME) + 1, sigma if sigma > 0 else 1.0
    ranging = Ranging(
        path=path, world=world, window=window, rate=rate, noise=noise, share=share, count=count, compiled=compiled
    )
    return ranging, duration - window


def _exact(sigma: float, found: RangeWindows) -> RangeWindows:
    """What is found; without noise every position that is determined is exact."""
    return replace(found, sigma=0.0, bound=0.0) if sigma <= 0 and math.isfinite(found.bound) else found


def held(start: float, window: float, *, rate: float) -> RangeWindows:
    """The ranges of one window (s) whose rank is too low for any σ."""
    first, last = math.ceil(start * rate - SAME), math.floor((start + window) * rate + SAME)
    return RangeWindows(sigma=math.inf, bound=math.inf, at=start, first=first, last=last, sets=0)


def likely_worst(
    path: Signal,
    world: World,
    duration: float,
    window: float,
    *,
    sigma: float,
    rate: float,
    share: float = 1.0,
    compiled: bool = False,
) -> RangeWindows:
    """As `worst`, of fewer windows: of every fourth that ends just before a range, and of those around the worst three.

    Such a window holds the fewest ranges, and its last range lies longest before its end. Its `bound` is its sigma.
    """
    ranging, end = _checked(path, world, duration, window, sigma=sigma, rate=rate, share=share, compiled=compiled)
    single = _stretches(ranging, end, 1)
    held = single.last - single.first + 1
    few = single.some(held == held.min())
    if held.min() < STATES:
        return _result(few, 0, float(few.start[0]), math.inf, bound=math.inf, sets=0)
    fastest = path.bandwidth_until(duration)
    every = int(min(EVERY, max(1.0, TURN * rate / fastest))) if fastest > 0 else EVERY
    value, at = greatest(ranging, few, every=every)
    sets = int(np.sum(~np.isneginf(value)))
    k = int(np.argmax(value >= value.max() * (1 - TIE)))
    return _exact(sigma, _result(few, k, float(at[k]), float(value[k]), bound=float(value[k]), sets=sets))


def _search(ranging: Ranging, end: float) -> RangeWindows:
    """Blocks of ever fewer ranges, each time on those starts alone whose bound is not below the largest σ so far."""
    single = _stretches(ranging, end, 1)
    held = single.last - single.first + 1
    if held.min() < STATES:
        k = int(np.argmin(held))
        return _result(single, k, float(single.start[k]), math.inf, bound=math.inf, sets=0)
    left, sets = single, 0
    reached: RangeWindows | None = None
    bound = math.inf
    for size in _sizes(ranging):
        level = _stretches(ranging, end, size)
        level = level.some(_overlapping(level, left)) if sets else level
        if sets and len(level.start) > MAX_SETS:
            break
        value, at = greatest(ranging, level)
        sets, bound = sets + len(value), float(value.max())
        k = int(np.argmax(value >= bound * (1 - TIE)))
        if size == 1:
            return _result(level, k, float(at[k]), float(value[k]), bound=bound, sets=sets)
        one = single.some(_overlapping(single, level.some(np.array([k])))[:1])
        if ranging.window * ranging.rate <= MAX_WINDOW:
            real, moment = greatest(ranging, one)
            if reached is None or real[0] > reached.sigma:
                reached = _result(one, 0, float(moment[0]), float(real[0]), bound=bound, sets=sets)
            left = level.some(value >= reached.sigma * (1 - TIE))
        else:
            reached = _result(one, 0, float(one.start[0]), bound, bound=bound, sets=sets)
    assert reached is not None
    return replace(reached, bound=bound, sets=sets)


def _sizes(ranging: Ranging) -> Iterator[int]:
    """Ranges in a block, from the first search to the last."""
    smallest = max(1, math.ceil(ranging.window * ranging.rate / MAX_WINDOW))
    size = max(smallest, math.ceil(ranging.count / BLOCKS))
    while size > smallest:
        yield size
        size = max(smallest, size // FINER)
    yield smallest


def _result(stretches: Stretches, k: int, at: float, sigma: float, *, bound: float, sets: int) -> RangeWindows:
    first, last = int(stretches.first[k]), int(stretches.last[k])
    return RangeWindows(sigma=sigma, bound=bound, at=at, first=first, last=last, sets=sets)


def _stretches(ranging: Ranging, end: float, size: int) -> Stretches:
    """The stretches of starts in [0, end] (s) between the events of blocks of so many ranges."""
    step, delta = size / ranging.rate, ranging.window
    stamp = np.arange(math.floor(ranging.count / size) + 2) * step
    complete = stamp + (size - 1) / ranging.rate - delta
    inner = np.concatenate([stamp, complete])
    edges = np.sort(np.concatenate([[0.0], inner[(inner > 0) & (inner < end)], [end]]))
    edges = edges[np.diff(edges, prepend=-np.inf) > SAME / ranging.rate]
    start, stop = (edges[:-1], edges[1:]) if len(edges) > 1 else (edges, edges)
    middle = (start + stop) / 2
    first = np.ceil(middle * ranging.rate / size - SAME).astype(int)
    last = np.floor(((middle + delta) * ranging.rate - (size - 1)) / size + SAME).astype(int)
    return Stretches(start, stop, first, last, size)


def _overlapping(single: Stretches, chosen: Stretches) -> Int[Array, "n"]:
    """Indices of the stretches that lie, with more than a point, in any of the chosen ones (in increasing order)."""
    middle = (single.start + single.stop) / 2
    k = np.searchsorted(chosen.start, middle, side="right") - 1
    return np.flatnonzero((k >= 0) & (middle <= chosen.stop[np.maximum(k, 0)]))
