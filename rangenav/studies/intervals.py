"""What the runs of a point say together: the middle of a metric, and its 95 % confidence interval.

    mean     x̄ ± t₀.₉₇₅(n − 1) s / √n
    median   from the j-th least to the j-th largest value, with the largest j for which P(Bin(n, ½) < j) ≤ 0.025
    share    of the runs that say yes (1): Wilson's interval
A median is finite if more than half of the runs are, and its interval supposes no distribution, so a time that some
runs never reach has both. NaN is left out.
"""

from typing import Literal

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array
from scipy.special import bdtr, ndtri, stdtrit

Middle = Literal["mean", "median", "share"]
TAIL = 0.025
"""On either side of the interval."""


def middle(values: Float[Array, "*e n"], kind: Middle) -> Float[Array, "*e"]:
    """The mean, the median or the share over the last axis; NaN of no value."""
    count = _count(values)
    with np.errstate(all="ignore"):
        if kind == "median":
            return (_ranked(values, (count - 1) // 2) + _ranked(values, count // 2)) / 2
        return np.nansum(values, axis=-1) / count


def interval(values: Float[Array, "*e n"], kind: Middle) -> tuple[Float[Array, "*e"], Float[Array, "*e"]]:
    """The ends of the interval of the middle; NaN of too few values, which for a mean is 1, and for a median 5."""
    count = _count(values)
    if kind == "median":
        ranks = np.arange(int(count.max(initial=0)) // 2 + 1)
        rank = np.sum(bdtr(ranks, count[..., None], 0.5) <= TAIL, axis=-1)
        enough = rank > 0
        ends = (_ranked(values, rank - 1), _ranked(values, count - rank))
        return np.where(enough, ends[0], np.nan), np.where(enough, ends[1], np.nan)
    with np.errstate(all="ignore"):
        of = middle(values, kind)
        if kind == "share":
            square = ndtri(1 - TAIL) ** 2 / count
            centre, width = of + square / 2, np.sqrt(square * of * (1 - of) + square**2 / 4)
            return np.maximum(centre - width, 0) / (1 + square), np.minimum(centre + width, 1 + square) / (1 + square)
        square = np.nansum((values - of[..., None]) ** 2, axis=-1) / (count - 1)
        width = np.where(count > 1, stdtrit(np.maximum(count - 1, 1), 1 - TAIL) * np.sqrt(square / count), np.nan)
        return of - width, of + width


def relative_half_width(values: Float[Array, "*e n"], kind: Middle) -> Float[Array, "*e"]:
    """Half the interval over |mean| or |median|; of a share, half the interval itself. 0 where all values are 0."""
    low, high = interval(values, kind)
    with np.errstate(all="ignore"):
        width = (high - low) / 2
        return width if kind == "share" else np.where(width == 0, 0.0, width / np.abs(middle(values, kind)))


def _count(values: Float[Array, "*e n"]) -> Int[Array, "*e"]:
    return np.sum(~np.isnan(values), axis=-1)


def _ranked(values: Float[Array, "*e n"], rank: Int[Array, "*e"]) -> Float[Array, "*e"]:
    """The value of a rank, from 0, among those of the last axis; NaN, which comes last, of none."""
    if values.shape[-1] == 0:
        return np.full(values.shape[:-1], np.nan)
    ordered, place = np.sort(values, axis=-1), np.clip(rank, 0, values.shape[-1] - 1)
    return np.take_along_axis(ordered, place[..., None], axis=-1)[..., 0]
