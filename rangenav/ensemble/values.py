"""What is kept of many runs of one preset: curves on a grid of times, figures of each run, and the middle of both."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int, Shaped
from numpy import ndarray as Array

from rangenav import consistency
from rangenav.results import result

TENTHS = (0.1, 0.5, 0.9)


class Spread(NamedTuple):
    """The middle of many figures; infinite where too few runs settle."""

    low: float
    """A tenth of the runs lie below."""
    median: float
    high: float
    """A tenth of the runs lie above."""


@result
class Band:
    """The middle of many curves."""

    low: Float[Array, "t"]
    """A tenth of the runs lie below."""
    median: Float[Array, "t"]
    high: Float[Array, "t"]
    """A tenth of the runs lie above."""


@result
class Ensemble:
    """The results of each run, a row for each; errors as in `record`: norms in body axes, SI, attitude in rad."""

    time: Float[Array, "t"]
    """s, the grid of the curves."""
    seed: Int[Array, "s"]
    position: Float[Array, "s t"]
    velocity: Float[Array, "s t"]
    gravity: Float[Array, "s t"]
    attitude: Float[Array, "s t"]
    sigma: Float[Array, "s t"]
    """m, the observer's own 1-σ position as sqrt(trace); NaN where P has diverged."""
    nees: Float[Array, "s t"]
    """Normalised square of the position error, three degrees of freedom."""
    nis: Float[Array, "s t"]
    """Mean normalised square of the innovations since the time before; NaN without any."""
    nis_count: Int[Array, "s t"]
    """How many innovations that were."""
    settle_position: Float[Array, "s"]
    """s, as in `record.Summary`; infinite where it does not settle."""
    settle_attitude: Float[Array, "s"]
    steady_position: Float[Array, "s"]
    """RMSE over the last quarter, as all steady ones."""
    steady_velocity: Float[Array, "s"]
    steady_gravity: Float[Array, "s"]
    steady_attitude_deg: Float[Array, "s"]
    peak_position: Float[Array, "s"]
    held: Bool[Array, "s"]
    """Both errors stayed below 0.3 m and 5° over the last second."""
    fit: Shaped[Array, "s"]
    """Of objects: a `RangeFit` for each run."""

    @property
    def settled(self) -> Bool[Array, "s"]:
        """Runs whose position and attitude both settle."""
        return np.isfinite(self.settle_position) & np.isfinite(self.settle_attitude)

    def band(self, curve: Literal["position", "velocity", "gravity", "attitude", "sigma"]) -> Band:
        """Median and 10–90 % over the runs at each time."""
        low, median, high = middle(getattr(self, curve))
        return Band(low=low, median=median, high=high)

    @property
    def position_consistency(self) -> consistency.Consistency:
        """NEES averaged over the runs; meant for `seeds`, since random starts share their records."""
        return consistency.averaged(self.nees, self.time, freedom=3)

    @property
    def innovation_consistency(self) -> consistency.Consistency:
        """NIS averaged over the runs and over the ranges since the time before; meant for `seeds`."""
        return consistency.averaged(self.nis, self.time, count=self.nis_count, freedom=1)


def middle(values: Array) -> Array:
    """10, 50 and 90 % along the first axis; one of the values itself, so that infinite ones do no harm."""
    return np.quantile(np.where(np.isnan(values), np.inf, values), TENTHS, axis=0, method="inverted_cdf")
