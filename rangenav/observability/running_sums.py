"""The excitation of thousands of overlapping windows from one pass over the path: W(t, t + δ) = S(t + δ) − S(t).

    S(t) = ∫ p⁗p⁗ᵀ from a first time to t
S is a sum over short cells. A difference of sums is rounded more coarsely than the singular values of one window. So
the sums only choose the windows whose eigenvalues are reported, and a bound that uses them subtracts their rounding.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability import quadrature
from rangenav.results import result
from rangenav.signals import Signal, knots

MAX_EVALUATIONS = 150_000
"""Most evaluations of the snap for the sums of one path (30 ms)."""
CELL_NODES, CELLS_PER_RADIAN = 4, 2.0
"""A cell has half a radian of the fastest tone, which 4 Gauss nodes integrate to a relative 1e-11."""
CELL_ERROR = 1e-10
"""Relative: the error of the sums of tones, with a margin."""


@result
class Sums:
    """∫p⁗p⁗ᵀ from the first edge to each edge, by a few nodes in each cell between two edges."""

    edges: Float[Array, "c"]
    total: Float[Array, "c 3 3"]
    nodes: int
    rounding: float
    """Rounding of a difference of two sums. Reported eigenvalues never come from these sums."""
    quadrature: float
    """The most that a difference of two sums is off by because tones are integrated by a few nodes in each cell."""


def between(path: Signal, first: float, last: float) -> Sums | None:
    """Sums between two times (s), with an edge at every knot; None if they are too much work.

    Windows overlap, so thousands of them cost one pass over the path and two cells each.
    """
    bandwidth, count = knots.smooth_bandwidth(path, last), max(CELL_NODES, knots.degree(path) - 3)
    cells = 1 + CELLS_PER_RADIAN * bandwidth * (last - first)
    if not count * (cells + knots.most(path, last - first)) <= MAX_EVALUATIONS:
        return None
    edges = np.union1d(np.linspace(first, last, math.ceil(cells) + 1), knots.knots(path, first, last))
    total = np.concatenate([np.zeros((1, 3, 3)), np.cumsum(_cell(path, edges[:-1], edges[1:], count), axis=0)])
    size = float(np.trace(total[-1]))
    rounding = (len(edges) + count) * np.finfo(float).eps * size
    quadrature = CELL_ERROR * size if bandwidth > 0 else 0.0
    return Sums(edges=edges, total=total, nodes=count, rounding=rounding, quadrature=quadrature)


def least_eigenvalues(path: Signal, sums: Sums, start: Array, window: float) -> Array:
    """The least eigenvalue of each window, from the sum up to its end minus the sum up to its start."""
    both = np.concatenate([start, start + window])
    cell = np.clip(np.searchsorted(sums.edges, both, side="right") - 1, 0, len(sums.edges) - 1)
    until = sums.total[cell] + _cell(path, sums.edges[cell], both, sums.nodes)
    return np.linalg.eigvalsh(until[len(start) :] - until[: len(start)])[:, 0]


def _cell(path: Signal, first: Array, last: Array, count: int) -> Array:
    """∫p⁗p⁗ᵀ over short intervals, by one panel each."""
    x, weight = quadrature.legendre(count)
    length = (last - first)[:, None]
    snap = path(first[:, None] + length * x, 4) * np.sqrt(np.maximum(length, 0) * weight)[..., None]
    return snap.transpose(0, 2, 1) @ snap
