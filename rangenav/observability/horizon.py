"""How long must a flight be? Rank and predicted σ against the window's length, from one start and at the worst of five.

An analytic path that is observable on one window is observable on every window, however short. But its singular values
fall with the ninth power of the length and faster: rounding (1e-13) hides them in short windows, and range noise hides
them in longer ones. The shortest window of rank 13 is the flight time needed without noise. The shortest window whose σ
is within the requirement is the flight time needed with this noise.
"""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import require
from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import accuracy, gramian_rank, quadrature, rows
from rangenav.observability.rows import PathSamples
from rangenav.results import result
from rangenav.signals import Signal

SHORT, LONG = 14, 12
"""Number of lengths below an eighth of the longest, in equal ratios, and above it, in equal steps."""
SHORTEST, EIGHTH = 1 / 200, 1 / 8
"""Shares of the longest length, which is the whole flight if that can be integrated."""
STARTS = 4
"""Windows, evenly spread over the flight, that are compared at each length with the window at the chosen start."""
HALVINGS = 4
"""Bisections of the gap between the last length that fails and the first that holds: 1/16 of it is left."""
FEW_RANGES = 32
"""Up to this number the ranges of a window are summed one by one, since its ends matter; more, by Euler–Maclaurin."""
CACHED = 8
Deficit = Callable[[Array, float], Array]
"""(starts, length) → the deficit of each window, which is 13 − rank or the predicted σ; the largest is the worst."""


@result
class Horizon:
    """Windows of growing length. The first column is the window at the chosen start, the second the worst window."""

    start: float
    """s: the chosen start."""
    length: Float[Array, "n"]
    """s, increasing."""
    rank: Float[Array, "n 2"]
    """Of the lifted Gramian, of 13; NaN where the chosen start does not fit any more."""
    sigma: Float[Array, "n 2"]
    """m: predicted 1-σ position at the window's end; ∞ where it is blind, NaN where the chosen start does not fit."""
    full_rank: tuple[float | None, float | None]
    """s: the shortest length from which on the rank is 13; None if there is none in the flight."""
    accurate: tuple[float | None, float | None]
    """s: the shortest length from which on σ meets the requirement."""
    summary: str


@lru_cache(maxsize=CACHED)
def horizon(
    path: Signal,
    world: World,
    duration: float,
    *,
    sigma: float,
    rate: float,
    position_sigma: float,
    share: float = 1.0,
    start: float = 0.0,
) -> Horizon:
    """Rank and σ for windows from the shortest to the whole flight (s), with ranges of noise sigma (m) at `rate` (Hz).

    `share` is the share of the ranges that arrive. Raises ValueError if no window starts at `start`.
    """
    require(0 <= start < duration, f"start must lie between 0 and the flight's end at {duration:g} s, got {start:g} s")

    by_length: dict[float, PathSamples] = {}

    def sampled(starts: Array, length: float) -> PathSamples:
        if length not in by_length:
            by_length[length] = rows.sample(path, starts, length)
        return by_length[length]

    def rank_lost(starts: Array, length: float) -> Array:
        samples = sampled(starts, length)
        return STATES - gramian_rank.of(samples, world.gravity, samples.weight, "start").rank.astype(float)

    def error(starts: Array, length: float) -> Array:
        count = int(length * rate + 1e-9) + 1
        if count < STATES:
            return np.full(len(starts), math.inf)
        if count <= FEW_RANGES:
            values = _sigma_of_few_ranges(path, world, starts, length, sigma=sigma, rate=rate, share=share)
        else:
            samples = sampled(starts, length)
            values = accuracy.along(samples, world, sigma=sigma, rate=rate, kind="lifted", share=share)[:, 0]
        return np.nan_to_num(values, nan=math.inf)

    length = _lengths(path, duration)
    lost, errors = (_deficits(deficit, length, start, duration) for deficit in (rank_lost, error))
    full_rank = _shortest(rank_lost, 0.0, length, lost, start, duration)
    accurate = _shortest(error, position_sigma, length, errors, start, duration)
    best_sigma = np.nan_to_num(errors, nan=math.inf, posinf=math.inf).min(axis=0)
    reach = (float(length[~np.isnan(errors[:, 0])].max(initial=0.0)), float(length[-1]))
    sentences = (
        _sentence(where, full_rank[j], accurate[j], float(best_sigma[j]), position_sigma, reach[j])
        for j, where in enumerate((f"From {start:.3g} s", f"At the worst of {STARTS + 1} starts"))
    )
    return Horizon(
        start=start,
        length=length,
        rank=STATES - lost,
        sigma=errors,
        full_rank=full_rank,
        accurate=accurate,
        summary=" ".join(sentences),
    )


