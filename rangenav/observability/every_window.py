"""The rank on every window of a flight, and not on samples: windows that start in [a, b] all hold the core [b, a + δ].

The core is shorter than the windows by the stretch's length, and what it proves of them (see `cores`) falls with that.
Stretches of starts are halved where that is not enough. They begin at the knots that enter or leave a window.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.arguments import number
from rangenav.inputs import Vec3, require
from rangenav.observability import cores, gramian_rank, quadrature_bound, rows, windows
from rangenav.observability.coordinates import STATES
from rangenav.observability.cores import Flight, Stretches
from rangenav.progress import stop_if_unwanted
from rangenav.results import result
from rangenav.signals import Signal, knots

FIRST = 1 / 16
"""The longest stretch of starts, as a share of the window."""
HALVINGS = 14
"""Then the shortest is a millionth of the window: where the rank falls within less, nothing is proved."""
MOST = 20_000
"""The most cores and windows that are decomposed: about two seconds."""
TIGHT = 0.8
"""The bound of the least singular value is improved until it is this share of the least one found."""
ROOM = 4000
"""The most cores and windows for that."""
TIE = 1e-6
"""Windows whose least singular values differ by less than this share are equally weak, and the first one is named."""
FEW, CLOSER = 33, 4
"""Windows that are sampled before any core is, and how often the neighbourhood of the weakest is where no bound is."""


@result
class RankProof:
    """The least rank of the lifted Gramian over all windows that start in [0, duration − window]."""

    rank: int
    """Of 13: the least that a sampled window has. No window has less, if `proved`."""
    proved: bool
    at: float
    """s: where the weakest of the sampled windows starts, by its rank and then its least singular value."""
    unproved: tuple[tuple[float, float], ...]
    """s: the stretches of starts on which this rank is not proved; empty if it is."""
    margin: float
    """The least bound of the last remainder that counts, in units of its rounding: above 1 if `proved`."""
    smallest_singular: float | None
    """In units of 1 m and δ: no window has a smaller one; None if rank 13 is not proved, or p̈ or the error of the
    quadrature has no known bound."""
    smallest_found: float | None
    """The smallest one of a sampled window, at `at`; None if its rank is below 13."""
    eigenvalue: float | None
    """SI: the Gramian (1/δ)∫ of no window has a smaller one; None as `smallest_singular` is."""
    eigenvalue_found: float | None
    """The smallest one of a sampled window."""
    quadrature: float | None
    """A bound of the relative error of these two bounds by the quadrature, for which they allow; None for formulas."""
    decomposed: int
    """How many cores and windows were decomposed."""


@dataclass(eq=False)
class _Sampled:
    """The weakest window so far, and how many cores and windows were decomposed."""

    rank: int = STATES + 1
    at: float = 0.0
    singular: Float[Array, "2"] = field(default_factory=lambda: np.full(2, np.inf))
    """The least singular values in units of 1 m and δ, and in SI."""
    decomposed: int = 0


def rank_over_every_window(path: Signal, gravity: Vec3, duration: float, window: float) -> RankProof:
    """The least rank over every window of a flight (s): proved by cores, or sampled where these do not suffice.

    Of a path that repeats, a duration of period + window makes it a statement on every t ≥ 0.
    Raises ValueError as `windows.checked_one` does, for windows longer than the flight, and for too many nodes.
    """
    _, window = windows.checked_one(path, 0.0, window)
    duration = number("duration", duration)
    require(window <= duration, f"window must be no longer than the flight, {duration:g} s, got {window:g} s")
    last = duration - window
    sampled = _Sampled()
    if last > MOST * FIRST * window:
        _sample(path, gravity, window, np.linspace(0.0, last, FEW), sampled)
        return _only_sampled(sampled, last)
    edges, flight = _edges(path, last, window), cores.of_flight(path, gravity, last, window)
    _sample(path, gravity, window, np.linspace(0.0, last, FEW), sampled)
    proved, pending = _proved(flight, edges, sampled)
    if sampled.rank == STATES and len(pending.begin) == 0:
        weakest = np.argsort(cores.margin(proved, STATES))[:FEW]
        _sample(
            flight.path,
            flight.gravity,
            flight.window,
            np.concatenate([proved.begin[weakest], proved.end[weakest]]),
            sampled,
        )
        bounds = flight.bounded and quadrature_bound.known(path)
        proved = _tightened(flight, proved, sampled) if bounds else proved
        if not bounds:
            _look_closer(flight, proved, last, sampled)
    every = proved.joined(pending)
    margin = cores.margin(every, sampled.rank)
    least = float(margin.min())
    whole = flight.floor_bounded and len(pending.begin) == 0 and least > 1.0
    full = sampled.rank == STATES
    error = _quadrature(flight, last, least) if whole and full else None
    bounded = whole and error is not None and error < 1 and flight.bounded
    singular, in_si = (every.least.min(axis=0) * (1 - (error or 0.0))).tolist()
    return RankProof(
        rank=sampled.rank,
        proved=whole,
        at=sampled.at,
        unproved=() if whole else _merged(pending if flight.floor_bounded else every),
        margin=least,
        smallest_singular=singular if bounded else None,
        smallest_found=float(sampled.singular[0]) if full else None,
        eigenvalue=in_si**2 if bounded else None,
        eigenvalue_found=float(sampled.singular[1] ** 2) if full else None,
        quadrature=error,
        decomposed=sampled.decomposed,
    )


def _edges(path: Signal, last: float, window: float) -> Float[Array, "n"]:
    """Ends of the first stretches: evenly spaced, and where a knot enters or leaves the window."""
    even = np.linspace(0.0, last, max(1, math.ceil(last / (FIRST * window))) + 1)
    if last <= 0 or knots.most(path, last + window) > MOST / 4:
        return even
    inside = knots.knots(path, 0.0, last + window)
    events = np.concatenate([inside, inside - window])
    edges = np.union1d(even, events[(events > 0) & (events < last)])
    return edges[np.diff(edges, prepend=-np.inf) > knots.SAME]


def _only_sampled(sampled: _Sampled, last: float) -> RankProof:
    """Of a flight of more windows than can be decomposed."""
    full = sampled.rank == STATES
    return RankProof(
        rank=sampled.rank,
        proved=False,
        at=sampled.at,
        unproved=((0.0, last),),
        margin=0.0,
        smallest_singular=None,
        smallest_found=float(sampled.singular[0]) if full else None,
        eigenvalue=None,
        eigenvalue_found=float(sampled.singular[1] ** 2) if full else None,
        quadrature=None,
        decomposed=sampled.decomposed,
    )


def _quadrature(flight: Flight, last: float, margin: float) -> float | None:
    """A bound of the relative error of the least singular values; None where none is known."""
    if not quadrature_bound.known(flight.path):
        return None
    until = last + flight.window
    return quadrature_bound.relative(flight.path, flight.window, until, size=flight.size, margin=margin)


def _sample(path: Signal, gravity: Vec3, window: float, starts: Array, sampled: _Sampled) -> None:
    """Take the weakest of the windows that start there."""
    for part in cores.parts(path, np.unique(starts), window):
        stop_if_unwanted()
        samples = rows.sample(path, part, window)
        of = gramian_rank.of(samples, gravity, samples.weight, "start")
        sampled.decomposed += len(part)
        singular = cores.least_singular(of, window, [np.zeros((7, 7))] * 2)
        rank = int(of.rank.min())
        least = float(singular[of.rank == rank, 0].min())
        k = int(np.argmax((of.rank == rank) & (singular[:, 0] <= least * (1 + TIE))))
        if rank < sampled.rank or (rank == sampled.rank and least < sampled.singular[0] * (1 - TIE)):
            sampled.rank, sampled.at = rank, float(part[k])
        sampled.singular = np.minimum(sampled.singular, singular.min(axis=0))


def _cores(flight: Flight, begin: Array, end: Array, width: float, sampled: _Sampled) -> Stretches:
    """The stretches with what their cores prove."""
    sampled.decomposed += len(begin)
    return cores.prove(flight, begin, end, width)


def _proved(flight: Flight, edges: Array, sampled: _Sampled) -> tuple[Stretches, Stretches]:
    """Stretches on which the rank is proved, and those where it is not. To be proved is the least rank of a window."""
    begin, end = (edges[:-1], edges[1:]) if len(edges) > 1 else (edges, edges)
    width = FIRST * flight.window
    pending = _cores(flight, begin, end, width, sampled)
    proved = pending.some(np.zeros(0, dtype=int))
    for halving in range(HALVINGS):
        open_ = cores.margin(pending, sampled.rank) <= 1.0
        proved, pending = proved.joined(pending.some(~open_)), pending.some(open_)
        if len(pending.begin) == 0 or sampled.decomposed > MOST:
            break
        middle = (pending.begin + pending.end) / 2
        own = [pending.begin, pending.end] if halving == 0 else []
        _sample(flight.path, flight.gravity, flight.window, np.concatenate([middle, *own]), sampled)
        open_ = cores.margin(pending, sampled.rank) <= 1.0
        proved, pending, middle = proved.joined(pending.some(~open_)), pending.some(open_), middle[open_]
        if len(pending.begin) == 0:
            break
        width /= 2
        begin, end = np.concatenate([pending.begin, middle]), np.concatenate([middle, pending.end])
        pending = _cores(flight, begin, end, width, sampled)
    open_ = cores.margin(pending, sampled.rank) <= 1.0
    return proved.joined(pending.some(~open_)), pending.some(open_)


def _tightened(flight: Flight, proved: Stretches, sampled: _Sampled) -> Stretches:
    """The stretches with the least bounds are halved until these are near the least singular value that is found."""
    most = sampled.decomposed + ROOM
    while sampled.decomposed < most:
        loose = (proved.least < TIGHT * sampled.singular).any(axis=1)
        widest = loose & (proved.width == proved.width[loose].max(initial=0.0))
        if not loose.any() or proved.width[widest][0] <= flight.window * FIRST / 2**HALVINGS:
            break
        some = proved.some(widest)
        middle = (some.begin + some.end) / 2
        _sample(flight.path, flight.gravity, flight.window, middle[np.argsort(some.least[:, 0])[:FEW]], sampled)
        begin, end = np.concatenate([some.begin, middle]), np.concatenate([middle, some.end])
        proved = proved.some(~widest).joined(_cores(flight, begin, end, float(some.width[0]) / 2, sampled))
    return proved


def _look_closer(flight: Flight, proved: Stretches, last: float, sampled: _Sampled) -> None:
    """Sample windows in the stretches whose cores are weakest, then around the weakest one: no bound leads there."""
    some = proved.some(np.argsort(proved.least[:, 0])[:FEW])
    _sample(flight.path, flight.gravity, flight.window, (some.begin + some.end) / 2, sampled)
    reach = float(proved.width.max()) / 2
    for _ in range(CLOSER):
        around = np.linspace(sampled.at - reach, sampled.at + reach, 9)
        _sample(flight.path, flight.gravity, flight.window, np.clip(around, 0.0, last), sampled)
        reach /= 4


def _merged(stretches: Stretches) -> tuple[tuple[float, float], ...]:
    """Stretches that touch are one."""
    merged: list[tuple[float, float]] = []
    for k in np.argsort(stretches.begin).tolist():
        begin, end = float(stretches.begin[k]), float(stretches.end[k])
        if merged and begin <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(end, merged[-1][1]))
        else:
            merged.append((begin, end))
    return tuple(merged)
