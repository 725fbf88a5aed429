"""Is the observer consistent: does its covariance P describe its errors, and are they as small as predicted?

    NIS = ν²/S lies below its 95 % point for 95 % of the ranges;   NEES = eᵀP⁻¹e is 3 on average, for a position
All figures are over the steady part of a run, its last quarter. Neighbouring samples of one run are correlated, so the
mean over a run has no confidence band; its single values have one, and so has the mean over many seeds.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from explorer.model.compute import Picture
from rangenav import consistency, ensemble
from rangenav.analysis import Analysis
from rangenav.consistency import Consistency
from rangenav.ensemble import Ensemble
from rangenav.model import POSITION
from rangenav.motion import to_body

STEADY = 0.75
"""Share of the run after which the steady part begins."""
AXES = 3
"""Degrees of freedom of a position."""


@dataclass(frozen=True, kw_only=True)
class RunConsistency:
    """Figures of one run, or of many seeds; NaN where there is no data."""

    nis: float
    """Mean."""
    nis_inside: float
    """Share of NIS values inside the 95 % band: of single values for a run, of the mean for seeds."""
    nees: float
    """Mean."""
    nees_low: float
    nees_high: float
    """The 95 % band: of single values for a run, of the mean for seeds."""
    nees_inside: float
    """Share of the steady part in which NEES lies inside the band."""
    cramer_rao: float
    """m, predicted 1-σ position from a window's ranges alone, nonlinear."""
    lifted: float
    """m, the same for the lifted problem."""
    estimated: float
    """m, the observer's own √tr P."""
    achieved: float
    """m, the RMS position error."""

    @property
    def summary(self) -> str:
        """Whether P is too small, too large, or consistent with the errors."""
        if np.isnan(self.nees):
            return "nothing to judge by"
        if self.nees > self.nees_high:
            return "too sure of itself: errors are larger than P says"
        return "too cautious: errors are smaller than P says" if self.nees < self.nees_low else "consistent"


def of_run(picture: Picture) -> RunConsistency:
    """The figures of the shown run."""
    time, z, estimate = picture.motion.time, picture.measurements, picture.estimate
    part = _steady(time)
    trajectory, anchor = picture.motion, np.asarray(picture.preset.world.anchor)
    error = estimate.state[part, POSITION] - to_body(trajectory.rotation[part], trajectory.position[part] - anchor)
    P = estimate.covariance[part, 0]
    nees = consistency.errors(error, P)
    nis = consistency.innovations(estimate.innovation)[_steady(z.range_time)]
    low, high = (float(end[0]) for end in consistency.band(np.array([AXES])))
    nis_low, nis_high = (float(end[0]) for end in consistency.band(np.array([1])))
    cramer_rao, lifted = _predicted(picture.analysis)
    with np.errstate(invalid="ignore"):
        estimated = float(np.sqrt(np.mean(np.trace(P, axis1=-2, axis2=-1))))
    return RunConsistency(
        nis=_mean(nis),
        nis_inside=_share(nis, nis_low, nis_high),
        nees=_mean(nees),
        nees_low=low,
        nees_high=high,
        nees_inside=_share(nees, low, high),
        cramer_rao=cramer_rao,
        lifted=lifted,
        estimated=estimated,
        achieved=picture.summary.steady_position,
    )


def of_seeds(runs: Ensemble, analysis: Analysis) -> RunConsistency:
    """The figures of many seeds of the same settings."""
    nees, nis, achieved = runs.position_consistency, runs.innovation_consistency, ensemble.achieved(runs, analysis)
    part = _steady(nees.time)
    end = achieved.time >= STEADY * float(runs.time[-1])
    cramer_rao, lifted = _predicted(analysis)
    return RunConsistency(
        nis=_mean(nis.mean[_steady(nis.time)]),
        nis_inside=_inside(nis, _steady(nis.time)),
        nees=_mean(nees.mean[part]),
        nees_low=float(np.median(nees.low[part])),
        nees_high=float(np.median(nees.high[part])),
        nees_inside=_inside(nees, part),
        cramer_rao=cramer_rao,
        lifted=lifted,
        estimated=_rms(achieved.estimated[end]),
        achieved=float(np.sqrt(np.mean(np.square(runs.steady_position)))),
    )


def _predicted(analysis: Analysis) -> tuple[float, float]:
    """Predicted 1-σ position (m), nonlinear and lifted: RMS over the windows that end in the steady part."""
    windows = analysis.windows
    ends = windows.start + windows.window
    part = ends >= STEADY * float(ends[-1])
    return _rms(windows.sigma_nonlinear[part]), _rms(windows.sigma_lifted[part])


def _steady(time: Float[Array, "n"]) -> Bool[Array, "n"]:
    return time >= STEADY * float(time[-1]) if len(time) else np.zeros(0, dtype=bool)


def _inside(statistic: Consistency, part: Bool[Array, "n"]) -> float:
    """Share of the finite means of a part that lie inside their band."""
    mean = statistic.mean[part]
    inside = (mean >= statistic.low[part]) & (mean <= statistic.high[part])
    finite = np.isfinite(mean)
    return float(np.mean(inside[finite])) if finite.any() else np.nan


def _share(square: Float[Array, "n"], low: float, high: float) -> float:
    """Share of the finite values that lie between low and high."""
    finite = square[np.isfinite(square)]
    return float(np.mean((finite >= low) & (finite <= high))) if len(finite) else np.nan


def _mean(square: Float[Array, "n"]) -> float:
    finite = square[np.isfinite(square)]
    return float(np.mean(finite)) if len(finite) else np.nan


def _rms(sigma: Float[Array, "n"]) -> float:
    """NaN if any σ is NaN: a blind window has none."""
    with np.errstate(invalid="ignore", over="ignore"):
        return float(np.sqrt(np.mean(np.square(sigma)))) if len(sigma) else np.nan
