"""The sampled windows of a motion: excitation, Gramian and blind directions, and the accuracy that ranges allow."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.motion import World
from rangenav.observability import accuracy, blindness, excitation, gramian_rank, rows, spectrum, worst_window
from rangenav.observability.blindness import Direction
from rangenav.observability.continuation import continued
from rangenav.observability.gramian_rank import Remainders
from rangenav.observability.rows import PathSamples
from rangenav.observability.spectrum import NONLINEAR_TIME_POWERS, Spectrum
from rangenav.results import result
from rangenav.signals import Signal

WINDOWS = 101
"""Start times at which spectra are computed: enough for a smooth curve."""
FINER = 4
"""Start times for the worst excitation for each of these: it is far cheaper than a Gramian."""
DISTANCES = 2001
"""Times at which the distance to the anchor is sampled."""
CACHED, CACHED_SAMPLES = 8, 2
"""Cached results of each stage: enough for undo and for A/B, few enough for many visitors. Samples take most memory."""


@result
class MotionAnalysis:
    """The part of an analysis that depends on neither anchor nor sensors."""

    path: Signal
    window: float
    """s"""
    start: Float[Array, "w"]
    remainders: Remainders
    """Of the lifted rows in each window: all that its spectra follow from."""
    rounding: float
    """The absolute rounding error of the lifted rows."""
    worst: int
    """Index of the window of least rank, and then of least scaled singular value."""
    worst_spectrum: Spectrum
    """Of that window alone."""
    rank: int
    """Its rank: what is computed, or what a longer window shows, if that is below 13."""
    rounded: bool
    """Whether its rank is 13, as a longer window shows, and `rank` is lower because of rounding alone."""
    least: Float[Array, "3"]
    least_at: float
    directions: tuple[Direction, ...]

    @cached_property
    def excitation(self) -> Float[Array, "w 3"]:
        """Eigenvalues of ∫p⁗p⁗ᵀ in every window, ascending (m²/s⁷); only plots need them."""
        return excitation.eigenvalues(self.path, self.start, self.window)

    @cached_property
    def spectrum(self) -> Spectrum:
        """Of every window. Only plots need it."""
        return spectrum.of_remainders(self.remainders, rounding=self.rounding)


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """The ranges of a flight."""

    sigma: float
    """m, their noise."""
    rate: float
    """Hz"""
    share: float
    """The share of them that random drop-outs leave."""


@result
class Windows:
    """Observability over sliding windows [start, start + window].

    Spectra, the curves of σ and all of the nonlinear problem are computed when they are read first: no verdict depends
    on them.
    """

    path: Signal
    world: World
    duration: float
    """s, of the flight."""
    start: Float[Array, "w"]
    """s"""
    window: float
    ranges: Ranges
    lifted: MotionAnalysis
    compiled: bool
    """Whether the curve of the lifted σ is computed by compiled code; see `gramian_rank.of`."""

    @property
    def excitation(self) -> Float[Array, "w 3"]:
        """Eigenvalues of ∫p⁗p⁗ᵀ, ascending (m²/s⁷)."""
        return self.lifted.excitation

    @property
    def rank(self) -> Int[Array, "w"]:
        """Of the 13 functions of each window."""
        return self.lifted.remainders.rank

    @property
    def gramian(self) -> Float[Array, "w 13"]:
        """Eigenvalues of the lifted Gramian (1/δ)∫, ascending, SI."""
        return self.lifted.spectrum.eigenvalues

    @property
    def floor(self) -> Float[Array, "w"]:
        """Gramian eigenvalues below it are rounding."""
        return self.lifted.spectrum.floor

    @property
    def scaled(self) -> Float[Array, "w 13"]:
        """Scaled singular values, descending."""
        return self.lifted.spectrum.scaled

    @property
    def nonlinear(self) -> Float[Array, "w 9"]:
        """Eigenvalues of the nonlinear Gramian, ascending, SI."""
        return self._nonlinear_spectrum.eigenvalues

    @property
    def nonlinear_floor(self) -> Float[Array, "w"]:
        """Eigenvalues of the nonlinear Gramian below it are rounding."""
        return self._nonlinear_spectrum.floor

    @property
    def nonlinear_rank(self) -> Int[Array, "w"]:
        """Of 9."""
        return self._nonlinear_spectrum.rank

    @cached_property
    def sigma_lifted(self) -> Float[Array, "w"]:
        """Predicted 1-σ position (m) at the end of each window, as if ranges came at all times; NaN where blind."""
        return _end_position(self._samples, self.world, self.ranges, "lifted", compiled=self.compiled)

    @cached_property
    def sigma_nonlinear(self) -> Float[Array, "w"]:
        """Predicted 1-σ position (m) of the nonlinear problem at the end of each window; NaN where blind."""
        return _end_position(self._samples, self.world, self.ranges, "nonlinear")

    @cached_property
    def worst_nonlinear(self) -> tuple[int, Spectrum]:
        """The window of least rank of the nonlinear Gramian, and then of least scaled singular value: its index, and
        the spectrum of that window alone."""
        rounding = self.lifted.rounding
        j = worst_window.of_triangles(self._local, self.window, time_powers=NONLINEAR_TIME_POWERS, rounding=rounding)
        return j, self._spectrum_of(self._local[[j]])

    @cached_property
    def _nonlinear_spectrum(self) -> Spectrum:
        return self._spectrum_of(self._local)

    @cached_property
    def _local(self) -> Float[Array, "w r 9"]:
        """R of the weighted rows of the nonlinear Gramian."""
        return spectrum.local_triangles(self._samples, self.world.anchor)

    def _spectrum_of(self, R: Float[Array, "w r 9"]) -> Spectrum:
        return spectrum.of_triangles(R, self.window, time_powers=NONLINEAR_TIME_POWERS, rounding=self.lifted.rounding)

    @property
    def _samples(self) -> PathSamples:
        return path_samples(self.path, self.duration, self.window, len(self.start))


@lru_cache(maxsize=CACHED_SAMPLES)
def path_samples(path: Signal, duration: float, window: float, count: int = WINDOWS) -> PathSamples:
    """Samples of the path in so many windows; both spectra and the accuracy are computed from them."""
    return rows.sample(path, np.linspace(0, duration - window, count), window)


@lru_cache(maxsize=CACHED)
def motion_analysis(
    path: Signal, gravity: Vec3, duration: float, window: float, count: int = WINDOWS, *, compiled: bool = False
) -> MotionAnalysis:
    """Excitation, Gramian and blind directions of so many windows, which depend on path, gravity and window only.

    compiled: see `gramian_rank.of`.
    """
    samples = path_samples(path, duration, window, count)
    start, of = samples.start, gramian_rank.of(samples, gravity, samples.weight, "start", compiled=compiled)
    k = worst_window.of_remainders(of)
    worst = spectrum.of_remainders(of.some(np.array([k])), rounding=samples.rounding)
    least, least_at = excitation.worst(path, np.linspace(0, duration - window, FINER * (count - 1) + 1), window)
    computed = int(worst.rank[0])
    known = continued(path, gravity, float(start[k]), window, duration, computed)
    rounded = known.rank == STATES > computed
    null_basis = spectrum.null_basis(worst, 0)
    if known.window > window:
        null_basis = spectrum.null_basis(spectrum.window_spectra(path, gravity, start[[k]], known.window), 0)
    return MotionAnalysis(
        path=path,
        window=window,
        start=start,
        remainders=of,
        rounding=samples.rounding,
        worst=k,
        worst_spectrum=worst,
        rank=computed if rounded else known.rank,
        rounded=rounded,
        least=least,
        least_at=least_at,
        directions=() if rounded else _directions(path, float(start[k]), window, null_basis, float(least[0])),
    )


def _directions(
    path: Signal, start: float, window: float, null_basis: Float[Array, "13 k"], mu: float
) -> tuple[Direction, ...]:
    """The blind directions of a window; none where nothing is unseen and every window is clearly excited."""
    if null_basis.shape[1] == 0 and mu > excitation.CLEAR * excitation.most(path, window):
        return ()
    return blindness.directions(null_basis, *excitation.directions(path, start, window))


@lru_cache(maxsize=CACHED)
def farthest_from_anchor(path: Signal, world: World, duration: float) -> float:
    """The largest distance (m) between path and anchor on a flight (s), on samples."""
    position = path(np.linspace(0.0, duration, DISTANCES))
    return float(np.linalg.norm(position - np.asarray(world.anchor), axis=-1).max())


def sampled_windows(
    path: Signal,
    world: World,
    duration: float,
    window: float,
    ranges: Ranges,
    count: int = WINDOWS,
    *,
    compiled: bool = False,
) -> Windows:
    """The sampled windows (s) of a flight, with the accuracy that its ranges allow. compiled: see `gramian_rank.of`."""
    lifted = motion_analysis(path, world.gravity, duration, window, count, compiled=compiled)
    return Windows(
        path=path,
        world=world,
        duration=duration,
        start=lifted.start,
        window=window,
        ranges=ranges,
        lifted=lifted,
        compiled=compiled,
    )


def _end_position(
    samples: PathSamples, world: World, ranges: Ranges, kind: accuracy.Problem, *, compiled: bool = False
) -> Float[Array, "w"]:
    sigmas = accuracy.along(
        samples, world, sigma=ranges.sigma, rate=ranges.rate, kind=kind, share=ranges.share, compiled=compiled
    )
    return sigmas[:, 0]
