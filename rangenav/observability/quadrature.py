"""Quadrature nodes of windows: Gauss–Legendre nodes on panels that end at the path's knots.

Between neighbouring knots a path of pieces is a polynomial of degree d. A row has degree d + 2 (½τ²D) and its square
2(d + 2), so d + 3 nodes on each panel integrate the Gramian to rounding; the snap has d − 4, so d − 3 nodes integrate
the excitation. A panel across a knot sees a kink or a jump: on files whose snap jumps it was 30 % off in some windows.
Tones have no knots: panels of 32 nodes, each long enough for 36 rad of the fastest one, the same in all windows.
"""

import math
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import require
from rangenav.signals import Signal, knots

PANEL_NODES = 32
PANEL_TURN = 36.0
"""rad of the fastest tone that one panel of 32 Gauss nodes integrates to rounding (squares too: exact to k = 63)."""
NODES_PER_RADIAN, MIXED_NODES = 0.6, 6
"""Additional nodes of a panel if tones are added to polynomials: accurate to 1e-12 for polynomials of degree 9."""
MAX_NODES, MAX_PIECE_NODES = 1024, 6144
"""Most nodes in one window, of tones and of pieces; more would need more memory than a live page may use."""
MAX_KNOTS = 200_000
"""Most knots of one path until its last window ends: all of them are listed first."""
LEAST_NODES = 16
"""In one window: never fewer rows than the 13 columns of the lifted model."""
ROWS, SNAP = 2, -4
"""Degree of what is squared, relative to the path's degree: rows of ½τ²D, and the fourth derivative."""


def count(path: Signal, window: float, until: float, *, spare: int = 0) -> int:
    """How many nodes a window (s) has at most, wherever it lies between 0 and `until` (s)."""
    if not knots.has_pieces(path):
        return (PANEL_NODES + spare) * _panels(window, path.bandwidth_until(until))
    return math.prod(_fullest(path, window, until, spare))


def refuse(path: Signal, window: float, until: float) -> None:
    """Raise ValueError, before any work is done, if some window between 0 and `until` (s) has too many nodes."""
    if knots.has_pieces(path):
        _refuse_tones(window, knots.smooth_bandwidth(path, until))
        _refuse_pieces(*_fullest(path, window, until, 0))
    else:
        _refuse_tones(window, path.bandwidth_until(until))


def nodes(
    path: Signal, start: Float[Array, "w"], window: float, *, raised: int = ROWS, spare: int = 0
) -> tuple[Float[Array, "v k"], Float[Array, "v k"]]:
    """Nodes τ in [0, window] and weights that sum to one: one row for all windows (v = 1), or a row for each.

    raised: the degree of what is squared, relative to the path's. spare: nodes added to each panel that has tones.
    """
    first, last = float(np.min(start)), float(np.max(start)) + window
    if not knots.has_pieces(path):
        return _composite(window, path.bandwidth_until(last), PANEL_NODES + spare)
    _refuse_tones(window, knots.smooth_bandwidth(path, last))
    edges = _edges(path, first, last)
    begin = np.searchsorted(edges, start, side="right")
    panels = int((np.searchsorted(edges, start + window) - begin).max()) + 1
    each = _panel_nodes(path, edges, window, panels, raised, spare)
    _refuse_pieces(panels, each)
    stop = (start + window)[:, None]
    padded = np.append(edges, np.full(panels, np.inf))  # what lies past the window's end becomes its end: no length
    inner = np.minimum(padded[begin[:, None] + np.arange(panels - 1)], stop)
    bounds = np.concatenate([start[:, None], inner, stop], axis=1) - start[:, None]
    length = np.diff(bounds)[..., None]
    x, weight = legendre(each)
    tau = bounds[:, :-1, None] + length * x
    return tau.reshape(len(start), -1), (length * (weight / window)).reshape(len(start), -1)


@lru_cache(maxsize=64)
def _composite(window: float, bandwidth: float, each: int) -> tuple[Array, Array]:
    """The same panels in every window."""
    _refuse_tones(window, bandwidth)
    tau, weight = composite(window, _panels(window, bandwidth), each)
    return tau[None], weight[None]


