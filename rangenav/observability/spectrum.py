"""Gramian spectra and ranks: singular values of weighted rows, never eigenvalues of their product.

W = (1/δ)∫ hᵀh ds = HᵀH with H the quadrature-weighted rows, so λ = σ(H)². Forming W in double precision loses every
eigenvalue below 1e-17 λ_max and returns negative ones; λ_min on the paper's own path is 5e-26 for δ = 0.25 s.
The lifted rank is decided by `gramian_rank`; small singular values are computed from the `pseudoinverse`.
"""

from functools import cached_property

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.arguments import number
from rangenav.inputs import Vec3, require
from rangenav.model import STATES
from rangenav.observability import gramian_rank, pseudoinverse, rows, singular_values, windows
from rangenav.observability.cubic_fit import CUBIC
from rangenav.observability.gramian_rank import Remainders
from rangenav.observability.rows import PathSamples
from rangenav.results import result
from rangenav.signals import Signal

RANK_TOLERANCE = 1e-13
"""Singular values below this times the largest are rounding of the SVD: rows carry some tens of relative errors of
1e-16. Remainders resolve smaller ones."""
LIFTED_TIME_POWERS = np.array([0, 1, 2, 3, 0, 0, 0, 1, 1, 1, 2, 2, 2])
NONLINEAR_TIME_POWERS = np.repeat([0, 1, 2], 3)
"""Units of the columns in powers of time; the length unit is 1 m. Fixed units, never a column's own norm."""


@result
class TriangleSpectrum:
    """Singular-value results of w windows with n columns, from triangles; computed at once."""

    eigenvalues: Float[Array, "w n"]
    """Of W in SI units, ascending."""
    floor: Float[Array, "w"]
    """Eigenvalues below this are rounding, not data."""
    scaled: Float[Array, "w n"]
    """Singular values in units L = 1 m, T = δ, descending."""
    rank: Int[Array, "w"]
    tolerance: Float[Array, "w"]
    """Scaled singular values above this count."""
    unseen: Float[Array, "w n n"]
    """In the last n − rank columns an orthonormal basis (units L = 1 m, T = δ) of what a window does not see."""


@result
class LiftedSpectrum:
    """The same results from remainders, n = 13. Each system of units is decomposed when it is read first."""

    remainders: Remainders
    rounding: float
    """The absolute rounding error of the rows of D."""

    @property
    def rank(self) -> Int[Array, "w"]:
        """Of 13."""
        return self.remainders.rank

    @cached_property
    def eigenvalues(self) -> Float[Array, "w 13"]:
        """Of W in SI units, ascending."""
        return self._in_si[0][:, ::-1] ** 2

    @cached_property
    def floor(self) -> Float[Array, "w"]:
        """Eigenvalues below this are rounding, not data."""
        return self._in_si[1] ** 2

    @property
    def scaled(self) -> Float[Array, "w 13"]:
        """Singular values in units L = 1 m, T = δ, descending."""
        return self._in_units[0]

    @property
    def tolerance(self) -> Float[Array, "w"]:
        """Scaled singular values above this count."""
        return self._in_units[1]

    @cached_property
    def unseen(self) -> Float[Array, "w 13 13"]:
        """In the last 13 − rank columns an orthonormal basis of what a window does not see."""
        return pseudoinverse.unseen(self.remainders, np.ones(STATES))

    @cached_property
    def _in_units(self) -> tuple[Float[Array, "w 13"], Float[Array, "w"]]:
        direct, small = singular_values.of_rows(self.remainders, np.ones(STATES))
        return _resolved(direct, small, tolerance(direct, self.rounding), self.remainders)

    @cached_property
    def _in_si(self) -> tuple[Float[Array, "w 13"], Float[Array, "w"]]:
        window = self.remainders.window
        direct, small = singular_values.of_rows(self.remainders, window ** LIFTED_TIME_POWERS.astype(float))
        return _resolved(direct, small, _floor(direct, window, self.rounding), self.remainders)


Spectrum = TriangleSpectrum | LiftedSpectrum
"""Singular-value results of windows, wherever they come from."""


def window_spectra(path: Signal, gravity: Vec3, start: Float[Array, "w"], window: float) -> Spectrum:
    """Spectra of the 13-state lifted Gramian on windows [t, t + δ]. They depend on path and gravity only."""
    return lifted_spectra(rows.sample(path, start, window), gravity)


def nonlinear_spectra(path: Signal, anchor: Vec3, start: Float[Array, "w"], window: float) -> Spectrum:
    """Spectra of the 9-state Gramian of ½d², linearised at the true motion; they depend on where the anchor is."""
    return local_spectra(rows.sample(path, start, window), anchor)


def sampled_spectra(path: Signal, gravity: Vec3, start: Float[Array, "w"], window: float, *, rate: float) -> Spectrum:
    """As `window_spectra`, but with the sum over samples at `rate` (Hz) that a log has (trapezoidal weights)."""
    start, window = windows.checked(path, start, window)
    rate = number("rate", rate)
    require(rate * window >= 1, f"rate must give at least one step in a window of {window:g} s, got {rate:g} Hz")
    count = round(window * rate)
    weight = np.full((1, count + 1), 1.0 / count)
    weight[:, [0, -1]] /= 2
    return lifted_spectra(
        rows.sample_at(path, start, window, tau=np.arange(count + 1)[None] / rate, weight=weight), gravity
    )


