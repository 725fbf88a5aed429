"""When a point has runs enough: the 95 % confidence interval of a metric is narrow against its mean or median.

    half of the interval  ≤  half_width · |middle|        of a share:  half of the interval  ≤  half_width
The rule is judged after `least` runs and after every further `least`, so that neither the order nor the number of
workers decides how many runs a point has.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Input, require, require_within
from rangenav.studies import intervals
from rangenav.studies.metrics import METRICS


class Stop(Input, frozen=True, kw_only=True):
    """A stopping rule, for each point by itself; every estimator has to meet it."""

    metric: str
    """A metric of a run."""
    half_width: float
    """Of the interval, relative to the mean or the median: 0.05 is ± 5 %. Of a share, in itself."""
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
        return bool(np.all(intervals.relative_half_width(values, METRICS[self.metric].middle) <= self.half_width))
