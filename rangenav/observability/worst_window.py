"""The window that sees least: the lowest rank, then the smallest of the scaled singular values that count."""

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy import ndarray as Array

from rangenav.model import STATES
from rangenav.observability import gramian_rank, pseudoinverse
from rangenav.observability.gramian_rank import Remainders
from rangenav.observability.spectrum import Spectrum, tolerance

NEARLY = 1e-6
"""Relative: singular values of inverses that are nearer to each other are compared by decompositions."""


def of_spectrum(spectrum: Spectrum) -> int:
    """Among windows whose spectra are known."""
    return _worst(spectrum.scaled, spectrum.rank)


def of_remainders(of: Remainders) -> int:
    """Among windows whose remainders are known. Only windows that may be the worst are decomposed."""
    inner, counts = gramian_rank.regular(of)
    if counts.all():
        chosen = np.flatnonzero(_may_be_largest(pseudoinverse.with_remainders(of, inner)))
    else:
        rank = np.full(len(counts), STATES)
        rank[~counts] = of.some(~counts).rank
        chosen = np.flatnonzero(rank == rank.min())
    some = of.some(chosen)
    inverse, unseen = pseudoinverse.of_rows(some), pseudoinverse.unseen(some, np.ones(STATES))
    largest = pseudoinverse.singular_values(inverse, unseen)[:, -1]
    return int(chosen[np.argmin(1 / np.maximum(largest, np.finfo(float).tiny))])


def _may_be_largest(matrix: Float[Array, "w n n"]) -> Bool[Array, "w"]:
    """Which matrices may have the largest singular value of all: with S = AAᵀ, |S|²/tr S ≤ σ² ≤ |S|."""
    product = matrix @ matrix.swapaxes(1, 2)
    size = np.linalg.norm(product, axis=(1, 2))
    least = size * (size / np.trace(product, axis1=1, axis2=2))
    return size >= least.max() * (1 - NEARLY)


def of_triangles(R: Float[Array, "w n n"], window: float, *, time_powers: Int[Array, "n"], rounding: float) -> int:
    """Among windows whose triangles are known, at half the work of their spectra."""
    scaled = np.linalg.svd(R * window ** -time_powers.astype(float), compute_uv=False)
    return _worst(scaled, np.sum(scaled > tolerance(scaled, rounding)[:, None], axis=-1))


def _worst(scaled: Float[Array, "w n"], rank: Int[Array, "w"]) -> int:
    last = np.take_along_axis(scaled, rank[:, None] - 1, axis=1)[:, 0]
    return int(np.lexsort((last, rank))[0])
