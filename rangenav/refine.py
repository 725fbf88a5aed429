"""Refinement of a whole record: an iterated Kalman smoother, which is Gauss–Newton on the nonlinear problem.

    minimise over x_k:  Σ (d − |p − p_anchor|)²/σ_d² + Σ |m_y − Rᵀm|²/σ_m² + Σ |w_a|²/q_a + Σ |w_ω|²/q_ω

with x_{k+1} = f(x_k) ⊕ (w_a, w_ω), nine states each: position, velocity, attitude. The attitude is
R_k = exp([φ_k]x) R̂_k, with R̂_k turned by the gyro. In axes turned by R̂_k the errors have the transition of a free
particle, and their noise is the same at every step. Each pass filters the errors about the last trajectory forward in
time, and smooths them backward by the modified Bryson–Frazier adjoint.

Gauss–Newton converges only from near the minimum. The cascade's last estimate is near it, whatever the cascade's start.
An extended Kalman filter starts at that estimate and runs over the reversed record; the first pass is linearised about
its trajectory. Rejected: integrating gyro and accelerometer alone backwards from the last estimate. That drifts by
metres; it takes 16 passes instead of 7 over 20 s of the paper's path, and over 60 s one record in ten converges instead
of all.

A wrong minimum has a poor fit. At the right one the RMS residual of n ranges is 1 σ to within 1/√(2n). Where it is
larger, the record is smoothed again, from a filter that trusts the last estimate more, and then from one that trusts it
less; the best fit is the result. Where the nonlinear problem has two solutions, as a circle and its mirror image, both
fit equally well.
"""

import math
from dataclasses import dataclass, replace
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy import ndarray as Array

from rangenav import strapdown
from rangenav.baselines import filtered
from rangenav.cascade import Estimate, ObserverConfig
from rangenav.inputs import Vec3, require
from rangenav.kernels.layout import Strapdown
from rangenav.model import POSITION, VELOCITY
from rangenav.motion import to_inertial
from rangenav.results import result
from rangenav.sensors import Measurements
from rangenav.strapdown import STATES, Attached, Track

START_SIGMA = (0.5, 0.5, 0.1)
"""m, m/s, rad: 1 σ of the cascade's last estimate, for the filter on the reversed record. 0.3 to 1 m are equally good;
3 m is worse."""
TRUST = (1.0, 0.3, 4.0)
"""Factors of START_SIGMA, used one after the other while the fit is poor. A circle with a ripple of 6 cm across its
plane has its mirror image as a second minimum. Of 20 such records 3 end in the wrong minimum with the first factor and
none after the second; of 20 records of the repaired figure eight, 2 and none."""
POOR = 4.0
"""A fit that exceeds 1 by more standard deviations than this is poor, and not by chance."""
REACH = (1.0, 1.0, 0.3)
"""m, m/s, rad: 1 σ of a prior about the first state of the last trajectory, so about how far one pass may move it. It
limits what the ranges do not determine, and does not bias what they do. 10 m is as good for observable motions; weak
ones then change by metres from pass to pass. Rejected: undoing a pass that raises the cost, which ends in a wrong
minimum more often."""
PRIOR_SIGMA = (10.0, 10.0, 1.0)
"""The same for the reported covariance: wide enough not to affect what the record determines."""
MAX_PASSES = 30
SMALL_STEP = 1e-4
"""m and rad; the passes end when no sample moves by more. The refined position itself has errors of 1e-2 m."""
WORST_FIT = 1.5
"""The ranges' residuals should be 1 σ. With a larger fit the minimum is wrong, or the noise is larger than stated."""


@dataclass(frozen=True, kw_only=True)
class Pass:
    """One Gauss–Newton pass."""

    cost: float
    """Cost per scalar measurement of the trajectory that the pass started from; about 1 at the right minimum."""
    step: float
    """m: the largest change of a sample's position."""
    turn: float
    """rad: the largest change of a sample's attitude."""


@result
class Refinement:
    """A smoothed record, and the passes that led to it."""

    track: Track
    """Smoothed estimates and covariances; `innovation` holds the ranges' residuals along the smoothed trajectory."""
    passes: tuple[Pass, ...]
    converged: bool
    fit: float
    """RMS residual of the ranges in units of their σ."""
    starts: int = 1
    """How many starts were tried; more than one if the first fitted poorly."""

    @property
    def summary(self) -> str:
        """How the passes ended, in one sentence."""
        count, last = len(self.passes), self.passes[-1]
        if not np.isfinite(last.step):
            return f"diverged: pass {count} is not finite"
        if not self.converged:
            return f"stopped after {count} passes: the last one still moved the position by {last.step:.2g} m"
        if self.fit > WORST_FIT:
            return f"converged after {count} passes, but ranges are off by {self.fit:.1f} σ: a wrong minimum or noise"
        return f"converged after {count} passes" + (f", the best of {self.starts} starts" if self.starts > 1 else "")


def refine(measurements: Measurements, estimate: Estimate, setting: ObserverConfig) -> Refinement:
    """Refine a record that the cascade has observed, starting from its last estimate.

    If the fit is poor, the refinement is repeated from up to two more starts, and takes two or three times as long.
    Raises ValueError for arrays of the wrong shape or type, stamps out of order, numbers that are not finite, a record
    without ranges, or one that is too long.
    """
    refined: list[Refinement] = []
    for trust in TRUST:
        refined.append(smooth(measurements, start_trajectory(measurements, estimate, setting, trust), setting))
        if refined[-1].fit <= 1 + POOR / math.sqrt(2 * len(measurements.range)):
            break
    best = min(refined, key=lambda one: one.fit if math.isfinite(one.fit) else math.inf)
    return replace(best, starts=len(refined))


