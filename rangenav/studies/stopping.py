"""When a point has runs enough: the 95 % confidence interval of a metric's mean is narrow against the mean.

    t₀.₉₇₅(n − 1) s / √n  ≤  half_width · |x̄|
The rule is judged after `least` runs and after every further `least`, so that neither the order nor the number of
workers decides how many runs a point has.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from scipy.special import stdtrit

from rangenav.inputs import Input, require, require_within

CONFIDENCE = 0.95


class Stop(Input, frozen=True, kw_only=True):
    """A stopping rule, for each point by itself; every estimator has to meet it."""

    metric: str
    """A metric of a run."""
    half_width: float
    """Of the interval, relative to the mean: 0.05 is ± 5 %."""
    least: int = 8

    def __post_init__(self) -> None:
        super().__post_init__()
        require(0 < self.half_width < 1, f"half_width must lie between 0 and 1, got {self.half_width:g}")
        require_within("least", self.least, 2, 1000)

    def met(self, values: Float[Array, "e n"]) -> bool:
        """Whether the runs so far are enough, of every estimator; NaN and infinite values are never enough."""
        count = values.shape[1]
        if count < self.least or count % self.least:
            return False
        return bool(np.all(relative_half_width(values) <= self.half_width))


def half_width(values: Float[Array, "*e n"]) -> Float[Array, "*e"]:
    """Half the 95 % interval of the mean over the last axis, NaN left out; NaN of fewer than two values."""
    with np.errstate(all="ignore"):
        counted = ~np.isnan(values)
        count = counted.sum(axis=-1)
        freedom = np.maximum(count - 1, 1)
        middle = mean(values)
        square = np.where(counted, (values - middle[..., None]) ** 2, 0.0).sum(axis=-1)
        width = stdtrit(freedom, (1 + CONFIDENCE) / 2) * np.sqrt(square / freedom / np.maximum(count, 1))
    return np.where(count > 1, width, np.nan)


def relative_half_width(values: Float[Array, "*e n"]) -> Float[Array, "*e"]:
    """The half width over |mean|; 0 where all values are 0."""
    width = half_width(values)
    with np.errstate(all="ignore"):
        return np.where(width == 0, 0.0, width / np.abs(mean(values)))


def mean(values: Float[Array, "*e n"]) -> Float[Array, "*e"]:
    """The mean over the last axis, NaN left out; NaN of none."""
    counted = ~np.isnan(values)
    count = counted.sum(axis=-1)
    with np.errstate(all="ignore"):
        return np.where(count > 0, np.where(counted, values, 0.0).sum(axis=-1) / np.maximum(count, 1), np.nan)
