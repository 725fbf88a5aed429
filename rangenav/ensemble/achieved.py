"""Predicted accuracy beside the one reached over many seeds.

The predictions (analysis) know one window of ranges and no IMU noise; the observer remembers earlier windows and has
IMU noise: it may do better or worse than the Cramér–Rao bound of the window.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.analysis import Analysis
from rangenav.ensemble.runs import Ensemble
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
    reached: Float[Array, "w"]
    """Root mean square over the runs."""
    believed: Float[Array, "w"]
    """The observer's own, median over the runs."""


def achieved(runs: Ensemble, found: Analysis) -> Achieved:
    """What was predicted, what was reached and what the observer believes; both arguments from the same preset."""
    windows = found.windows
    time = windows.start + windows.window
    rms = np.sqrt(np.mean(runs.position**2, axis=0))
    return Achieved(
        time=time,
        cramer_rao=windows.sigma_nonlinear,
        lifted=windows.sigma_lifted,
        reached=np.interp(time, runs.time, rms),
        believed=np.interp(time, runs.time, runs.band("sigma").median),
    )
