"""The window of least rank, with its spectrum and what it cannot tell: of every window where that can be proven.

The analysis, the certificates and the page take the rank from here, so they name the same window.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import blindness, excitation, rows, spectrum, worst_window
from rangenav.observability.blindness import Direction
from rangenav.observability.continuation import Continued, continued
from rangenav.observability.every_window import RankProof, rank_over_every_window
from rangenav.observability.excitation_bound import TIE
from rangenav.observability.spectrum import Spectrum
from rangenav.observability.worst_excitation import EVERY, FLIGHT, Starts, sampled_starts
from rangenav.results import result
from rangenav.signals import Signal

CACHED = 8
LONGEST = 4.0
"""The longest loop, in flights, on which the rank is proven at every t ≥ 0; of a longer one it is the flight's."""


@result
class WorstRank:
    """Of the lifted Gramian on the window of least rank, and then of least thirteenth singular value."""

    starts: Starts
    reason: str | None
    """Why not at every t ≥ 0; None if it is."""
    proof: RankProof | None
    """What is proven of the rank; None where only windows were sampled."""
    rank: int
    """What is computed there, or what a longer window shows to be the rank there, if that is below 13."""
    rounded: bool
    """Whether the rank there is 13, as a longer window shows, and `rank` is lower because of rounding alone."""
    resolved: bool
    """Whether more digits would not give another rank; see `continuation.Continued`."""
    at: float
    """s, where that window starts."""
    smallest: float
    """The thirteenth scaled singular value there."""
    tolerance: float
    """Relative: a scaled singular value counts above this share of the largest."""
    eigenvalues: Float[Array, "13"]
    """Of W = (1/δ)∫hᵀh there, ascending, SI."""
    floor: float
    """Eigenvalues below this are rounding."""
    directions: tuple[Direction, ...]
    """What that window cannot tell; none for rank 13."""
    nonlinear: int
    """The least rank of the nonlinear problem, of 9, on sampled windows."""
    nonlinear_at: float
    nonlinear_eigenvalues: Float[Array, "9"]
    nonlinear_floor: float
    count: int
    """Windows and cores evaluated."""


@result
class _Lifted:
    """What of a `WorstRank` does not depend on the anchor."""

    starts: Starts
    reason: str | None
    proof: RankProof | None
    start: Float[Array, "w"]
    """s, of the windows of `spectrum`."""
    spectrum: Spectrum
    worst: int
    """Which of them is the worst."""
    end: float
    """s: the last start of a window."""
    known: Continued
    directions: tuple[Direction, ...]


@lru_cache(maxsize=CACHED)
def worst_rank(path: Signal, world: World, duration: float, window: float) -> WorstRank:
    """The least rank over windows (s) at any t ≥ 0 if the path is periodic, else over those of the flight (s)."""
    return _with_nonlinear(_lifted(path, world.gravity, duration, window), path, world, window)


def sampled_rank(path: Signal, world: World, window: float, end: float, *, reason: str | None = None) -> WorstRank:
    """The least ranks over sampled windows (s) that start in [0, end] (s); reason: why they are not proven."""
    return _with_nonlinear(_sampled(path, world.gravity, window, end, reason=reason), path, world, window)


@lru_cache(maxsize=CACHED)
def _lifted(path: Signal, gravity: Vec3, duration: float, window: float) -> _Lifted:
    """The part that takes most of the time: an anchor that moves leaves it as it is."""
    period, starts, reason = path.period, EVERY, None
    until = window + period if period else duration
    if period is None:
        starts, reason = FLIGHT, "the path does not repeat"
    elif until > LONGEST * duration:
        starts, reason, until = FLIGHT, f"a loop takes {period:.4g} s", duration
    try:
        proof = rank_over_every_window(path, gravity, until, window)
    except ValueError as error:  # too much work
        return _sampled(path, gravity, window, duration - window, reason=str(error))
    start = np.array([proof.at])
    lifted = spectrum.window_spectra(path, gravity, start, window)
    return _worst(path, gravity, window, lifted, 0, start, until - window, starts=starts, reason=reason, proof=proof)


def _sampled(path: Signal, gravity: Vec3, window: float, end: float, *, reason: str | None) -> _Lifted:
    start = sampled_starts(path, window, end)
    lifted = spectrum.window_spectra(path, gravity, start, window)
    rank = int(lifted.rank.min())
    least = np.where(lifted.rank == rank, lifted.scaled[:, STATES - 1] if rank == STATES else 0.0, np.inf)
    k = _first_near(least, float(least.min()), TIE)
    return _worst(path, gravity, window, lifted, k, start, end, starts=FLIGHT, reason=reason, proof=None)


def _worst(
    path: Signal,
    gravity: Vec3,
    window: float,
    lifted: Spectrum,
    k: int,
    start: Float[Array, "w"],
    end: float,
    *,
    starts: Starts,
    reason: str | None,
    proof: RankProof | None,
) -> _Lifted:
    """Of window k among those that start at `start`."""
    at, rank = float(start[k]), int(lifted.rank[k])
    known = continued(path, gravity, at, window, end + window, rank)
    values, axes = excitation.directions(path, at, window)
    null_basis = spectrum.null_basis(lifted, k)
    if known.window > window:
        null_basis = spectrum.null_basis(spectrum.window_spectra(path, gravity, np.array([at]), known.window), 0)
    return _Lifted(
        starts=starts,
        reason=reason,
        proof=proof,
        start=start,
        spectrum=lifted,
        worst=k,
        end=end,
        known=known,
        directions=() if known.rank == STATES else blindness.directions(null_basis, values, axes),
    )


def _with_nonlinear(of: _Lifted, path: Signal, world: World, window: float) -> WorstRank:
    """With the ranks of the nonlinear problem on sampled windows, which depend on where the anchor is."""
    every = sampled_starts(path, window, of.end)
    local = spectrum.local_spectra(rows.sample(path, every, window), world.anchor)
    j, lifted, k, known = worst_window.of_spectrum(local), of.spectrum, of.worst, of.known
    rank = int(lifted.rank[k])
    rounded = known.rank == STATES > rank
    return WorstRank(
        starts=of.starts,
        reason=of.reason,
        proof=of.proof,
        rank=rank if rounded else known.rank,
        rounded=rounded,
        resolved=known.resolved and not rounded,
        at=float(of.start[k]),
        smallest=float(lifted.scaled[k, -1]),
        tolerance=float(lifted.tolerance[k] / lifted.scaled[k, 0]),
        eigenvalues=lifted.eigenvalues[k],
        floor=float(lifted.floor[k]),
        directions=of.directions,
        nonlinear=int(local.rank.min()),
        nonlinear_at=float(every[j]),
        nonlinear_eigenvalues=local.eigenvalues[j],
        nonlinear_floor=float(local.floor[j]),
        count=len(of.start) if of.proof is None else of.proof.decomposed,
    )


def _first_near(values: Float[Array, "n"], target: float, share: float) -> int:
    """Index of the first value within a share of the target, so that rounding does not choose among equal ones."""
    return int(np.argmax(values <= target + share * abs(target)))
