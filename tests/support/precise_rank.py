"""The rank of the 13 functions and predicted errors in 60 digits, from the functions themselves at Chebyshev nodes."""

import math
from typing import Any

import mpmath as mp
import numpy as np

from rangenav.inputs import Vec3
from rangenav.signals import Multisine, Tone
from rangenav.signals.multisine import LETTERS, Axis

NODES, LENGTH = 30, 60
"""Nodes of a window: independent functions are independent at 30 of them, unless they turn there dozens of times."""
DEPENDENT = 1e-40
"""A function (m or s, to a power) or a pivot of unit columns below this is the rounding of 60 digits."""
Real = Any
"""A number of mpmath, which makes its classes at run time: no type expression can name them."""


def rank(path: Multisine, gravity: Vec3, start: float, window: float) -> int:
    """How many of the 13 functions are independent on [start, start + window]: pivoted Gram–Schmidt of their values."""
    with mp.workdps(LENGTH):
        moments = [mp.mpf(window) * (1 - mp.cos(mp.pi * (k + mp.mpf(1) / 2) / NODES)) / 2 for k in range(NODES)]
        return _independent(path, gravity, start, moments)


def rank_of_ranges(path: Multisine, gravity: Vec3, first: int, last: int, rate: float) -> int:
    """How many of the 13 functions are independent at the ranges first/rate to last/rate (Hz)."""
    with mp.workdps(LENGTH):
        moments = [mp.mpf(k) / mp.mpf(rate) for k in range(last - first + 1)]
        return _independent(path, gravity, first / rate, moments)


def _independent(path: Multisine, gravity: Vec3, start: float, moments: list[Real]) -> int:
    with mp.workdps(LENGTH):
        values = [rows(path, gravity, start, tau) for tau in moments]
        columns = [_unit([row[j] for row in values]) for j in range(13)]
        found = 0
        while columns:
            length, j = max((mp.fsum(x * x for x in column), j) for j, column in enumerate(columns))
            if length < DEPENDENT**2:
                break
            pivot = _unit(columns.pop(j))
            shares = [mp.fsum(x * y for x, y in zip(pivot, column, strict=True)) for column in columns]
            columns = [
                [y - share * x for x, y in zip(pivot, column, strict=True)]
                for share, column in zip(shares, columns, strict=True)
            ]
            found += 1
    return found


def sigma(path: Multisine, gravity: Vec3, anchor: Vec3, start: float, tau: np.ndarray, noise: float) -> float:
    """m: the 1-σ position at the start from ranges with `noise` (m) at times τ, as sqrt(trace)."""
    with mp.workdps(LENGTH):
        W = mp.zeros(13)
        for t in tau.tolist():
            h = rows(path, gravity, start, mp.mpf(t))
            q = [p - mp.mpf(a) for p, a in zip(position(path, mp.mpf(start) + mp.mpf(t), 0), anchor, strict=True)]
            weight = 1 / (mp.fsum(x * x for x in q) * mp.mpf(noise) ** 2 + mp.mpf(noise) ** 4 / 2)
            W += weight * mp.matrix(h) * mp.matrix([h])
        covariance: Any = W**-1
        return float(mp.sqrt(mp.fsum(covariance[j, j] for j in range(4, 7))))


def rows(path: Multisine, gravity: Vec3, start: float, tau: Real) -> list[Real]:
    """The 13 functions at τ."""
    t = mp.mpf(start)
    here, speed, there = position(path, t, 0), position(path, t, 1), position(path, t + tau, 0)
    D = [there[i] - here[i] - tau * speed[i] - tau**2 / 2 * mp.mpf(gravity[i]) for i in range(3)]
    return [mp.mpf(1), tau, tau**2 / 2, tau**3 / 6, *D, *(tau * d for d in D), *(tau**2 / 2 * d for d in D)]


def position(path: Multisine, t: Real, order: int) -> list[Real]:
    """The path (order 0) or its velocity (order 1); the numbers of its tones are taken as the doubles that they are."""
    value = [
        mp.mpf(b) + mp.mpf(d) * t if order == 0 else mp.mpf(d) for b, d in zip(path.offset, path.drift, strict=True)
    ]
    for tone in path.tones:
        w = mp.mpf(tone.frequency)
        sine = (mp.sin if order == 0 else mp.cos)(w * t + mp.mpf(tone.phase))
        value["xyz".index(tone.axis)] += mp.mpf(tone.amplitude) * w**order * sine
    return value


def motions(length: float, rng: np.random.Generator) -> dict[str, Multisine]:
    """Degenerate and random motions that turn 1 to 6 times in a window of this length (s)."""
    w, A = 2 * math.pi * rng.uniform(1.0, 3.0) / length, 10 ** rng.uniform(-1, 1)
    axes: tuple[Axis, ...] = (*LETTERS, *LETTERS)
    sizes = [(A * rng.uniform(0.3, 1), w * rng.uniform(0.9, 2), rng.uniform(-3, 3)) for _ in axes]
    return {
        "hover": Multisine(offset=(1.0, 2.0, 3.0)),
        "line": Multisine(offset=(1.0, 2.0, 3.0), drift=(A / length, 0.3, -0.1)),
        "back and forth": Multisine(tones=tones(("x", A, w, 0.3), ("x", A / 3, 2.3 * w, 1.0))),
        "circle": Multisine(tones=circle(("x", "y"), A, w), offset=(3.0, 0.0, 1.0)),
        "vertical circle": Multisine(tones=circle(("x", "z"), A, w)),
        "helix": Multisine(tones=circle(("x", "y"), A, w), drift=(0.0, 0.0, A / length)),
        "one frequency": Multisine(tones=(*circle(("x", "y"), A, w), *tones(("z", A / 2, w, 0.7)))),
        "planar": Multisine(
            tones=(*circle(("x", "y"), A, w), *tones(("x", A / 2, 2 * w, 0.4), ("y", A, 1.6 * w, 2.0)))
        ),
        "random": Multisine(
            tones=tuple(
                Tone(axis=a, amplitude=s[0], frequency=s[1], phase=s[2]) for a, s in zip(axes, sizes, strict=True)
            )
        ),
    }


def tones(*each: tuple[Axis, float, float, float]) -> tuple[Tone, ...]:
    return tuple(Tone(axis=axis, amplitude=a, frequency=w, phase=phase) for axis, a, w, phase in each)


def circle(plane: tuple[Axis, Axis], amplitude: float, w: float) -> tuple[Tone, ...]:
    return tones((plane[0], amplitude, w, math.pi / 2), (plane[1], amplitude, w, 0.0))


def _unit(column: list[Real]) -> list[Real]:
    length = mp.sqrt(mp.fsum(x * x for x in column))
    return [x / length for x in column] if length > DEPENDENT else [mp.mpf(0)] * len(column)