def _lengths(path: Signal, duration: float) -> Float[Array, "n"]:
    """Short lengths in equal ratios, long ones in equal steps, up to the flight or to what the quadrature allows."""
    longest = duration
    while not _integrable(path, duration, longest):
        longest /= 2
    short = np.geomspace(SHORTEST, EIGHTH, SHORT, endpoint=False)
    return longest * np.concatenate([short, np.linspace(EIGHTH, 1.0, LONG)])


def _integrable(path: Signal, duration: float, length: float) -> bool:
    try:
        quadrature.refuse(path, length, duration)
    except ValueError:  # more work than a live page may do
        return False
    return True


def _deficits(deficit: Deficit, length: Array, start: float, duration: float) -> Float[Array, "n 2"]:
    return np.array([_chosen_and_worst(deficit, span, start, duration) for span in length.tolist()])


def _chosen_and_worst(deficit: Deficit, length: float, start: float, duration: float) -> tuple[float, float]:
    """The deficit of the window at the chosen start, NaN if that does not fit, and the worst deficit."""
    last = max(duration - length, 0.0)
    fits = start <= last
    starts = np.unique(np.append(np.linspace(0.0, last, STARTS), start if fits else last))
    values = deficit(starts, length)
    return float(values[np.searchsorted(starts, start)]) if fits else math.nan, float(values.max())


def _sigma_of_few_ranges(
    path: Signal, world: World, starts: Array, length: float, *, sigma: float, rate: float, share: float
) -> Float[Array, "s"]:
    """Predicted σ of the position, with the few ranges of each window summed one by one."""
    each = (
        accuracy.predict(path, world, t, length, sigma=sigma, rate=rate, kind="lifted", at="end", share=share)
        for t in starts.tolist()
    )
    return np.array([one.position for one in each])


def _shortest(
    deficit: Deficit, limit: float, length: Array, values: Array, start: float, duration: float
) -> tuple[float | None, float | None]:
    """The least length from which on the deficit stays within the limit: for the chosen start, and for the worst."""

    def least(column: int) -> float | None:
        fitting = ~np.isnan(values[:, column])
        holds, lengths = values[fitting, column] <= limit, length[fitting]
        if not len(holds) or not holds[-1]:
            return None
        if holds.all():
            return float(lengths[0])
        last = int(np.flatnonzero(~holds)[-1])
        fails, works = float(lengths[last]), float(lengths[last + 1])
        for _ in range(HALVINGS):
            middle = (fails + works) / 2
            enough = _chosen_and_worst(deficit, middle, start, duration)[column] <= limit
            fails, works = (fails, middle) if enough else (middle, works)
        return works

    return least(0), least(1)


def _sentence(
    where: str, full: float | None, accurate_after: float | None, best_sigma: float, needed: float, reach: float
) -> str:
    if full is None:
        return f"{where} no window of up to {reach:.3g} s has rank {STATES}."
    if accurate_after is not None:
        return f"{where}: rank {STATES} after {full:.3g} s, σ ≤ {needed:g} m after {accurate_after:.3g} s."
    nearest = f"{best_sigma:.3g} m at best" if math.isfinite(best_sigma) else "blind"
    return f"{where}: rank {STATES} after {full:.3g} s, σ ≤ {needed:g} m not within {reach:.3g} s ({nearest})."
