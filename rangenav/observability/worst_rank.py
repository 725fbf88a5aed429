"""The window of least rank, among sampled windows, with its spectrum, and what it cannot tell.

The analysis, the certificates and the page take the rank from here, so they name the same window.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import blindness, excitation, rows, spectrum
from rangenav.observability.blindness import Direction
from rangenav.observability.excitation_bound import TIE
from rangenav.observability.worst_excitation import sampled_starts
from rangenav.results import result
from rangenav.signals import Signal

CACHED = 8


@result
class WorstRank:
    """Of the lifted Gramian on the window of least rank, and then of least thirteenth singular value."""

    rank: int
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
    """The least rank of the nonlinear problem, of 9."""
    nonlinear_at: float
    nonlinear_eigenvalues: Float[Array, "9"]
    nonlinear_floor: float
    count: int
    """Windows evaluated; between their starts nothing is claimed."""


@lru_cache(maxsize=CACHED)
def worst_rank(path: Signal, world: World, window: float, end: float) -> WorstRank:
    """The least ranks over sampled windows (s) that start in [0, end] (s)."""
    start = sampled_starts(path, window, end)
    samples = rows.sample(path, start, window)
    lifted = spectrum.lifted_spectra(samples, world.gravity)
    local = spectrum.local_spectra(samples, world.anchor)
    rank = int(lifted.rank.min())
    least = np.where(lifted.rank == rank, lifted.scaled[:, STATES - 1] if rank == STATES else 0.0, np.inf)
    k, j = first_near(least, float(least.min()), TIE), spectrum.worst(local)
    values, axes = excitation.directions(path, float(start[k]), window)
    return WorstRank(
        rank=rank,
        at=float(start[k]),
        smallest=float(lifted.scaled[k, -1]),
        tolerance=float(lifted.tolerance[k] / lifted.scaled[k, 0]),
        eigenvalues=lifted.eigenvalues[k],
        floor=float(lifted.floor[k]),
        directions=blindness.directions(spectrum.null_basis(lifted, k), values, axes) if rank < STATES else (),
        nonlinear=int(local.rank.min()),
        nonlinear_at=float(start[j]),
        nonlinear_eigenvalues=local.eigenvalues[j],
        nonlinear_floor=float(local.floor[j]),
        count=len(start),
    )


def first_near(values: Float[Array, "n"], target: float, share: float) -> int:
    """Index of the first value within a share of the target, so that rounding does not choose among equal ones."""
    return int(np.argmax(values <= target + share * abs(target)))
