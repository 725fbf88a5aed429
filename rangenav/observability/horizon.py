"""How long must I fly? Rank and predicted σ against the window's length, from one start and at the worst of several.

A path of analytic functions that is observable at all is so on every window, however short; but its singular values
fall with the ninth power and more of the length, and below rounding (1e-13) no computer, and long before that no range,
resolves them. So the shortest window of rank 13 says how long to fly without noise, the shortest with σ below the
requirement how long with this noise.
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
from rangenav.observability import accuracy, quadrature, rows, spectrum
from rangenav.observability.rows import Visit
from rangenav.results import result
from rangenav.signals import Signal

SHORT, LONG = 14, 12
"""Lengths below an eighth of the longest, in equal ratios, and above it, in equal steps."""
SHORTEST, EIGHTH = 1 / 200, 1 / 8
"""Of the longest, which is the whole flight if that can be integrated."""
STARTS = 4
"""Windows over which the worst is taken at each length, besides the chosen one: spread evenly over the flight."""
HALVINGS = 4
"""Of the gap between the last length that does not hold and the first that does: its 16th is left."""
FEW_RANGES = 32
"""Up to here a window's ranges are summed one by one, as its ends matter; beyond, by Euler–Maclaurin's sum."""
CACHED = 8
Lack = Callable[[Array, float], Array]
"""(starts, length) -> what each window lacks: 0 is perfect, and the worst is the largest."""


@result
class Horizon:
    """Windows of growing length; first column from the chosen start, second the worst of all looked at."""

    start: float
    """s: the chosen one."""
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
    words: str


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

    `share` is how many of them arrive. Raises ValueError if no window starts at `start`.
    """
    require(0 <= start < duration, f"start must lie between 0 and the flight's end at {duration:g} s, got {start:g} s")

    visits: dict[float, Visit] = {}

    def visit(starts: Array, length: float) -> Visit:
        if length not in visits:
            visits[length] = rows.visit(path, starts, length)
        return visits[length]

    def rank_lost(starts: Array, length: float) -> Array:
        return STATES - spectrum.lifted_spectra(visit(starts, length), world.gravity).rank.astype(float)

    def error(starts: Array, length: float) -> Array:
        count = int(length * rate + 1e-9) + 1
        if count < STATES:
            return np.full(len(starts), math.inf)
        if count <= FEW_RANGES:
            found = _of_few(path, world, starts, length, sigma=sigma, rate=rate, share=share)
        else:
            seen = visit(starts, length)
            found = accuracy.along(seen, world, sigma=sigma, rate=rate, kind="lifted", share=share)[:, 0]
        return np.nan_to_num(found, nan=math.inf)

    length = _lengths(path, duration)
    lost, errors = (_looked_at(lack, length, start, duration) for lack in (rank_lost, error))
    full_rank = _shortest(rank_lost, 0.0, length, lost, start, duration)
    accurate = _shortest(error, position_sigma, length, errors, start, duration)
    best = np.nan_to_num(errors, nan=math.inf, posinf=math.inf).min(axis=0)
    reach = (float(length[~np.isnan(errors[:, 0])].max(initial=0.0)), float(length[-1]))
    said = (
        _sentence(where, full_rank[j], accurate[j], float(best[j]), position_sigma, reach[j])
        for j, where in enumerate((f"From {start:.3g} s", f"At the worst of {STARTS + 1} starts"))
    )
    return Horizon(
        start=start,
        length=length,
        rank=STATES - lost,
        sigma=errors,
        full_rank=full_rank,
        accurate=accurate,
        words=" ".join(said),
    )


def _lengths(path: Signal, duration: float) -> Float[Array, "n"]:
    """Short ones in equal ratios, long ones in equal steps; up to the flight or what a quadrature can integrate."""
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


def _looked_at(lack: Lack, length: Array, start: float, duration: float) -> Float[Array, "n 2"]:
    return np.array([_chosen_and_worst(lack, span, start, duration) for span in length.tolist()])


def _chosen_and_worst(lack: Lack, length: float, start: float, duration: float) -> tuple[float, float]:
    """What the chosen window lacks, NaN if it does not fit; and the worst one."""
    last = max(duration - length, 0.0)
    fits = start <= last
    starts = np.unique(np.append(np.linspace(0.0, last, STARTS), start if fits else last))
    found = lack(starts, length)
    return float(found[np.searchsorted(starts, start)]) if fits else math.nan, float(found.max())


def _of_few(
    path: Signal, world: World, starts: Array, length: float, *, sigma: float, rate: float, share: float
) -> Float[Array, "s"]:
    """σ of the position from each of a few ranges."""
    each = (
        accuracy.predict(path, world, t, length, sigma=sigma, rate=rate, kind="lifted", at="end", share=share)
        for t in starts.tolist()
    )
    return np.array([one.position for one in each])


def _shortest(
    lack: Lack, limit: float, length: Array, found: Array, start: float, duration: float
) -> tuple[float | None, float | None]:
    """For the chosen and for the worst window the least length from which on the lack stays within the limit."""

    def least(column: int) -> float | None:
        there = ~np.isnan(found[:, column])
        holds, lengths = found[there, column] <= limit, length[there]
        if not len(holds) or not holds[-1]:
            return None
        if holds.all():
            return float(lengths[0])
        last = int(np.flatnonzero(~holds)[-1])
        fails, works = float(lengths[last]), float(lengths[last + 1])
        for _ in range(HALVINGS):
            middle = (fails + works) / 2
            good = _chosen_and_worst(lack, middle, start, duration)[column] <= limit
            fails, works = (fails, middle) if good else (middle, works)
        return works

    return least(0), least(1)


def _sentence(where: str, full: float | None, good: float | None, best: float, needed: float, reach: float) -> str:
    if full is None:
        return f"{where} no window of up to {reach:.3g} s has rank {STATES}."
    if good is not None:
        return f"{where}: rank {STATES} after {full:.3g} s, σ ≤ {needed:g} m after {good:.3g} s."
    nearest = f"{best:.3g} m at best" if math.isfinite(best) else "blind"
    return f"{where}: rank {STATES} after {full:.3g} s, σ ≤ {needed:g} m not within {reach:.3g} s ({nearest})."
