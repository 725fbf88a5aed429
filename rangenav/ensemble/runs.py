"""Many runs of one preset: what noise alone changes (`seeds`), and what the start changes (`starts`).

Curves are kept on a grid of 401 times; every figure (settling, steady errors) comes from all samples.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
import scipy
from jaxtyping import Float, Int
from msgspec.structs import replace
from numpy import ndarray as Array

from rangenav import cascade, consistency, model, record
from rangenav.cascade import AttitudeInputs, Estimate, ObserverConfig
from rangenav.ensemble.pool import MAX_AT_ONCE, each, refuse_work
from rangenav.ensemble.values import Ensemble, Spread, middle
from rangenav.gains import Guess
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress, never, unheard
from rangenav.record import Outcome, Truth
from rangenav.results import result
from rangenav.sensors import Measurements

GRID = 401
"""Times at which errors are kept: as many as a plot can tell apart."""
STARTS_PER_RECORD = 64
"""Random starts that share one record of measurements and so one x̂, which does not depend on the attitude: four vectors
of sixteen, which take as long as the record itself."""
BATCH, TOGETHER = 130_000, 16
"""Steps of all filters (starts × samples) in one job, a millisecond of a core, and the filters side by side."""
RUNS_TOGETHER = 8
"""Runs with constant gains that one thread makes side by side, fewer of long records; no result depends on it."""
HOLD = 1.0
"""s at the end of a run over which an error must stay small to count as held."""
SHARED_FIGURES = ("steady_position", "steady_velocity", "steady_gravity", "peak_position")
"""Figures of a summary that do not depend on the attitude."""


@result
class _Attitudes:
    """What an ensemble keeps of the attitude errors from each of several starts."""

    curves: Float[Array, "j t"]
    """rad, on the grid."""
    steady: Float[Array, "j"]
    """rad, over the last quarter."""
    above: Int[Array, "j"]
    """Samples up to the last one that is not below 5°."""


def seeds(
    preset: Preset,
    count: int,
    *,
    form: model.ModelForm = "derived",
    progress: Progress = unheard,
    cancelled: Cancelled = never,
) -> Ensemble:
    """`count` runs with seeds counted up from the preset's; each is what `record.run_seed` gives, to the last bit.

    Raises ValueError if that is too much work, and CancelledError when it is cancelled.
    """
    truth = _truth(preset, count)

    def run(some: range) -> list[dict[str, Array]]:
        return [
            _rows(truth, z, outcome, _attitude_of(outcome.errors.attitude), seed)
            for seed, (z, outcome) in zip(some, _observed(preset, truth, some, form), strict=True)
        ]

    return _in_groups(preset, truth, run, range(preset.seed, preset.seed + count), progress, cancelled)


def starts(
    preset: Preset,
    count: int,
    rng: np.random.Generator,
    *,
    progress: Progress = unheard,
    cancelled: Cancelled = never,
) -> Ensemble:
    """`count` runs from x̂ = 0 and R̂(0) uniform on SO(3), 64 on each record of noise. Raises as `seeds` does."""
    truth = _truth(preset, count)
    rotations = scipy.spatial.transform.Rotation.from_quat(
        rng.standard_normal((count, 4))
    ).as_matrix()  # normal in R⁴: no preferred direction
    preset = replace(preset, guess=Guess())
    setting = ObserverConfig(world=preset.world, sensors=preset.sensors, gains=preset.gains)
    records = range(preset.seed, preset.seed - (-count // STARTS_PER_RECORD))

    def run(some: range) -> list[dict[str, Array]]:
        rows = []
        for seed, (z, outcome) in zip(some, _observed(preset, truth, some, "derived"), strict=True):
            inputs = cascade.attitude_inputs(z, outcome.estimate, setting, truth=truth.motion.rotation)
            first = STARTS_PER_RECORD * (seed - preset.seed)
            attitudes = _attitudes_from(inputs, rotations[first : first + STARTS_PER_RECORD])
            rows.append(_rows(truth, z, outcome, attitudes, seed))
        return rows

    return _in_groups(preset, truth, run, records, progress, cancelled)


def attitude_errors(
    preset: Preset, truth: Truth, measurements: Measurements, rotations: Float[Array, "j 3 3"]
) -> Float[Array, "j n"]:
    """Angle of R̃ (rad) over a record, from each of many R̂(0)."""
    estimate, setting = shared(preset, truth, measurements)
    return cascade.attitude_errors(measurements, estimate, setting, rotations=rotations, truth=truth.motion.rotation)


def shared(preset: Preset, truth: Truth, measurements: Measurements) -> tuple[Estimate, ObserverConfig]:
    """The estimate from the preset's guess, whose x̂ every R̂(0) shares, and the observer's configuration."""
    setting = ObserverConfig(world=preset.world, sensors=preset.sensors, gains=preset.gains)
    guessed = cascade.start(preset.guess, state=truth.state[0], rotation=truth.motion.rotation[0], world=preset.world)
    return cascade.observe(measurements, guessed, setting), setting


def spread(figures: Float[Array, "s"]) -> Spread:
    """Median and 10–90 % of one figure over the runs."""
    return Spread(*(float(value) for value in middle(figures)))


def grid(count: int) -> Int[Array, "t"]:
    """Up to 401 of `count` samples, first and last among them."""
    return np.unique(np.linspace(0, count - 1, GRID).round().astype(int))


def batch(samples: int) -> int:
    """How many attitudes may be followed together over so many samples: whole vectors of them."""
    return TOGETHER * max(1, BATCH // (TOGETHER * samples))


def _samples(truth: Truth) -> int:
    return len(truth.motion.time)


def _truth(preset: Preset, count: int) -> Truth:
    refuse_work(preset, count)
    return record.simulated(record.truth_inputs(preset))


def _observed(
    preset: Preset, truth: Truth, seeds: Sequence[int], form: model.ModelForm
) -> list[tuple[Measurements, Outcome]]:
    """Runs, drawn anew: the records that the page keeps stay where they are."""
    inputs, p = record.truth_inputs(preset), preset
    drawn = [record.drawn(inputs, p.sensors, seed) for seed in seeds]
    outcomes = record.observed_each(truth, drawn, p.world, p.sensors, [p.gains] * len(drawn), p.guess, form)
    return list(zip(drawn, outcomes, strict=True))


def _in_groups(
    preset: Preset,
    truth: Truth,
    run: Callable[[range], list[dict[str, Array]]],
    seeds: range,
    progress: Progress,
    cancelled: Cancelled,
) -> Ensemble:
    """What `run` gives for groups of these seeds, whose records it observes side by side."""
    most = RUNS_TOGETHER if preset.gains.mode == "constant" else 1
    size = max(1, min(most, MAX_AT_ONCE // (4 * _samples(truth))))
    groups = [seeds[k : k + size] for k in range(0, len(seeds), size)]
    jobs = each(run, groups, samples=size * _samples(truth), progress=progress, cancelled=cancelled)
    return _gathered(truth, [rows for job in jobs for rows in job])


def _attitude_of(errors: Float[Array, "n"]) -> _Attitudes:
    """What is kept of the errors of one run."""
    curve, steady = errors[None, grid(len(errors))], np.array([record.steady(errors)])
    above = np.array([record.samples_above(errors, record.SETTLED_ATTITUDE)])
    return _Attitudes(curves=curve, steady=steady, above=above)


def _attitudes_from(inputs: AttitudeInputs, rotations: Float[Array, "j 3 3"]) -> _Attitudes:
    """The same of the errors from each R̂(0), which are computed where they are kept and over the last quarter."""
    count = len(inputs.time)
    shown, first, limit = grid(count), record.last_quarter(count), record.SETTLED_ATTITUDE
    chosen = np.arange(count) >= first
    chosen[shown] = True
    errors, above = cascade.attitude_settling(inputs, rotations=rotations, chosen=chosen, limit=limit)
    curves = errors[:, np.searchsorted(np.flatnonzero(chosen), shown)]
    steady = record.root_mean_square(errors[:, first - count :])
    return _Attitudes(curves=curves, steady=steady, above=above)


def _rows(truth: Truth, z: Measurements, outcome: Outcome, attitudes: _Attitudes, seed: int) -> dict[str, Array]:
    """Rows of every field of an ensemble: one x̂ and the attitude errors from each of several starts."""
    estimate, errors, summary, chosen = outcome.estimate, outcome.errors, outcome.summary, grid(len(z.time))
    last = z.time >= z.time[-1] - HOLD
    held = attitudes.above <= np.argmax(last)
    P = estimate.covariance[chosen, 0]
    nis, count = _binned(consistency.innovations(estimate.innovation), z.range_time, z.time[chosen])
    with np.errstate(invalid="ignore"):
        sigma = np.sqrt(np.trace(P, axis1=-2, axis2=-1))
    shared = {
        "seed": seed,
        **{name: getattr(errors, name)[chosen] for name in ("position", "velocity", "gravity")},
        "sigma": sigma,
        "nees": consistency.errors((estimate.state - truth.state)[chosen, model.POSITION], P),
        "nis": nis,
        "nis_count": count,
        "fit": summary.fit,
        "settle_position": _or_never(summary.settle_position_s),
        **{name: getattr(summary, name) for name in SHARED_FIGURES},
    }
    return {
        **{name: _repeated(value, len(held)) for name, value in shared.items()},
        "attitude": attitudes.curves,
        "settle_attitude": record.settled_after(z.time, attitudes.above),
        "steady_attitude_deg": np.array([math.degrees(angle) for angle in attitudes.steady]),
        "held": np.asarray(held & np.all(errors.position[last] < record.SETTLED_POSITION)),
    }


def _repeated(value: object, count: int) -> Array:
    """One row for each start: not copied before all runs are gathered."""
    one = np.asarray(value)
    return np.broadcast_to(one, (count, *one.shape))


def _or_never(time: float | None) -> float:
    return np.inf if time is None else time


def _binned(square: Array, time: Array, ends: Array) -> tuple[Array, Array]:
    """Mean and number of the finite values that fall in (the end before, this end]."""
    finite = np.isfinite(square) & (time <= ends[-1])
    bins = np.searchsorted(ends, time[finite])
    count = np.bincount(bins, minlength=len(ends))
    total = np.bincount(bins, weights=square[finite], minlength=len(ends))
    return np.where(count > 0, total / np.maximum(count, 1), np.nan), count


def _gathered(truth: Truth, runs: list[dict[str, Array]]) -> Ensemble:
    times = truth.motion.time[grid(len(truth.motion.time))]
    columns = {name: [rows[name] for rows in runs] for name in runs[0]}
    curves = [name for name, parts in columns.items() if parts[0].ndim == 2 and parts[0].dtype == np.float64]
    block = np.empty((len(curves), sum(map(len, columns["seed"])), len(times)))  # one block is ready much sooner
    for name, table in zip(curves, block, strict=True):
        np.concatenate(columns.pop(name), out=table)
    rest = {name: np.concatenate(parts) for name, parts in columns.items()}
    return Ensemble(time=times, **dict(zip(curves, block, strict=True)), **rest)
