"""The whole record refined: an iterated Kalman smoother, Gauss–Newton on the nonlinear nine-state problem.

    minimise over x_k:  Σ (d − |p − p_anchor|)²/σ_d² + Σ |m_y − Rᵀm|²/σ_m² + Σ |w_a|²/q_a + Σ |w_ω|²/q_ω
with x_k⁺ = f(x_k) ⊕ (w_a, w_ω). Attitude is kept as R_k = exp([φ_k]x) R̂_k and R̂_k turned by the gyro: in that derotated
frame the errors have the transition of a free particle and noise that is the same at every step. Each pass
filters the errors about the last trajectory forward and comes back by the modified Bryson–Frazier adjoint.
Gauss–Newton converges from near by only, and near is what the cascade gives from any start: its last estimate starts
the extended Kalman filter on the record run backwards, and where that has been the first pass is linearised.
Rejected: carrying the cascade's last estimate back by the gyro and accelerometer alone. It drifts by metres: 16
passes instead of 7 over 20 s of the paper's path, and after 60 s one record in ten converges instead of all.
"""

from dataclasses import dataclass
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy import ndarray as Array

from rangenav import strapdown
from rangenav.baselines import filtered
from rangenav.cascade import Estimate, Setting
from rangenav.kernels.layout import Strapdown
from rangenav.model import POSITION, VELOCITY
from rangenav.motion import to_inertial
from rangenav.sensors import Measurements
from rangenav.strapdown import STATES, Attached, Track

START_SIGMA = (0.5, 0.5, 0.1)
"""m, m/s, rad of the cascade's last estimate, for the filter that runs back; 0.3 to 1 m serve alike, 3 m is worse."""
PRIOR_SIGMA = (100.0, 100.0, 3.0)
"""m, m/s, rad about the first trajectory's first state: so wide that it decides only what nothing else does."""
MAX_PASSES = 20
SMALL_STEP = 1e-4
"""m and rad; the passes end when no sample moves by more. The refined position is good to 1e-2 m."""
WORST_FIT = 1.5
"""The residuals of ranges should be 1 σ; beyond this the minimum is another one, or the noise is not what was said."""


@dataclass(frozen=True, kw_only=True)
class Pass:
    """One Gauss–Newton pass."""

    cost: float
    """Of the trajectory it started from, per scalar measurement; about 1 at the minimum that is sought."""
    step: float
    """m: the farthest that any sample's position moved."""
    turn: float
    """rad: the same of the attitude."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Refinement:
    """A smoothed record, and how the passes went."""

    track: Track
    """Smoothed estimates and covariances; `innovation` holds the residuals of the ranges along the smoothed trajectory."""
    passes: tuple[Pass, ...]
    converged: bool
    fit: float
    """RMS residual of the ranges in units of their σ."""

    @property
    def words(self) -> str:
        """How it ended, in one sentence."""
        count, last = len(self.passes), self.passes[-1]
        if not np.isfinite(last.step):
            return f"diverged: pass {count} is not finite"
        if not self.converged:
            return f"stopped after {count} passes: the last one still moved the position by {last.step:.2g} m"
        if self.fit > WORST_FIT:
            return f"converged after {count} passes, but ranges are off by {self.fit:.1f} σ: a wrong minimum or noise"
        return f"converged after {count} passes"


def refine(measurements: Measurements, estimate: Estimate, setting: Setting) -> Refinement:
    """Refine a record that the cascade has observed, starting from its last estimate."""
    covariance = np.diag(np.repeat(np.square(START_SIGMA), 3))
    rotation = estimate.rotation[-1]
    position = np.asarray(setting.world.anchor) + to_inertial(rotation, estimate.state[-1, POSITION])
    velocity = to_inertial(rotation, estimate.state[-1, VELOCITY])
    strapdown.check(measurements)
    backwards = strapdown.reversed_record(measurements)
    track = filtered(backwards, (position, -velocity, rotation), covariance, setting)
    return smooth(measurements, strapdown.reversed_track(track), setting)


def smooth(measurements: Measurements, nominal: Track, setting: Setting) -> Refinement:
    """Gauss–Newton passes from any trajectory on the record's IMU samples; the prior is about its first state."""
    strapdown.check(measurements)
    z, p, attached = measurements, strapdown.parameters(setting), strapdown.attach(measurements)
    anchor = np.asarray(setting.world.anchor, dtype=float)
    reached = _Trajectory(nominal.position - anchor, nominal.velocity.copy(), nominal.rotation.copy())
    first = _Trajectory(*(part[0].copy() for part in reached))
    work, passes, converged = _workspace(z, attached), [], False
    with np.errstate(all="ignore"):
        while len(passes) < MAX_PASSES and not converged:
            passes.append(_pass(z, attached, reached, first, work, p))
            if not np.isfinite(passes[-1].step):
                break
            converged = max(passes[-1].step, passes[-1].turn) < SMALL_STEP
        residuals = _finish(z, attached, reached, work, p)
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


class _Workspace(NamedTuple):
    """What the forward half leaves for the backward half; see the kernel."""

    errors: Array
    covariances: Array
    accelerations: Array
    kept: Array
    corrected: Array


def _workspace(z: Measurements, attached: Attached) -> _Workspace:
    count = len(z.time)
    corrections = len(attached.sample) + 2 * int(np.sum(~np.isnan(z.mag).any(axis=-1)))
    return _Workspace(
        errors=np.empty((count, STATES)),
        covariances=np.empty((count, STATES * STATES)),
        accelerations=np.zeros((count, 3)),
        kept=np.empty((corrections, _kernel().KEPT)),
        corrected=np.empty(count, dtype=np.int64),
    )


def _pass(
    z: Measurements, attached: Attached, reached: _Trajectory, first: _Trajectory, work: _Workspace, p: Strapdown
) -> Pass:
    """Linearise about the trajectory reached, filter forward, come back, move the trajectory."""
    kernel = _kernel()
    prior, covariance = np.empty(STATES), np.diag(np.repeat(np.square(PRIOR_SIGMA), 3)).ravel()
    kernel.prior(first.position, first.velocity, first.rotation, *reached, prior)
    cost = kernel.forward(
        z.time, z.gyro, z.accel, z.mag, z.range[attached.kept], attached.sample, attached.back,
        *reached, prior, covariance, *work, p,
    )  # fmt: skip
    kernel.backward(z.time, *work)
    step, turn = kernel.apply(work.errors, *reached)
    return Pass(cost=cost / len(work.kept), step=step, turn=turn)


def _finish(z: Measurements, attached: Attached, reached: _Trajectory, work: _Workspace, p: Strapdown) -> Array:
    """The smoothed covariances, left in `work`, and the residuals of all ranges."""
    kernel, residuals = _kernel(), np.full((len(z.range), 2), np.nan)
    kernel.smooth_covariance(z.time, *work[1:])
    kernel.residuals(
        z.time, z.gyro, z.accel, z.range[attached.kept], attached.sample, attached.back,
        *reached, work.covariances, residuals[attached.kept], p,
    )  # fmt: skip
    return residuals


def _kernel() -> ModuleType:
    """The compiled kernel, imported where it is used: numba alone takes as long to import as everything else."""
    from rangenav.kernels import smoother as kernel

    return kernel
