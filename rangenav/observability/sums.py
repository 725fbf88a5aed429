"""W(t) = ∫_t^{t+δ} p⁗ p⁗ᵀ ds on many windows at once: differences of one running sum over small cells.

Neighbouring windows share nearly all their cells, so thousands of them cost one pass over the path. Cells end wherever
a window starts or ends and at every knot, so the snap has no jump inside a cell.
"""

import math

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.observability import derivative_bounds
from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.results import result
from rangenav.signals import Signal, knots

GAUSS = 4
"""Nodes of a cell."""
TURN = 0.4
"""rad of the fastest tone in one cell: the relative error of Gauss's rule is then below 1e-11."""
FIRST_STARTS, FIRST_CELLS = 129, 64
MAX_NODES = 400_000
"""Evaluations of the snap: a second on a small machine."""
CHEAP_OPERATIONS = 20
"""A formula of so many operations costs as much as a few tones; longer ones are evaluated less often."""
NEAR = 1e-14
"""Edges nearer than this share of the whole time are one edge: they differ by the rounding of (knot − δ) + δ."""


@result
class Sums:
    """W on each window, and the cells that it is summed over."""

    start: Float[Array, "w"]
    """s"""
    matrix: Float[Array, "w 3 3"]
    """m²/s⁷"""
    edge: Float[Array, "c"]
    """s, between the cells."""
    first: Int[Array, "w"]
    last: Int[Array, "w"]
    """Edges at which each window starts and ends."""
    trace: float
    """Trace of the sum over all cells; the rounding of the differences is proportional to it."""


def sums(path: Signal, window: float, start: Float[Array, "w"], edges: Float[Array, "e"], turn: float) -> Sums:
    """W for windows that start at increasing times (s); `edges` are the path's knots. Raises
    UnboundedDerivativeError for too much work.
    """
    until = float(start[-1]) + window
    count = cells(path, until, turn)
    nodes = GAUSS * (count + 2 * len(start) + len(edges))
    if nodes > most_nodes(path):
        raise UnboundedDerivativeError(
            f"a grid over {until:.4g} s of this path would be too much work ({nodes} evaluations)"
        )
    edge = apart(np.concatenate([start, start + window, edges, np.linspace(0, until, count + 1)]), until)
    length = np.diff(edge)
    node, weight = np.polynomial.legendre.leggauss(GAUSS)
    snap = path(edge[:-1, None] + length[:, None] * (node + 1) / 2, 4)
    snap = snap * np.sqrt(length[:, None] * weight / 2)[..., None]
    total = _running(snap.transpose(0, 2, 1) @ snap)
    first, last = _nearest(edge, start), _nearest(edge, start + window)
    trace = float(np.trace(total[-1]))
    return Sums(start=start, matrix=total[last] - total[first], edge=edge, first=first, last=last, trace=trace)


def additions(count: int) -> int:
    """The most roundings that one value of a running sum of `count` terms has."""
    return 2 * (math.isqrt(count) + 1)


def _running(terms: Float[Array, "c 3 3"]) -> Float[Array, "d 3 3"]:
    """0, then the sums of the first one, two … terms; by blocks, so that few roundings add up."""
    count, block = len(terms), math.isqrt(len(terms)) + 1
    rows = -(-count // block)
    inside = np.zeros((rows * block, 3, 3))
    inside[:count] = terms
    inside = np.cumsum(inside.reshape(rows, block, 3, 3), axis=1)
    inside[1:] += np.cumsum(inside[:-1, -1], axis=0)[:, None]
    return np.concatenate([np.zeros((1, 3, 3)), inside.reshape(-1, 3, 3)[:count]])


def least(path: Signal, window: float, end: float) -> float:
    """The least λ_min over sampled windows that start in [0, end] (s), with those at knots; a sample, no bound."""
    edges = derivative_bounds.knots_until(path, end + window)
    window_sums = sums(path, window, first_starts(window, end, edges), edges, TURN)
    return float(np.linalg.eigvalsh(window_sums.matrix)[:, 0].min())


def first_starts(window: float, end: float, edges: Float[Array, "e"]) -> Float[Array, "w"]:
    """Evenly spaced starts in [0, end], and those at which an edge enters or leaves the window."""
    start = np.concatenate([np.linspace(0, end, FIRST_STARTS), edges, edges - window])
    return apart(np.clip(start, 0, end), end + window)


def cells(path: Signal, until: float, turn: float) -> int:
    """The number of equal cells that the fastest tone needs, at least FIRST_CELLS; starts and knots add more."""
    return math.ceil(max(FIRST_CELLS * TURN, knots.smooth_bandwidth(path, until) * until) / turn)


def most_nodes(path: Signal) -> float:
    """The most evaluations of this path's snap."""
    return MAX_NODES / (1 + path.operations() / CHEAP_OPERATIONS)


def apart(time: Float[Array, "m"], until: float) -> Float[Array, "n"]:
    """The times sorted, with one of those that differ by rounding only."""
    time = np.sort(time)
    return time[np.diff(time, prepend=-np.inf) > NEAR * until]


def _nearest(edge: Array, time: Array) -> Int[Array, "n"]:
    after = np.clip(np.searchsorted(edge, time), 1, len(edge) - 1)
    return after - (time - edge[after - 1] < edge[after] - time)