def composite(window: float, panels: int, each: int = PANEL_NODES) -> tuple[Float[Array, "k"], Float[Array, "k"]]:
    """Nodes (s, from the window's start) and weights, which add up to 1, of so many equal panels in a window (s)."""
    x, weight = legendre(each)
    return (np.arange(panels)[:, None] + x).ravel() * (window / panels), np.tile(weight / panels, panels)


def panels(path: Signal, window: float, until: float, *, spare: int) -> tuple[float, int]:
    """The most that the fastest tone turns in a panel (rad), and the least nodes of a panel, of windows up to a time
    (s).
    """
    if not knots.has_pieces(path):
        bandwidth = path.bandwidth_until(until)
        return bandwidth * window / _panels(window, bandwidth), PANEL_NODES + spare
    edges = _edges(path, 0.0, until)
    longest = min(window, float(np.diff(edges).max()))
    turn = knots.smooth_bandwidth(path, until) * longest
    return turn, max(knots.degree(path), 2) + ROWS + 1 + (_mixed(turn) + spare if turn > 0 else 0)


@lru_cache(maxsize=16)
def _fullest(path: Signal, window: float, until: float, spare: int) -> tuple[int, int]:
    """The most panels that a window has, and the nodes of each: those of a window that starts just before a knot."""
    edges = _edges(path, 0.0, until)
    inner = edges[1:-1]
    inside = np.searchsorted(inner, inner + window) - np.arange(len(inner))
    panels = 1 + int(inside.max(initial=0))
    return panels, _panel_nodes(path, edges, window, panels, ROWS, spare)


@lru_cache(maxsize=16)
def _edges(path: Signal, first: float, last: float) -> Array:
    """Both ends, all knots between them, and enough other times that no panel has more than 36 rad of any tone."""
    most = knots.most(path, last - first)
    require(
        most <= MAX_KNOTS, f"a signal may have {MAX_KNOTS} knots in {last - first:g} s, this one has up to {most:.0f}"
    )
    edges = knots.knots(path, first, last)
    bandwidth = knots.smooth_bandwidth(path, last)
    if bandwidth > 0:
        longest = PANEL_TURN / bandwidth
        even = np.arange(math.floor(first / longest) + 1, math.ceil(last / longest)) * longest
        edges = np.union1d(edges, even[(even > first) & (even < last)])
    edges = np.concatenate([[first], edges, [last]])
    edges.flags.writeable = False
    return edges


def _panel_nodes(path: Signal, edges: Array, window: float, panels: int, raised: int, spare: int) -> int:
    """Nodes of a panel: exact for the polynomials, and enough for added tones on the longest panel."""
    degree = max(knots.degree(path), 2) + raised  # 2: the drop in D
    turn = knots.smooth_bandwidth(path, float(edges[-1])) * min(window, float(np.diff(edges).max()))
    mixed = _mixed(turn) + spare if turn > 0 else 0
    return max(degree + 1 + mixed, math.ceil(LEAST_NODES / panels))


def _mixed(turn: float) -> int:
    return MIXED_NODES + math.ceil(NODES_PER_RADIAN * turn)


def _panels(window: float, bandwidth: float) -> int:
    return max(1, math.ceil(bandwidth * window / PANEL_TURN))


def _refuse_tones(window: float, bandwidth: float) -> None:
    most = MAX_NODES // PANEL_NODES
    if not (math.isfinite(bandwidth) and _panels(window, bandwidth) <= most):
        longest = most * PANEL_TURN / bandwidth
        raise ValueError(
            f"requirement.window must be at most {longest:.3g} s for tones of {bandwidth:g} rad/s, got {window:g} s"
        )


def _refuse_pieces(panels: int, each: int) -> None:
    most = MAX_PIECE_NODES // each
    require(panels <= most, f"requirement.window must hold at most {most} pieces of the path, got {panels}")


@lru_cache(maxsize=64)
def legendre(count: int) -> tuple[Array, Array]:
    """Gauss–Legendre nodes and weights on [0, 1]."""
    nodes, weight = np.polynomial.legendre.leggauss(count)
    return (nodes + 1) / 2, weight / 2
