"""The metrics of a study: a row for each, with its unit, its title, what it is read from, and how.

    analysis   observability of the motion, of the worst of some windows or of all: one value at each point
    verdict    the verdict on the motion, of all windows: one value at each point
    motion     what the motion demands of a vehicle: one value at each point
    run        errors of an estimator on one record: a value for each run
A new metric is one row of METRICS.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rangenav import consistency, motion, record, vehicle
from rangenav.model import POSITION
from rangenav.motion import Limits, Motion
from rangenav.preset import Preset
from rangenav.record import Outcome, Truth
from rangenav.results import result
from rangenav.studies.intervals import Middle

Needs = Literal["analysis", "verdict", "motion", "run"]
Better = Literal["less", "more", "neither"]


@dataclass(frozen=True, kw_only=True)
class Metric:
    """One row of the table."""

    name: str
    unit: str
    """SI, or ° for an attitude; empty for a count, a share or a yes (1) and no (0)."""
    title: str
    needs: Needs
    value: Callable[[Any], float]
    """From an Analysis (also for a verdict), a Flight or a Run, as `needs` says; NaN or infinite where there is no such
    number."""
    better: Better = "less"
    """Which values are better."""
    middle: Middle = "mean"
    """What several runs say together: of a yes (1) or no (0) the share, of a time that may be infinite the median."""
    meaning: str
    """How it is defined, a clause for a table."""


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


def _of(needs: Needs, better: Better = "less", middle: Middle = "mean") -> Callable[..., Metric]:
    """A maker of rows from name, unit, title, value and meaning."""

    def row(name: str, unit: str, title: str, value: Callable[[Any], float], meaning: str) -> Metric:
        return Metric(
            name=name, unit=unit, title=title, needs=needs, better=better, middle=middle, value=value, meaning=meaning
        )

    return row


def _limit(name: str) -> Callable[[Flight], float]:
    return lambda flown: getattr(flown.limits, name)


def _summary(name: str) -> Callable[[Run], float]:
    return lambda run: float(getattr(run.outcome.summary, name))


MORE_OF_ANALYSIS, OF_ANALYSIS, OF_MOTION = _of("analysis", "more"), _of("analysis"), _of("motion")
OBSERVABLE = "observable"
"""The word of the verdict."""
WITHIN = f"{record.SETTLED_POSITION:g} m", f"{math.degrees(record.SETTLED_ATTITUDE):g}°"
SETTLED = " and ".join(WITHIN)
"""Below which errors count as settled."""
LAST_QUARTER = "RMS over the last quarter of the flight"
OF_RUN, TIME = _of("run"), _of("run", middle="median")
ROWS = (
    MORE_OF_ANALYSIS(
        "mu",
        "m²/s⁷",
        "excitation μ",
        lambda a: a.mu,
        "least eigenvalue of the excitation over a window; where it is large enough, the cascade converges",
    ),
    MORE_OF_ANALYSIS(
        "rank",
        "",
        "lifted rank, of 13",
        lambda a: a.known_rank,
        "quantities of the lifted, linear model that the ranges tell; the cascade needs 13",
    ),
    MORE_OF_ANALYSIS(
        "rank_nonlinear",
        "",
        "nonlinear rank, of 9",
        lambda a: a.nonlinear_rank,
        "quantities of the motion itself that the ranges tell; every estimator needs 9",
    ),
    OF_ANALYSIS(
        "sigma_lifted",
        "m",
        "predicted σ of the position, lifted",
        lambda a: a.lifted_end.position,
        "Cramér-Rao bound of the lifted model at the end of a window: the best for the cascade",
    ),
    OF_ANALYSIS(
        "sigma_nonlinear",
        "m",
        "predicted σ of the position, nonlinear",
        lambda a: a.nonlinear_end.position,
        "the same of the nonlinear model: the best for any estimator",
    ),
    _of("verdict", "more", "share")(
        "observable",
        "",
        "the verdict is observable: every requirement is met",
        lambda a: float(a.verdict.word == OBSERVABLE),
        "1 if rank, μ and σ of all windows, not only of the sampled ones, meet what the preset requires",
    ),
    OF_MOTION("speed", "m/s", "largest speed", _limit("speed"), "over the flight, as all of the motion"),
    OF_MOTION("acceleration", "m/s²", "largest acceleration", _limit("acceleration"), "without gravity"),
    OF_MOTION("thrust_to_weight", "", "largest thrust over weight", _limit("thrust_to_weight"), "1 in hover"),
    OF_MOTION("body_rate", "rad/s", "largest body rate", _limit("body_rate"), "of the preset's attitude"),
    OF_MOTION("snap", "m/s⁴", "largest snap", _limit("snap"), "fourth derivative of the position"),
    _of("motion", "more")(
        "anchor_distance", "m", "least distance to the anchor", _limit("anchor_distance_min"), "over the flight"
    ),
    _of("motion", "more", "share")(
        "flyable", "", "keeps the vehicle's limits", _flyable, "1 if no limit of the preset's vehicle is broken"
    ),
    TIME(
        "settle_position",
        "s",
        f"settling time, position to {WITHIN[0]}",
        lambda r: _or_never(r.outcome.summary.settle_position_s),
        f"from when on the error stays below {WITHIN[0]}, whatever the preset requires; infinite if it does not",
    ),
    TIME(
        "settle_attitude",
        "s",
        f"settling time, attitude to {WITHIN[1]}",
        lambda r: _or_never(r.outcome.summary.settle_attitude_s),
        f"from when on the error stays below {WITHIN[1]}; infinite if it does not",
    ),
    _of("run", "more", "share")(
        "settled", "", f"position and attitude settle to {SETTLED}", _settled, "1 if both settling times are finite"
    ),
    OF_RUN("steady_position", "m", "steady error, position", _summary("steady_position"), LAST_QUARTER),
    OF_RUN("steady_velocity", "m/s", "steady error, velocity", _summary("steady_velocity"), LAST_QUARTER),
    OF_RUN("steady_gravity", "m/s²", "steady error, gravity", _summary("steady_gravity"), LAST_QUARTER),
    OF_RUN("steady_attitude", "°", "steady error, attitude", _summary("steady_attitude_deg"), LAST_QUARTER),
    OF_RUN(
        "peak_position",
        "m",
        "largest position error",
        _summary("peak_position"),
        "over the whole flight, so the wrong start counts",
    ),
    OF_RUN("final_position", "m", "last position error", _summary("final_position"), "at the last sample"),
    _of("run", "neither")(
        "nees",
        "",
        "NEES of the position over 3, last quarter",
        _nees,
        "squared error over the variance that the estimator states: 1 is right, more is too sure of itself",
    ),
    _of("run", "less", "share")(
        "diverged",
        "",
        "the observer has diverged",
        _summary("diverged"),
        "1 if estimate and ranges disagree so much that the observer must start again; no truth is used",
    ),
)
RANKS = ("rank", "rank_nonlinear")
METRICS: Mapping[str, Metric] = {row.name: row for row in ROWS}
"""Every metric by its name."""


def markdown() -> str:
    """The table of all metrics, for the documentation."""
    lines = ["| metric | unit | better | of several runs | meaning |", "|---|---|---|---|---|"]
    lines += [
        f"| `{row.name}` | {row.unit or '1'} | {row.better} | {row.middle if row.needs == 'run' else '–'} "
        f"| {row.title}: {row.meaning} |"
        for row in ROWS
    ]
    return "\n".join(lines)
