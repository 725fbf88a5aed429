"""A lower bound of μ for nearly planar paths, whose λ_min is lost in the rounding of W: by the core of many windows.

Every window that starts in [a, b] holds [b, a + δ], its core, so λ_min(W(t)) ≥ λ_min of the core for each of them. The
latter is the squared least singular value of the core's weighted snaps, never an eigenvalue of their product: that
resolves 1e-25 of λ_max where a sum of products resolves 1e-14. A stretch of starts is halved until its core has nearly
what the worst window has. No derivative of W is needed, so the bound costs more windows than `excitation_bound`, and it
takes over only where that one proves nothing.

The quadrature: on tones of at most w rad/s, |(u·p⁗)²⁽²ᵐ⁾| ≤ (2w)²ᵐ S² with S ≥ |p⁗|, so a panel of m Gauss nodes and of
length h errs by at most h S² (2wh)²ᵐ (m!)⁴ / ((2m+1) ((2m)!)³): for m = 32 and wh = 16 that is 1e-29 h S². On the
polynomials between knots the rule is exact.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability import derivative_bounds, quadrature
from rangenav.observability.excitation_bound import ARITHMETIC, EPSILON, TIE, ExcitationBounds, oriented
from rangenav.progress import stop_if_unwanted
from rangenav.signals import Signal, knots

SHARE = 0.02
"""Stretches are halved until the core of each has at least 1 − SHARE of the least μ."""
FIRST, MOST_ROUNDS, MAX_ROWS = 96, 16, 3_000_000
"""Stretches at first, how often they are halved, and the most evaluations of the snap."""
TOGETHER = 64
"""Windows that are decomposed at once."""
TURN = 16.0
"""rad of the fastest tone in one panel."""
QUADRATURE = 1e-28
"""Relative to δS²: more than the error above."""


def core_bounds(path: Signal, window: float, end: float) -> ExcitationBounds | None:
    """Bounds of μ over windows (s) that start in [0, end] (s); None where nothing better than 0 is found so.

    Only for tones, or for polynomials without tones: of other paths the quadrature's error is not bounded here.
    """
    smooth = knots.smooth_bandwidth(path, end + window)
    if path.operations() > 0 or (knots.has_pieces(path) and smooth > 0):
        return None
    largest = _largest(path, end + window)
    if not math.isfinite(largest) or largest == 0:
        return None
    rounding = EPSILON * (ARITHMETIC + smooth * (end + window)) * largest * math.sqrt(window)
    lost = QUADRATURE * window * largest**2
    start, length = np.linspace(0, end, FIRST, endpoint=False), end / FIRST
    rows, starts = 0, 0
    lower, worst = math.inf, (math.inf, 0.0)
    for _ in range(MOST_ROUNDS):
        rows += 2 * quadrature.count(path, window, end + window) * len(start)
        if rows > MAX_ROWS or length >= window:
            return None
        starts += len(start)
        whole = _least(path, start, window, smooth) ** 2
        k = int(np.argmax(whole <= whole.min() * (1 + TIE)))
        worst = min(worst, (float(whole[k]), float(start[k])))
        if worst[0] <= (4 * rounding) ** 2 + lost:
            return None
        core = np.maximum(_least(path, start + length, window - length, smooth) - rounding, 0) ** 2 - lost
        enough = core >= (1 - SHARE) * worst[0]
        lower = min(lower, float(core[enough].min(initial=math.inf)))
        if enough.all():
            return _result(path, window, end, worst, lower, rounding, starts)
        start = np.sort(np.concatenate([start[~enough], start[~enough] + length / 2]))
        length /= 2
    return None


def _least(path: Signal, start: Float[Array, "w"], window: float, smooth: float) -> Float[Array, "w"]:
    """The least singular value of the weighted snaps of each window."""
    triangles = []
    for k in range(0, len(start), TOGETHER):
        stop_if_unwanted()
        triangles.append(np.linalg.qr(_snaps(path, start[k : k + TOGETHER], window, smooth), mode="r"))
    return np.linalg.svd(np.concatenate(triangles), compute_uv=False)[:, -1]


def _snaps(path: Signal, start: Float[Array, "w"], window: float, smooth: float) -> Float[Array, "w k 3"]:
    if knots.has_pieces(path):
        tau, weight = quadrature.nodes(path, start, window, raised=quadrature.SNAP)
    else:
        tau, weight = quadrature.composite(window, max(1, math.ceil(smooth * window / TURN)))
        tau, weight = tau[None], weight[None]
    return path(start[:, None] + tau, 4) * np.sqrt(weight * window)[..., None]


def _result(
    path: Signal, window: float, end: float, worst: tuple[float, float], lower: float, rounding: float, starts: int
) -> ExcitationBounds:
    snap = _snaps(path, np.array([worst[1]]), window, knots.smooth_bandwidth(path, end + window))
    direction = oriented(np.linalg.svd(np.linalg.qr(snap[0], mode="r"))[2][-1])
    upper = (math.sqrt(worst[0]) + rounding) ** 2
    along = path.mapped(np.vstack([direction, np.zeros((2, 3))]), np.zeros(3))
    return ExcitationBounds(
        lower=max(0.0, lower),
        upper=upper,
        upper_everywhere=max(upper, window * _largest(along, end + window) ** 2),
        least=worst[0],
        at=worst[1],
        direction=direction,
        floor=upper - worst[0],
        starts=starts,
    )


def _largest(path: Signal, until: float) -> float:
    """A bound of |p⁗| between 0 and until (s)."""
    return float(path.derivative_bounds(derivative_bounds.stretches(path, until), range(4, 5)).max())
