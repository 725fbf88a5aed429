"""The metrics of a study: a row for each, with its unit, its title, what it is read from, and how.

    analysis   observability of the motion (`analysis.sampled`): one value at each point
    motion     what the motion demands of a vehicle: one value at each point
    run        errors of an estimator on one record: a value for each run
A new metric is one row of METRICS.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rangenav import consistency, motion, vehicle
from rangenav.analysis import Analysis
from rangenav.model import POSITION
from rangenav.motion import Limits, Motion
from rangenav.preset import Preset
from rangenav.record import Outcome, Truth
from rangenav.results import result

Needs = Literal["analysis", "motion", "run"]


@dataclass(frozen=True, kw_only=True)
class Metric:
    """One row of the table."""

    name: str
    unit: str
    """SI, or ° for an attitude; empty for a count, a share or a yes (1) and no (0)."""
    title: str
    needs: Needs
    value: Callable[[Any], float]
    """From an Analysis, a Flight or a Run, as `needs` says; NaN or infinite where there is no such number."""


@result
class Flight:
    """A motion and the preset that it comes from."""

    motion: Motion
    preset: Preset
    limits: Limits


@result
class Run:
    """An estimator's result on one record, and the truth."""

    outcome: Outcome
    truth: Truth


def flight(moved: Motion, preset: Preset) -> Flight:
    """A motion with its largest speed, thrust and so on."""
    return Flight(motion=moved, preset=preset, limits=motion.limits(moved, world=preset.world))


def _analysis(name: str, unit: str, title: str, value: Callable[[Analysis], float]) -> Metric:
    return Metric(name=name, unit=unit, title=title, needs="analysis", value=value)


def _motion(name: str, unit: str, title: str, value: Callable[[Flight], float]) -> Metric:
    return Metric(name=name, unit=unit, title=title, needs="motion", value=value)


def _run(name: str, unit: str, title: str, value: Callable[[Run], float]) -> Metric:
    return Metric(name=name, unit=unit, title=title, needs="run", value=value)


def _flyable(flown: Flight) -> float:
    return float(not vehicle.broken(flown.motion, flown.preset.vehicle, world=flown.preset.world))


def _nees(run: Run) -> float:
    """Over the last quarter; its expectation is 1."""
    estimate = run.outcome.estimate
    last = slice(3 * len(estimate.time) // 4, None)
    error = (estimate.state - run.truth.state)[last, POSITION]
    values = consistency.errors(error, estimate.covariance[last, 0])
    return float(np.mean(values)) / 3


def _or_never(time: float | None) -> float:
    return math.inf if time is None else time


def _settled(run: Run) -> float:
    summary = run.outcome.summary
    return float(summary.settle_position_s is not None and summary.settle_attitude_s is not None)


ROWS = (
    _analysis("mu", "m²/s⁷", "excitation μ", lambda a: a.mu),
    _analysis("rank", "", "lifted rank, of 13", lambda a: a.known_rank),
    _analysis("rank_nonlinear", "", "nonlinear rank, of 9", lambda a: a.nonlinear_rank),
    _analysis("sigma_lifted", "m", "predicted σ of the position, lifted", lambda a: a.lifted_end.position),
    _analysis("sigma_nonlinear", "m", "predicted σ of the position, nonlinear", lambda a: a.nonlinear_end.position),
    _analysis(
        "observable",
        "",
        "the verdict is observable: every requirement is met",
        lambda a: float(a.verdict.word == "observable"),
    ),
    _motion("speed", "m/s", "largest speed", lambda f: f.limits.speed),
    _motion("acceleration", "m/s²", "largest acceleration", lambda f: f.limits.acceleration),
    _motion("thrust_to_weight", "", "largest thrust over weight", lambda f: f.limits.thrust_to_weight),
    _motion("body_rate", "rad/s", "largest body rate", lambda f: f.limits.body_rate),
    _motion("snap", "m/s⁴", "largest snap", lambda f: f.limits.snap),
    _motion("anchor_distance", "m", "least distance to the anchor", lambda f: f.limits.anchor_distance_min),
    _motion("flyable", "", "keeps the vehicle's limits", _flyable),
    _run("settle_position", "s", "settling time, position", lambda r: _or_never(r.outcome.summary.settle_position_s)),
    _run("settle_attitude", "s", "settling time, attitude", lambda r: _or_never(r.outcome.summary.settle_attitude_s)),
    _run("settled", "", "position and attitude settle", _settled),
    _run("steady_position", "m", "steady error, position", lambda r: r.outcome.summary.steady_position),
    _run("steady_velocity", "m/s", "steady error, velocity", lambda r: r.outcome.summary.steady_velocity),
    _run("steady_gravity", "m/s²", "steady error, gravity", lambda r: r.outcome.summary.steady_gravity),
    _run("steady_attitude", "°", "steady error, attitude", lambda r: r.outcome.summary.steady_attitude_deg),
    _run("peak_position", "m", "largest position error", lambda r: r.outcome.summary.peak_position),
    _run("final_position", "m", "last position error", lambda r: r.outcome.summary.final_position),
    _run("nees", "", "NEES of the position over 3, last quarter", _nees),
    _run("diverged", "", "the observer has diverged", lambda r: float(r.outcome.summary.diverged)),
)
METRICS: Mapping[str, Metric] = {row.name: row for row in ROWS}
"""Every metric by its name."""
