"""Gramian spectra and ranks: singular values of weighted rows, never eigenvalues of their product.

W = (1/δ)∫ hᵀh ds = HᵀH with H the quadrature-weighted rows, so λ = σ(H)². Forming W in double precision loses every
eigenvalue below 1e-17 λ_max and returns negative ones; λ_min on the paper's own path is 5e-26 for δ = 0.25 s.
"""

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.arguments import number
from rangenav.inputs import Vec3, require
from rangenav.observability import rows, windows
from rangenav.observability.rows import PathSamples
from rangenav.results import result
from rangenav.signals import Signal

RANK_TOLERANCE = 1e-13
"""Singular values below this times the largest are rounding: rows carry 1e-16 relative errors, some tens of them."""
LIFTED_TIME_POWERS = np.array([0, 1, 2, 3, 0, 0, 0, 1, 1, 1, 2, 2, 2])
NONLINEAR_TIME_POWERS = np.repeat([0, 1, 2], 3)
"""Units of the columns in powers of time; the length unit is 1 m. Fixed units, never a column's own norm."""


@result
class Spectrum:
    """Singular-value results of w windows with n columns."""

    eigenvalues: Float[Array, "w n"]
    """Of W in SI units, ascending."""
    floor: Float[Array, "w"]
    """Eigenvalues below this are rounding, not data."""
    scaled: Float[Array, "w n"]
    """Singular values in units L = 1 m, T = δ, descending."""
    rank: Int[Array, "w"]
    tolerance: Float[Array, "w"]
    """Scaled singular values above this count."""
    triangle: Float[Array, "w n n"]
    """The weighted rows after QR, in units L = 1 m, T = δ."""


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
    R = rows.triangles(samples, samples.weight, lambda some: rows.lifted_of(some, gravity, "start"))
    return of_triangles(R, samples.window, time_powers=LIFTED_TIME_POWERS, rounding=samples.rounding)


def local_spectra(samples: PathSamples, anchor: Vec3) -> Spectrum:
    """Spectra of the 9-state nonlinear Gramian of windows whose samples are known."""
    R = rows.triangles(samples, samples.weight, lambda some: rows.nonlinear_of(some, anchor, "start"))
    return of_triangles(R, samples.window, time_powers=NONLINEAR_TIME_POWERS, rounding=samples.rounding)


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
    tolerance = np.maximum(RANK_TOLERANCE * scaled[:, 0], rounding)
    rank = np.sum(scaled > tolerance[:, None], axis=-1)
    floor = np.maximum(RANK_TOLERANCE * singular[:, 0], rounding * max(1.0, window**2 / 2))
    return Spectrum(
        eigenvalues=singular[:, ::-1] ** 2,
        floor=floor**2,
        scaled=scaled,
        rank=rank,
        tolerance=tolerance,
        triangle=in_units,
    )


def null_basis(spectrum: Spectrum, k: int) -> Float[Array, "n _"]:
    """An orthonormal basis (scaled coordinates) of what window k does not see: its last right singular vectors."""
    return np.linalg.svd(spectrum.triangle[k])[2][spectrum.rank[k] :].T


def worst(spectrum: Spectrum) -> int:
    """The window that sees least: the lowest rank, then the smallest of the singular values that count."""
    last = np.take_along_axis(spectrum.scaled, spectrum.rank[:, None] - 1, axis=1)[:, 0]
    return int(np.lexsort((last, spectrum.rank))[0])
