"""Gramian spectra and ranks: singular values of weighted rows, never eigenvalues of their product.

W = (1/δ)∫ hᵀh ds = HᵀH with H the quadrature-weighted rows, so λ = σ(H)². Forming W in double precision loses every
eigenvalue below 1e-17 λ_max and returns negative ones; λ_min on the paper's own path is 5e-26 for δ = 0.25 s.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.inputs import Vec3
from rangenav.observability import rows
from rangenav.signals import Signal, bent

RANK_TOLERANCE = 1e-13
"""Singular values below this times the largest are rounding: rows carry 1e-16 relative errors, some tens of them."""
ROUNDING = 64 * np.finfo(float).eps
"""Absolute error of a row per metre of path amplitude, when D is a small difference of large positions."""
LIFTED_TIME_POWERS = np.array([0, 1, 2, 3, 0, 0, 0, 1, 1, 1, 2, 2, 2])
NONLINEAR_TIME_POWERS = np.repeat([0, 1, 2], 3)
"""Units of the columns in powers of time; the length unit is 1 m. Fixed units, never a column's own norm."""


@dataclass(frozen=True, eq=False, kw_only=True)
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
    null_basis: tuple[Float[Array, "n _"], ...]
    """For each window an orthonormal basis (scaled coordinates) of what it does not see."""


def window_spectra(path: Signal, gravity: Vec3, start: Float[Array, "w"], window: float) -> Spectrum:
    """Spectra of the 13-state lifted Gramian on windows [t, t + δ]. They depend on path and gravity only."""
    tau, weight = rows.nodes(path, start, window)
    lifted = rows.lifted(path, gravity, start, tau)
    return spectra(lifted, weight, window, time_powers=LIFTED_TIME_POWERS, rounding=_rounding(path, start, window))


def nonlinear_spectra(path: Signal, anchor: Vec3, start: Float[Array, "w"], window: float) -> Spectrum:
    """Spectra of the 9-state Gramian of ½d², linearised at the true motion; they depend on where the anchor is."""
    tau, weight = rows.nodes(path, start, window)
    local = rows.nonlinear(path, anchor, start, tau)
    return spectra(local, weight, window, time_powers=NONLINEAR_TIME_POWERS, rounding=_rounding(path, start, window))


def sampled_spectra(path: Signal, gravity: Vec3, start: Float[Array, "w"], window: float, *, rate: float) -> Spectrum:
    """As `window_spectra`, but with the sum over samples at `rate` (Hz) that a log has (trapezoidal weights)."""
    count = round(window * rate)
    weight = np.full(count + 1, 1.0 / count)
    weight[[0, -1]] /= 2
    lifted = rows.lifted(path, gravity, start, np.arange(count + 1) / rate)
    return spectra(lifted, weight, window, time_powers=LIFTED_TIME_POWERS, rounding=_rounding(path, start, window))


def spectra(
    matrix: Float[Array, "w k n"],
    weight: Float[Array, "k"],
    window: float,
    *,
    time_powers: Int[Array, "n"],
    rounding: float,
) -> Spectrum:
    """Spectra of Σ weight hᵀh. QR first: the singular values of R are those of H, and both unit systems share it."""
    R = np.linalg.qr(matrix * np.sqrt(weight)[:, None], mode="r")
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
        null_basis=_null_basis(in_units, rank),
    )


def _null_basis(matrix: Float[Array, "w n n"], rank: Int[Array, "w"]) -> tuple[Array, ...]:
    """The last right singular vectors of each window; only blind windows pay for vectors, twice the price of values."""
    right, blind = np.zeros_like(matrix), rank < matrix.shape[-1]
    right[blind] = np.linalg.svd(matrix[blind])[2]
    return tuple(right[i, r:].T for i, r in enumerate(rank))


def worst(spectrum: Spectrum) -> int:
    """The window that sees least: the lowest rank, then the smallest of the singular values that count."""
    last = np.take_along_axis(spectrum.scaled, spectrum.rank[:, None] - 1, axis=1)[:, 0]
    return int(np.lexsort((last, spectrum.rank))[0])


def _rounding(path: Signal, start: Float[Array, "w"], window: float) -> float:
    """The rows' absolute rounding error: positions of size |p| and velocities times δ are subtracted in D.

    A path that no bound is known of, because it drifts or jumps, is as large as it is seen to be.
    """
    path = bent(path)
    sizes = [path.bound(order) for order in (0, 1)]
    if not math.isfinite(sum(sizes)):
        time = np.append(start, start[-1] + window)
        sizes = [float(np.linalg.norm(path(time, order), axis=-1).max()) for order in (0, 1)]
    return ROUNDING * (sizes[0] + window * sizes[1])
