"""The accuracy that was predicted, compared with the accuracy achieved over many seeds.

The predictions (`analysis`) use the ranges of one window and no IMU noise. The observer has IMU noise, and uses earlier
windows as well: its error may be smaller or larger than the Cramér–Rao bound of the window.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.analysis import Analysis
from rangenav.ensemble.values import Ensemble
from rangenav.results import result


@result
class Achieved:
    """1-σ position errors as sqrt(trace), m, at the ends of the analysis's windows."""

    time: Float[Array, "w"]
    """s, where the windows end."""
    cramer_rao: Float[Array, "w"]
    """Of the window's ranges alone, nonlinear; NaN where they do not determine the position."""
    lifted: Float[Array, "w"]
    """The same of the lifted problem."""
    achieved: Float[Array, "w"]
    """Root mean square error over the runs."""
    estimated: Float[Array, "w"]
    """The observer's own 1-σ, median over the runs."""


def achieved(runs: Ensemble, analysis: Analysis) -> Achieved:
    """The predicted, the achieved and the estimated accuracy; both arguments must come from the same preset."""
    windows = analysis.windows
    time = windows.start + windows.window
    rms = np.sqrt(np.mean(runs.position**2, axis=0))
    return Achieved(
        time=time,
        cramer_rao=windows.sigma_nonlinear,
        lifted=windows.sigma_lifted,
        achieved=np.interp(time, runs.time, rms),
        estimated=np.interp(time, runs.time, runs.band("sigma").median),
    )
