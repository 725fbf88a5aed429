"""When an observer has diverged: by its own covariance, its innovations or its distance from the anchor; no truth.

    own σ of the position at the end ≥ 100 m, or no number
    innovations √10 times as large as gains that follow the noise expect (`range_fit`)
    r_k = |p̂(s_k)| − d_k:   RMS r over the last quarter > 3 max d, and above half of that of the quarter before

The last one is the rule for constant gains, whose covariance is a design quantity: the estimate is farther away than
any place that the ranges allow, and does not come back. One that comes back from a far start is still settling.
"""

import math
from dataclasses import replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model
from rangenav.cascade import Estimate
from rangenav.number_format import quantity
from rangenav.range_fit import RangeFit

MOST_RESIDUAL = 5.0
"""Standard deviations of a range by which the distance of an estimate from the anchor may be off the ranges (RMS)."""
LEAST_RESIDUAL = 0.1
"""m; a smaller residual is none, however exact the ranges are."""

MOST_STD = 1e2
"""m; with a larger 1-σ of its own position an observer has diverged, as it does on an unobservable motion."""
MOST_FACTOR = 10**0.5
"""Innovations that exceed their own σ by this factor on the average, in the last quarter."""
FALLING = 0.5
"""An estimate comes back if its distance is wrong by less than this share of that a quarter of the record before."""
FAR = 3.0
"""Multiples of the longest range by which the distance of an estimate from the anchor may be wrong."""


def divergence(
    estimate: Estimate, range_time: Float[Array, "m"], ranges: Float[Array, "m"], fit: RangeFit
) -> str | None:
    """Why an observer has diverged, one clause; None if it has not.

    range_time, ranges: s and m, those that it used. fit: how well it fits them.
    """
    own = own_sigma(estimate)
    if not own < MOST_STD:
        return f"its own 1-σ of the position is {quantity(own, 'm', otherwise='no number')} at the end"
    if fit.word == "overconfident" and fit.factor is not None and fit.factor > MOST_FACTOR:
        return f"its innovations are {fit.factor:.3g} times as large as it expects"
    before, last = range_residuals(estimate, range_time, ranges)
    longest = float(ranges.max()) if len(ranges) else math.inf
    if last > FAR * longest and last > FALLING * before:
        off, far = quantity(last, "m"), quantity(longest, "m")
        return f"its distance from the anchor is wrong by {off} and does not fall; the longest range is {far}"
    return None


def own_sigma(estimate: Estimate) -> float:
    """m: the largest of the three own 1-σ of the position at the end; NaN where the covariance has none."""
    variances = np.diagonal(estimate.covariance[-1, 0])
    sound = np.all(np.isfinite(variances)) and np.all(variances >= 0)
    return math.sqrt(float(variances.max())) if sound else math.nan


def range_residuals(
    estimate: Estimate, range_time: Float[Array, "m"], ranges: Float[Array, "m"]
) -> tuple[float, float]:
    """RMS of |p̂| − d (m) over the third and the last quarter of the ranges; NaN where a quarter has none."""
    third, last = (j * len(ranges) // 4 for j in (2, 3))
    k = np.clip(np.searchsorted(estimate.time, range_time[third:], side="right") - 1, 0, None)
    with np.errstate(over="ignore", invalid="ignore"):
        off = np.linalg.norm(estimate.state[:, model.POSITION][k], axis=-1) - ranges[third:]
        parts = off[: last - third], off[last - third :]
        before, after = (float(np.sqrt(np.mean(part**2))) if len(part) else math.nan for part in parts)
    return before, after


def with_residual(
    fit: RangeFit, estimate: Estimate, range_time: Float[Array, "m"], ranges: Float[Array, "m"], range_sigma: float
) -> RangeFit:
    """The fit, with how far the position is off its ranges (m) where that contradicts a good fit.

    That is more than 5 range_sigma (m), and than 0.1 m, above the own 1-σ of the position. The own σ of constant gains
    does not count: it is a design quantity.
    """
    residual = range_residuals(estimate, range_time, ranges)[1]
    own = 0.0 if fit.mode == "constant" else own_sigma(estimate)
    far = math.isfinite(residual) and residual > max(MOST_RESIDUAL * range_sigma, LEAST_RESIDUAL) + own
    return replace(fit, off=residual) if far else fit