def lifted_spectra(samples: PathSamples, gravity: Vec3) -> Spectrum:
    """Spectra of the 13-state lifted Gramian of windows whose samples are known."""
    many = len(samples.start) >= singular_values.MANY
    of = gramian_rank.of(samples, gravity, samples.weight, "start", compiled=many)
    return of_remainders(of, rounding=samples.rounding)


def local_spectra(samples: PathSamples, anchor: Vec3) -> Spectrum:
    """Spectra of the 9-state nonlinear Gramian of windows whose samples are known."""
    R = local_triangles(samples, anchor)
    return of_triangles(R, samples.window, time_powers=NONLINEAR_TIME_POWERS, rounding=samples.rounding)


def local_triangles(samples: PathSamples, anchor: Vec3) -> Float[Array, "w r 9"]:
    """R of the weighted rows of the nonlinear Gramian."""
    return rows.triangles(samples, samples.weight, lambda some: rows.nonlinear_of(some, anchor, "start"))


def spectra(
    matrix: Float[Array, "w k n"],
    weight: Float[Array, "k"],
    window: float,
    *,
    time_powers: Int[Array, "n"],
    rounding: float,
) -> Spectrum:
    """Spectra of Σ weight hᵀh."""
    R = np.asarray(np.linalg.qr(matrix * np.sqrt(weight)[:, None], mode="r"))
    return of_triangles(R, window, time_powers=time_powers, rounding=rounding)


def of_triangles(R: Float[Array, "w n n"], window: float, *, time_powers: Int[Array, "n"], rounding: float) -> Spectrum:
    """Spectra of RᵀR. The singular values of R are those of the rows it comes from; both unit systems share it."""
    singular = np.linalg.svd(R, compute_uv=False)
    in_units = R * window ** -time_powers.astype(float)
    scaled = np.linalg.svd(in_units, compute_uv=False)
    least_counted = tolerance(scaled, rounding)
    rank = np.sum(scaled > least_counted[:, None], axis=-1)
    counted, least = np.arange(R.shape[-1]) < rank[:, None], singular[np.arange(len(R)), np.maximum(rank, 1) - 1]
    floor = np.minimum(_floor(singular, window, rounding), least / 2)  # as many values lie above it as the rank says
    singular = np.where(counted, singular, np.minimum(singular, floor[:, None]))
    unseen = np.zeros_like(R)
    for k in np.flatnonzero(rank < R.shape[-1]):
        unseen[k, :, rank[k] :] = np.linalg.svd(in_units[k])[2][rank[k] :].T
    return TriangleSpectrum(
        eigenvalues=singular[:, ::-1] ** 2,
        floor=floor**2,
        scaled=scaled,
        rank=rank,
        tolerance=least_counted,
        unseen=unseen,
    )


def of_remainders(of: Remainders, *, rounding: float) -> Spectrum:
    """Spectra of the 13-state lifted Gramian of windows whose remainders are known."""
    return LiftedSpectrum(remainders=of, rounding=rounding)


def _floor(singular: Float[Array, "w n"], window: float, rounding: float) -> Float[Array, "w"]:
    """Singular values (SI) below it are rounding of the rows or of their SVD."""
    return np.maximum(RANK_TOLERANCE * singular[:, 0], rounding * max(1.0, window**2 / 2))


def _resolved(
    direct: Float[Array, "w 13"], reciprocal: Float[Array, "w 13"], floor: Float[Array, "w"], of: Remainders
) -> tuple[Float[Array, "w 13"], Float[Array, "w"]]:
    """Singular values, descending, and the value below which they are rounding: exactly `rank` of them lie above it.

    The floor is that of the SVD of H, unless a smaller one counts; then it is the share of it that rounding may be.
    """
    w, counted = np.arange(len(direct)), np.arange(direct.shape[1]) < of.rank[:, None]
    shift = (np.arange(direct.shape[1]) + direct.shape[1] - of.rank[:, None]) % direct.shape[1]
    precise = 1 / np.maximum(np.take_along_axis(reciprocal, shift, axis=1), np.finfo(float).tiny)
    least = precise[w, of.rank - 1]
    values = np.where(direct < np.sqrt(direct[:, :1] * least[:, None]), np.minimum(precise, direct[:, :1]), direct)
    low = np.flatnonzero(~(floor < least))
    if len(low):
        some = of.some(low)
        last = some.singular[np.arange(len(low)), np.maximum(some.rank - CUBIC - 1, 0)]
        margin = np.where(some.rank > CUBIC, last, 1 / RANK_TOLERANCE)
        floor = floor.copy()
        floor[low] = least[low] / np.maximum(margin, 1 + RANK_TOLERANCE)
    return np.where(counted, values, np.minimum(direct, floor[:, None])), floor


def null_basis(spectrum: Spectrum, k: int) -> Float[Array, "n _"]:
    """An orthonormal basis (scaled coordinates) of what window k does not see."""
    return spectrum.unseen[k, :, spectrum.rank[k] :]


def tolerance(scaled: Float[Array, "w n"], rounding: float) -> Float[Array, "w"]:
    """Scaled singular values above it count."""
    return np.maximum(RANK_TOLERANCE * scaled[:, 0], rounding)
