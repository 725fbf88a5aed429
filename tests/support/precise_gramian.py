"""The lifted Gramian's eigenvalues in 50 digits, from the closed form: an independent witness for double precision."""

import math
from functools import cache
from typing import Any

import mpmath as mp
import numpy as np

from rangenav.preset import Preset
from rangenav.signals import Multisine

NODES = 40
PANEL = 20.0
"""rad of the fastest tone per panel of 40 Gauss nodes: exact to 50 digits for squares of such functions."""
mp.mp.dps = 50
Real = Any
"""A number of mpmath, which makes its classes at run time: no type expression can name them."""


def gramian_eigenvalues(preset: Preset, start: float, window: float) -> list[Real]:
    """Eigenvalues of (1/δ)∫ hᵀh over [start, start + window], ascending."""
    t0, delta = mp.mpf(start), mp.mpf(window)
    gravity = [mp.mpf(g) for g in preset.world.gravity]
    p0, v0 = derivative(preset, t0, 0), derivative(preset, t0, 1)
    panels = max(1, math.ceil(preset.path.bandwidth * window / PANEL))
    W = mp.zeros(13)
    for panel in range(panels):
        for node, weight in legendre(NODES):
            tau = delta / panels * (panel + (node + 1) / 2)
            p = derivative(preset, t0 + tau, 0)
            D = [p[i] - p0[i] - tau * v0[i] - tau**2 / 2 * gravity[i] for i in range(3)]
            h = [mp.mpf(1), tau, tau**2 / 2, tau**3 / 6, *D, *(tau * d for d in D), *(tau**2 / 2 * d for d in D)]
            for i in range(13):
                for j in range(i + 1):
                    W[i, j] += weight / (2 * panels) * h[i] * h[j]
    for i in range(13):
        for j in range(i):
            W[j, i] = W[i, j]
    return sorted(mp.eigsy(W, eigvals_only=True))


def derivative(preset: Preset, t: Real, order: int) -> list[Real]:
    """The path's derivative in 50 digits; phases and frequencies are the doubles of the preset, taken exactly."""
    path = preset.path
    assert isinstance(path, Multisine)
    value = [mp.mpf(0)] * 3
    if order == 0:
        value = [mp.mpf(path.offset[i]) + mp.mpf(path.drift[i]) * t for i in range(3)]
    elif order == 1:
        value = [mp.mpf(path.drift[i]) for i in range(3)]
    for tone in path.tones:
        w = mp.mpf(tone.frequency)
        value["xyz".index(tone.axis)] += (
            mp.mpf(tone.amplitude) * w**order * mp.sin(w * t + mp.mpf(tone.phase) + order * mp.pi / 2)
        )
    return value


@cache
def legendre(count: int) -> tuple[tuple[Real, Real], ...]:
    """Gauss–Legendre nodes and weights on [−1, 1] by Newton's method from numpy's."""
    pairs = []
    for guess in np.polynomial.legendre.leggauss(count)[0]:
        x = mp.mpf(float(guess))
        for _ in range(5):
            x -= mp.legendre(count, x) / slope(count, x)
        pairs.append((x, 2 / ((1 - x * x) * slope(count, x) ** 2)))
    return tuple(pairs)


def slope(count: int, x: Real) -> Real:
    """P′ₙ(x)."""
    return count * (x * mp.legendre(count, x) - mp.legendre(count - 1, x)) / (x * x - 1)
