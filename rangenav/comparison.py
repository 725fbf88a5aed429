"""Estimators compared on one record: the cascade, its refinement, and the extended Kalman filter.

The filter runs twice: from the cascade's own start, and from the truth with a small covariance. Nobody has that second
start; it shows how accurate the filter is where it converges. The errors of all of them are `rangenav.errors.Errors`,
in body axes.
"""

import time
from collections.abc import Callable

import numpy as np

from rangenav import baselines, cascade, errors, record, refine, strapdown
from rangenav.cascade import Estimate, ObserverConfig
from rangenav.errors import Errors
from rangenav.model import POSITION
from rangenav.record import Record, Summary
from rangenav.results import result
from rangenav.strapdown import STATES, Track

CASCADE, REFINEMENT = "cascade", "refinement of the whole record"
EKF, EKF_TRUTH = "EKF, the cascade's start", "EKF, started at the truth"
TRUTH_SIGMA = 0.1
"""m, m/s and rad: 1 σ with which the filter starts at the truth."""
WRONG_PLACE = 5.0
"""With a final error of more of its own σ than this, an estimator is in another minimum."""


@result
class Candidate:
    """The result of one estimator on the record."""

    name: str
    estimate: Estimate
    errors: Errors
    summary: Summary
    outcome: str
    """One sentence on how it ended."""


def compare(of: Record) -> tuple[Candidate, ...]:
    """All candidates on one record. The times are of this one run; those of the first run ever include compiling."""
    moved, setting = of.truth.motion, config_of(of)
    truth = (moved.position[0], moved.velocity[0], moved.rotation[0])
    near = np.eye(STATES) * TRUTH_SIGMA**2
    return (
        Candidate(
            name=CASCADE,
            estimate=of.estimate,
            errors=of.errors,
            summary=of.summary,
            outcome=outcome_text(of.estimate, of.errors, of.summary),
        ),
        refined(of),
        filtered(of),
        _filtered(EKF_TRUTH, lambda: baselines.filtered(of.measurements, truth, near, setting), of),
    )


def refined(of: Record) -> Candidate:
    """The whole record refined, starting from the cascade's last estimate."""
    began = time.perf_counter()
    refinement = refine.refine(of.measurements, of.estimate, config_of(of))
    return candidate(REFINEMENT, refinement.track, of, time.perf_counter() - began, outcome=refinement.summary)


def filtered(of: Record) -> Candidate:
    """The extended Kalman filter from the cascade's own start."""
    rotation, world = of.truth.motion.rotation[0], of.preset.world
    start = cascade.start(of.preset.guess, state=of.truth.state[0], rotation=rotation, world=world)
    return _filtered(EKF, lambda: baselines.ekf(of.measurements, start, config_of(of)), of)


def config_of(of: Record) -> ObserverConfig:
    """The configuration that the observers of a run had."""
    return ObserverConfig(world=of.preset.world, sensors=of.preset.sensors, gains=of.preset.gains, form=of.form)


def _filtered(name: str, run: Callable[[], Track], of: Record) -> Candidate:
    began = time.perf_counter()
    track = run()
    return candidate(name, track, of, time.perf_counter() - began)


def candidate(name: str, track: Track, of: Record, seconds: float, *, outcome: str | None = None) -> Candidate:
    """A track as a candidate, with its errors and its summary.

    seconds: how long the estimator took. outcome: a sentence of the estimator on how it ended, if it has one; where the
    estimate does not settle, the comparison with the truth is added to it.
    """
    with np.errstate(all="ignore"):  # a filter that went to infinity is shown as it is
        estimate = strapdown.lifted(track, of.measurements, of.preset.world)
        tracking = errors.of(estimate, truth=of.truth.state, rotation=of.truth.motion.rotation)
        sigma = of.preset.sensors.sigma.range
        summary = record.summarise(estimate, of.measurements, tracking, seconds, range_sigma=sigma)
        by_truth = outcome_text(estimate, tracking, summary)
        if outcome is None:
            outcome = by_truth
        elif summary.settle_position_s is None:  # perhaps it converged, but not to the truth
            outcome = f"{outcome}; {by_truth}"
    return Candidate(name=name, estimate=estimate, errors=tracking, summary=summary, outcome=outcome)


def outcome_text(estimate: Estimate, errors: Errors, summary: Summary) -> str:
    """Settled, in a wrong place, or not a number; the truth decides, so this is for simulated records only."""
    lost = np.flatnonzero(~np.isfinite(errors.position))
    if len(lost):
        return f"not a number from t = {estimate.time[lost[0]]:.3g} s on"
    if summary.settle_position_s is not None:
        return f"within {record.SETTLED_POSITION:g} m from t = {summary.settle_position_s:.3g} s on"
    sigma = float(np.linalg.norm(estimate.std[-1, POSITION]))
    off = f"{summary.final_position:.2g} m off at the end, its own σ {sigma:.2g} m"
    return f"in a wrong place: {off}" if summary.final_position > WRONG_PLACE * sigma else f"not settled: {off}"