def start_trajectory(
    measurements: Measurements, estimate: Estimate, setting: ObserverConfig, trust: float = 1.0
) -> Track:
    """The trajectory about which the first pass is linearised, inertial axes.

    It is that of the filter on the reversed record, which starts at the cascade's last estimate with a 1 σ of
    `trust` × START_SIGMA.
    """
    covariance = np.diag(np.repeat(np.square(trust * np.array(START_SIGMA)), 3))
    rotation = estimate.rotation[-1]
    position = np.asarray(setting.world.anchor) + to_inertial(rotation, estimate.state[-1, POSITION])
    velocity = to_inertial(rotation, estimate.state[-1, VELOCITY])
    backwards = strapdown.reversed_record(strapdown.check(measurements))
    return strapdown.reversed_track(filtered(backwards, (position, -velocity, rotation), covariance, setting))


def smooth(measurements: Measurements, nominal: Track, setting: ObserverConfig) -> Refinement:
    """Gauss–Newton passes from any trajectory with one row for each IMU sample. Raises ValueError as `refine` does."""
    z = strapdown.check(measurements)
    nominal = strapdown.check_track(nominal, len(z.time))
    p, attached = strapdown.parameters(setting), strapdown.attach(z)
    require(len(attached.sample) > 0, "a refinement needs ranges, and the record has none")
    anchor = np.asarray(setting.world.anchor, dtype=float)
    reached = _Trajectory(nominal.position - anchor, nominal.velocity.copy(), nominal.rotation.copy())
    work, residuals = workspace(z, attached), np.full((len(z.range), 2), np.nan)
    with np.errstate(all="ignore"):
        passes, converged = _iterate(z, attached, reached, work, p)
        _finish(z, attached, reached, work, residuals, p)
        fit = float(np.sqrt(np.mean(residuals[attached.kept, 0] ** 2 / p.range_variance)))
    track = Track(
        time=z.time,
        position=reached.position + anchor,
        velocity=reached.velocity,
        rotation=reached.rotation,
        covariance=work.covariances.reshape(-1, STATES, STATES),
        innovation=residuals,
    )
    return Refinement(track=track, passes=tuple(passes), converged=converged, fit=fit)


class _Trajectory(NamedTuple):
    """Positions from the anchor, velocities and rotations; the passes move them in place."""

    position: Array
    velocity: Array
    rotation: Array


class Workspace(NamedTuple):
    """Arrays in which the forward half of a pass stores its results for the backward half; see the kernel."""

    errors: Array
    covariances: Array
    accelerations: Array
    kept: Array
    corrected: Array


def workspace(z: Measurements, attached: Attached) -> Workspace:
    """Arrays of the sizes that the kernels need for a record; their content is undefined."""
    count = len(z.time)
    corrections = len(attached.sample) + 2 * int(np.sum(~np.isnan(z.mag).any(axis=-1)))
    return Workspace(
        errors=np.empty((count, STATES)),
        covariances=np.empty((count, STATES * STATES)),
        accelerations=np.zeros((count, 3)),
        kept=np.empty((corrections, _kernel().KEPT)),
        corrected=np.empty(count, dtype=np.int64),
    )


def _iterate(
    z: Measurements, attached: Attached, reached: _Trajectory, work: Workspace, p: Strapdown
) -> tuple[list[Pass], bool]:
    """Passes until the step is small; `reached` is moved in place."""
    passes: list[Pass] = []
    while len(passes) < MAX_PASSES:
        cost = _forward(z, attached, reached, work, p, REACH)
        _kernel().backward(z.time, *work)
        step, turn = _kernel().apply(work.errors, *reached)
        passes.append(Pass(cost=cost, step=step, turn=turn))
        if not np.isfinite(step):
            return passes, False
        if max(step, turn) < SMALL_STEP:
            return passes, True
    return passes, False


def _forward(
    z: Measurements, attached: Attached, reached: _Trajectory, work: Workspace, p: Strapdown, sigma: Vec3
) -> float:
    """Linearise about the trajectory reached and filter; the cost of that trajectory per scalar measurement."""
    covariance = np.diag(np.repeat(np.square(sigma), 3)).ravel()
    cost = _kernel().forward(
        z.time, z.gyro, z.accel, z.mag, z.range[attached.kept], attached.sample, attached.back,
        *reached, np.zeros(STATES), covariance, *work, p,
    )  # fmt: skip
    return cost / len(work.kept)


def _finish(
    z: Measurements, attached: Attached, reached: _Trajectory, work: Workspace, residuals: Array, p: Strapdown
) -> None:
    """The smoothed covariances, left in `work`, and the residuals of all ranges."""
    _forward(z, attached, reached, work, p, PRIOR_SIGMA)
    _kernel().smooth_covariance(z.time, work.covariances, work.accelerations, p)
    _kernel().residuals(
        z.time, z.gyro, z.accel, z.range[attached.kept], attached.sample, attached.back,
        *reached, work.covariances, residuals[attached.kept], p,
    )  # fmt: skip


def _kernel() -> ModuleType:
    """The compiled kernel, imported where it is used: numba alone takes as long to import as everything else."""
    from rangenav.kernels import smoother as kernel

    return kernel
