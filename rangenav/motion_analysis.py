"""The sampled windows of a motion: excitation, Gramian and blind directions, and the accuracy that ranges allow."""

from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import accuracy, blindness, excitation, reduced, rows, spectrum
from rangenav.observability.blindness import Direction
from rangenav.observability.continuation import continued
from rangenav.observability.rows import PathSamples
from rangenav.results import result
from rangenav.signals import Signal

WINDOWS = 101
"""Start times at which spectra are computed: enough for a smooth curve; 101 windows of 13 columns take 5 ms."""
FINE_WINDOWS = 401
"""Start times for the worst excitation, which is far cheaper than a Gramian."""
DISTANCES = 2001
"""Times at which the distance to the anchor is sampled."""
CACHED, CACHED_SAMPLES = 8, 2
"""Cached results of each stage: enough for undo and for A/B, few enough for many visitors. Samples take most memory."""


@result
class Windows:
    """Observability over sliding windows [start, start + window]."""

    start: Float[Array, "w"]
    """s"""
    window: float
    excitation: Float[Array, "w 3"]
    """Eigenvalues of ∫p⁗p⁗ᵀ, ascending (m²/s⁷)."""
    gramian: Float[Array, "w 13"]
    """Eigenvalues of the lifted Gramian (1/δ)∫, ascending, SI."""
    floor: Float[Array, "w"]
    """Gramian eigenvalues below it are rounding."""
    scaled: Float[Array, "w 13"]
    """Scaled singular values, descending."""
    rank: Int[Array, "w"]
    nonlinear: Float[Array, "w 9"]
    """Eigenvalues of the nonlinear Gramian, ascending, SI."""
    nonlinear_floor: Float[Array, "w"]
    nonlinear_rank: Int[Array, "w"]
    sigma_lifted: Float[Array, "w"]
    """Predicted 1-σ position (m) at the end of each window; NaN where blind."""
    sigma_nonlinear: Float[Array, "w"]


@result
class MotionAnalysis:
    """The part of an analysis that depends on neither anchor nor sensors."""

    start: Float[Array, "w"]
    spectrum: spectrum.Spectrum
    excitation: Float[Array, "w 3"]
    worst: int
    """Index of the window of least rank, and then of least scaled singular value."""
    rank: int
    """Its rank: what is computed, or what a longer window shows, if that is below 13."""
    rounded: bool
    """Whether its rank is 13, as a longer window shows, and `rank` is lower because of rounding alone."""
    least: Float[Array, "3"]
    least_at: float
    bound_for_all_t: float | None
    directions: tuple[Direction, ...]
    reduced_min: float
    reduced_floor: float


@lru_cache(maxsize=CACHED_SAMPLES)
def path_samples(path: Signal, duration: float, window: float) -> PathSamples:
    """Samples of the path in all windows; both spectra and the accuracy are computed from them."""
    return rows.sample(path, np.linspace(0, duration - window, WINDOWS), window)


@lru_cache(maxsize=CACHED)
def motion_analysis(path: Signal, gravity: Vec3, duration: float, window: float) -> MotionAnalysis:
    """Excitation, Gramian and blind directions, which depend on path, gravity and window only."""
    samples = path_samples(path, duration, window)
    start, gramians = samples.start, spectrum.lifted_spectra(samples, gravity)
    k = spectrum.worst(gramians)
    least, least_at = excitation.worst(path, np.linspace(0, duration - window, FINE_WINDOWS), window)
    values, axes = excitation.directions(path, float(start[k]), window)
    computed = int(gramians.rank[k])
    known = continued(path, gravity, float(start[k]), window, duration, computed)
    rounded = known.rank == STATES > computed
    null_basis = spectrum.null_basis(gramians, k)
    if known.window > window:
        null_basis = spectrum.null_basis(spectrum.window_spectra(path, gravity, start[[k]], known.window), 0)
    reduced_min, reduced_floor = reduced.least_eigenvalue(path, gravity, float(start[k]), window)
    return MotionAnalysis(
        start=start,
        spectrum=gramians,
        excitation=excitation.eigenvalues(path, start, window),
        worst=k,
        rank=computed if rounded else known.rank,
        rounded=rounded,
        least=least,
        least_at=least_at,
        bound_for_all_t=excitation.bound_for_all_t(path, window),
        directions=() if rounded else blindness.directions(null_basis, values, axes),
        reduced_min=reduced_min,
        reduced_floor=reduced_floor,
    )


def farthest_from_anchor(path: Signal, world: World, duration: float) -> float:
    """The largest distance (m) between path and anchor on a flight (s), on samples."""
    position = path(np.linspace(0.0, duration, DISTANCES))
    return float(np.linalg.norm(position - np.asarray(world.anchor), axis=-1).max())


def sampled_windows(
    samples: PathSamples,
    world: World,
    lifted: MotionAnalysis,
    local: spectrum.Spectrum,
    sigma: float,
    rate: float,
    share: float,
) -> Windows:
    """What every sampled window has, with the accuracy that ranges of noise sigma (m) and rate (Hz) allow.

    share: the share of ranges that random drop-outs leave.
    """

    def end_position(kind: accuracy.Problem) -> Array:
        return accuracy.along(samples, world, sigma=sigma, rate=rate, kind=kind, share=share)[:, 0]

    return Windows(
        start=lifted.start,
        window=samples.window,
        excitation=lifted.excitation,
        gramian=lifted.spectrum.eigenvalues,
        floor=lifted.spectrum.floor,
        scaled=lifted.spectrum.scaled,
        rank=lifted.spectrum.rank,
        nonlinear=local.eigenvalues,
        nonlinear_floor=local.floor,
        nonlinear_rank=local.rank,
        sigma_lifted=end_position("lifted"),
        sigma_nonlinear=end_position("nonlinear"),
    )
