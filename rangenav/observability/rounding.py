"""How far a path's positions, and rows computed from them, are off by rounding.

A position is rounded, and so is the time t at which it is taken, by ε t, while the path moves by v ε t. A formula of
many operations rounds more. What a path seems to do within 1e-8 rad of its fastest tone is rounding: it is smooth.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability import derivative_bounds
from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.signals import Signal, curved_part, knots

ROWS = 64 * np.finfo(float).eps
"""Absolute error of a row per metre of path amplitude, where D is a small difference of large positions."""
SHARES = np.array([0.15, 0.4, 0.65, 0.9])
"""Of a window: where the rounding of a path is measured."""
FINE = 4097
"""Edges between which formulas are enclosed: on longer stretches an interval loses more of them."""
TURN = 1e-8
"""rad of the fastest tone from one to its neighbours: its own second difference is below its rounding there."""


def sizes(
    path: Signal,
    ends: Float[Array, "2 w"],
    position: Float[Array, "w 3 k"],
    curved: Float[Array, "w 3 k"],
    velocity: Float[Array, "2 w 3"],
) -> Float[Array, "w"]:
    """The size (m) of the numbers from which each window's curved positions are computed; ε times it is their error.

    ends: of the windows, s; velocity: there. Tones have their offset apart, so it rounds nothing; polynomials are
    computed with it.
    """
    largest = np.sqrt(np.einsum("wik,wik->wk", curved, curved).max(axis=1))
    speed = np.maximum(np.abs(velocity).max(axis=(0, 2)), 2 * np.ptp(curved, axis=2).max(axis=1) / (ends[1] - ends[0]))
    size = np.maximum(largest + speed * np.abs(ends).max(axis=0), _measured(path, ends))
    return size + np.sqrt(np.sum(position**2, axis=1)).max(axis=1) if knots.has_pieces(path) else size


def bound(path: Signal, until: float) -> float:
    """A size (m) whose rounding no curved position from 0 to a time (s) exceeds; infinite if none is known.

    It is no less than |p| + 2|v|t, which `sizes` has of the windows it measures.
    """
    curve = curved_part(path)
    try:
        edges = derivative_bounds.stretches(curve, until)
    except UnboundedDerivativeError:
        return math.inf
    if path.operations() > 0:
        edges = np.union1d(edges, np.linspace(0.0, until, FINE))
    position, speed = curve.derivative_bounds(edges, range(2)).max(axis=1).tolist()
    moved = path(np.zeros(1)) - curve(np.zeros(1)) if knots.has_pieces(path) else np.zeros(1)
    size = curve.rounding_bound(edges) + position + 2 * speed * until + float(np.linalg.norm(moved))
    return size if math.isfinite(size) else math.inf


def _measured(path: Signal, ends: Float[Array, "2 w"]) -> Float[Array, "w"]:
    """Second differences over moments, in units of ε: the largest in each window."""
    curve, time = curved_part(path), ends[0, :, None] + (ends[1] - ends[0])[:, None] * SHARES
    fastest = path.bandwidth_until(float(ends.max()))
    step = np.maximum(TURN / fastest if fastest > 0 else 0.0, np.spacing(np.abs(time)))
    after, here, before = curve(np.stack([time + step, time, time - step]))
    return np.abs(after - 2 * here + before).max(axis=(1, 2)) / np.finfo(float).eps


def of_rows(path: Signal, start: Float[Array, "w"], window: float) -> float:
    """The rows' absolute rounding error: positions of size |p| and velocities times δ are subtracted in D.

    Where no bound of the path is known, because it drifts or jumps, its largest sampled values are used.
    """
    path = curved_part(path)
    sizes = [path.bound(order) for order in (0, 1)]
    if not math.isfinite(sum(sizes)):
        time = np.append(start, start[-1] + window)
        sizes = [float(np.linalg.norm(path(time, order), axis=-1).max()) for order in (0, 1)]
    return ROWS * (sizes[0] + window * sizes[1])
