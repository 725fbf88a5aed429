"""Consistency: does the observer's covariance match its errors? Normalised squares with chi-square bands.

    NIS  = (y − ŷ)²/S,  S = P₁₁ + R       1 on average if P and R are right
    NEES = eᵀ P⁻¹ e,  e = p̂ − p           3 on average, the degrees of freedom of a position

The mean of N independent values with k degrees of freedom lies between the 2.5 and 97.5 % points of χ²(N k)/N. Above
the band the covariance is too small, below it too large. With constant gains P follows from the chosen q and v and not
from the noise (paper, eq. 8); only noise-matched gains are meant to be inside the band.
"""

import numpy as np
import scipy
from jaxtyping import Bool, Float, Int
from numpy import ndarray as Array

from rangenav.results import result

SHARE = 0.95
"""The share of the values of a consistent observer that lie inside the band."""
WINDOWS = 500
"""Values at most, as many as a plot can show."""


@result
class Consistency:
    """A mean of normalised squares over time, between its bounds."""

    time: Float[Array, "k"]
    """s"""
    mean: Float[Array, "k"]
    """NaN where there is nothing to average, or the covariance has diverged."""
    low: Float[Array, "k"]
    high: Float[Array, "k"]
    expected: float
    """The degrees of freedom: the mean of a consistent observer."""

    @property
    def inside(self) -> float:
        """Share of the values inside the band, NaN without any; neighbours are not independent of one another."""
        return self._share((self.mean >= self.low) & (self.mean <= self.high))

    @property
    def above(self) -> float:
        """Share of the values above the band: errors larger than the covariance says."""
        return self._share(self.mean > self.high)

    @property
    def summary(self) -> str:
        """The shares as a sentence."""
        if np.isnan(self.inside):
            return "nothing to judge by"
        below = self._share(self.mean < self.low)
        return f"{self.inside:.0%} inside the {SHARE:.0%} band, {self.above:.0%} too sure, {below:.0%} too cautious"

    def _share(self, there: Array) -> float:
        finite = np.isfinite(self.mean)
        return float(np.mean(there[finite])) if finite.any() else np.nan


def band(freedom: Int[Array, "k"], *, share: float = SHARE) -> tuple[Float[Array, "k"], Float[Array, "k"]]:
    """Bounds between which χ²(freedom) lies with probability `share`, as much outside on either side; 0, ∞ for none."""
    low, high = (2 * scipy.special.gammaincinv(freedom / 2, point) for point in ((1 - share) / 2, (1 + share) / 2))
    return np.where(freedom > 0, low, 0.0), np.where(freedom > 0, high, np.inf)


def innovations(innovation: Float[Array, "m 2"]) -> Float[Array, "m"]:
    """NIS of every range from y − ŷ and its variance; NaN where there is none."""
    error, variance = innovation[:, 0], innovation[:, 1]
    with np.errstate(invalid="ignore", over="ignore"):
        return np.where(variance > 0, error**2 / np.where(variance > 0, variance, 1.0), np.nan)


def errors(error: Float[Array, "n d"], covariance: Float[Array, "n d d"]) -> Float[Array, "n"]:
    """NEES eᵀP⁻¹e at every time; NaN where P is not positive and finite."""
    finite = np.asarray(np.isfinite(covariance).all(axis=(1, 2)) & np.isfinite(error).all(axis=1))
    P = np.where(finite[:, None, None], covariance, np.eye(error.shape[1]))
    usable = finite & _positive(P)
    P[~usable] = np.eye(error.shape[1])
    square = np.einsum("ni,ni->n", error, np.linalg.solve(P, error[:, :, None])[:, :, 0])
    return np.where(usable, square, np.nan)


def _positive(P: Float[Array, "n d d"]) -> Bool[Array, "n"]:
    """Where P is positive definite. Cholesky decides it for all of them at once in a third of the time, if all are."""
    try:
        np.linalg.cholesky(P)
    except np.linalg.LinAlgError:
        return np.linalg.eigvalsh(P)[:, 0] > 0
    return np.ones(len(P), dtype=bool)


def sliding(square: Float[Array, "m"], time: Float[Array, "m"], *, window: float, freedom: int = 1) -> Consistency:
    """The mean over the last `window` seconds, at up to 500 times from the first whole window on.

    The band assumes that the values are independent. The innovations of a consistent observer are, its errors are not.
    """
    ends = np.flatnonzero(time >= (time[0] if len(time) else 0.0) + window)
    ends = ends[np.unique(np.linspace(0, len(ends) - 1, WINDOWS).round().astype(int))] if len(ends) else ends
    first = np.searchsorted(time, time[ends] - window, side="right")
    spans = np.column_stack([first, ends + 1]).ravel()
    finite = np.isfinite(square)
    # each window summed by itself: differences of one running sum would drown in a large transient
    total, number = (np.add.reduceat(np.append(np.where(finite, values, 0), 0), spans)[::2] for values in (square, 1))
    return _consistency(time[ends], total, number.astype(int), freedom)


def averaged(
    square: Float[Array, "s k"], time: Float[Array, "k"], *, count: Int[Array, "s k"] | None = None, freedom: int
) -> Consistency:
    """The mean over seeds at every time; `count` says how many independent values each entry is the mean of, else 1."""
    finite = np.isfinite(square)
    number = np.where(finite, 1 if count is None else count, 0)
    total = np.sum(np.where(finite, square, 0.0) * number, axis=0)
    return _consistency(time, total, number.sum(axis=0), freedom)


def _consistency(time: Array, total: Array, number: Array, freedom: int) -> Consistency:
    low, high = band(number * freedom)
    several = np.maximum(number, 1)
    return Consistency(
        time=time,
        mean=np.where(number > 0, total / several, np.nan),
        low=low / several,
        high=high / several,
        expected=float(freedom),
    )
