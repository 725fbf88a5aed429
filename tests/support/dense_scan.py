"""σ of windows by plain least squares in extended precision: an independent witness, on as many starts as one likes.

The 13 columns 𝒞Φ about the window's end, each scaled to length one, are orthogonalised twice by Gram and Schmidt.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.preset import Preset
from rangenav.signals import curved_part

Real = np.longdouble
LOST = 1e-13
"""A column of which less is left than this share of it is unseen: positions are rounded to 1e-16 of it."""


def starts(preset: Preset, at: float, *, count: int, seed: int) -> Float[Array, "n"]:
    """Starts in the flight: evenly spread, at random, and around a suspect."""
    last, rng = preset.duration - preset.requirement.window, np.random.default_rng(seed)
    near = at + np.array([-1e-6, 1e-6, *rng.normal(0, 0.02 * preset.requirement.window, count // 3)])
    every = [np.linspace(0, last, count // 3), rng.uniform(0, last, count // 3), near]
    return np.clip(np.concatenate(every), 0, last)


def sigma(preset: Preset, start: float) -> float:
    """The position's σ (m) at the end of one window, from the ranges at k/f in it; infinite where it is not seen."""
    window, rate, noise = preset.requirement.window, preset.sensors.range_rate, preset.sensors.sigma.range
    k = np.arange(math.ceil(start * rate - 1e-9), math.floor((start + window) * rate + 1e-9) + 1)
    if len(k) < 13:
        return math.inf
    time, end = k / rate, np.array([start + window])
    curve = curved_part(preset.path)
    tau, unit = (time - end).astype(Real), Real(window)
    D = curve(time).astype(Real) - curve(end).astype(Real) - tau[:, None] * curve(end, 1).astype(Real)
    D -= tau[:, None] ** 2 / 2 * np.asarray(preset.world.gravity, dtype=Real)
    s = tau[:, None] / unit
    H = np.concatenate([np.ones_like(s), s, s**2, s**3, D, s * D, s**2 / 2 * D], axis=1)
    distance2 = np.sum((preset.path(time) - np.asarray(preset.world.anchor)) ** 2, axis=1)
    H /= np.sqrt(distance2 * noise**2 + noise**4 / 2)[:, None].astype(Real)
    scale = np.sqrt(np.sum(H**2, axis=0))
    R = _triangle(H / scale)
    if R is None:
        return math.inf
    inverse = np.zeros((9, 9), dtype=Real)  # of the last nine columns, by substitution
    T = R[4:, 4:]
    for j in range(9):
        inverse[j, j] = 1 / T[j, j]
        for i in range(j - 1, -1, -1):
            inverse[i, j] = -np.sum(T[i, i + 1 : j + 1] * inverse[i + 1 : j + 1, j]) / T[i, i]
    return float(np.sqrt(np.sum((inverse[:3] / scale[4:7, None]) ** 2)))


def _triangle(H: Array) -> Array | None:
    """R of Gram and Schmidt, each column orthogonalised twice; None where a column is lost."""
    Q, R = H.copy(), np.zeros((13, 13), dtype=Real)
    for j in range(13):
        for _ in range(2):
            share = Q[:, :j].T @ Q[:, j]
            Q[:, j] -= Q[:, :j] @ share
            R[:j, j] += share
        R[j, j] = np.sqrt(np.sum(Q[:, j] ** 2))
        if R[j, j] <= LOST:
            return None
        Q[:, j] /= R[j, j]
    return R
