"""One run of a preset: the truth, the measurements, the observers' estimate, and its errors."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav import cascade, divergence, errors, model, motion, range_fit
from rangenav.cascade import Estimate, ObserverConfig
from rangenav.errors import Errors
from rangenav.gains import Gains, Guess
from rangenav.inputs import Input, Vec3
from rangenav.motion import Motion, World
from rangenav.observability import excitation
from rangenav.preset import Preset
from rangenav.range_fit import RangeFit
from rangenav.results import result
from rangenav.sensors import Measurements, Sensors
from rangenav.sensors.measuring import Noise, Noiseless, draw, with_noise, without_noise
from rangenav.signals import AngularVelocity, Signal

SETTLED_POSITION = 0.3
"""m; an error counts as settled once it stays below this to the end, for `SETTLED_SHARE` of the run or longer."""
SETTLED_ATTITUDE = math.radians(5)
SETTLED_SHARE = 0.1
"""An error that is small over less than this last part of a run may be so by chance: it does not count as settled."""
CACHED = 4


class TruthInputs(Input, frozen=True, kw_only=True):
    """What determines the truth: the part of a preset without noise and observers."""

    path: Signal
    angular_velocity: AngularVelocity
    world: World
    initial_rotation: Vec3
    """rad"""
    duration: float
    """s"""
    rate: float
    """Hz, the IMU's."""


@result
class Truth:
    """A motion with its true 13-state."""

    motion: Motion
    state: Float[Array, "n 13"]


@dataclass(frozen=True, kw_only=True)
class Summary:
    """How well a run went; errors in m, m/s, m/s² and degrees, body axes."""

    peak_position: float
    settle_position_s: float | None
    """From when on the position error stays below 0.3 m; None if it does not, or only over less than the last tenth."""
    settle_attitude_s: float | None
    """From when on the attitude error stays below 5°."""
    steady_position: float
    """RMSE over the last quarter, as all steady ones."""
    steady_velocity: float
    steady_gravity: float
    steady_attitude_deg: float
    final_position: float
    final_velocity: float
    final_gravity: float
    final_attitude_deg: float
    diverged: bool
    """Whether the observer has diverged; the truth is not used."""
    microseconds_per_step: float
    fit: RangeFit
    """How well the estimate fits its ranges; the truth is not used."""
    divergence: str | None
    """Why it has diverged, one clause; see `divergence`."""
    range_residual: float
    """m, RMS of |p̂| − d over the last quarter of the ranges; NaN without ranges."""
    own_position: float
    """m, the observer's own 1-σ of the position at the end; of constant gains a design quantity. NaN if it has none."""


@result
class Outcome:
    """The observers' result on one record."""

    estimate: Estimate
    errors: Errors
    summary: Summary


@result
class Record:
    """All results of one run."""

    preset: Preset
    truth: Truth
    measurements: Measurements
    estimate: Estimate
    errors: Errors
    summary: Summary
    form: model.ModelForm


def run(preset: Preset, *, form: model.ModelForm = "derived") -> Record:
    """Simulate, measure and observe a preset with its own seed."""
    return run_seed(preset, preset.seed, form=form)


def run_seed(preset: Preset, seed: int, *, form: model.ModelForm = "derived") -> Record:
    """As `run`, with another seed."""
    p, inputs = preset, truth_inputs(preset)
    truth, measurements = simulated(inputs), measured(inputs, p.sensors, seed)
    outcome = observed(truth, measurements, p.world, p.sensors, p.gains, p.guess, form)
    return Record(
        preset=p,
        truth=truth,
        measurements=measurements,
        estimate=outcome.estimate,
        errors=outcome.errors,
        summary=outcome.summary,
        form=form,
    )


def truth_inputs(preset: Preset, *, rate: float | None = None) -> TruthInputs:
    """The part of a preset that determines its truth, on the IMU's clock or at another rate (Hz)."""
    return TruthInputs(
        path=preset.path,
        angular_velocity=preset.angular_velocity,
        world=preset.world,
        initial_rotation=preset.initial_rotation,
        duration=preset.duration,
        rate=preset.sensors.imu_rate if rate is None else rate,
    )


def motion_of(inputs: TruthInputs) -> Motion:
    """The motion that the inputs determine, at their rate."""
    return motion.simulate(
        inputs.path,
        inputs.angular_velocity,
        world=inputs.world,
        initial_rotation=inputs.initial_rotation,
        duration=inputs.duration,
        rate=inputs.rate,
    )


@lru_cache(maxsize=CACHED)
def simulated(inputs: TruthInputs) -> Truth:
    """The truth on the clock of the inputs."""
    moved = motion_of(inputs)
    return Truth(motion=moved, state=model.true_state(moved, world=inputs.world))


@lru_cache(maxsize=CACHED)
def measured(inputs: TruthInputs, sensors: Sensors, seed: int) -> Measurements:
    """The same as `drawn`; the last few records are cached, and the noise of the last seeds, which no path changes."""
    exact = _exact(inputs, sensors)
    return with_noise(exact, _noise(seed, len(exact.mag), len(exact.distance)), sensors=sensors)


@lru_cache(maxsize=CACHED)
def _exact(inputs: TruthInputs, sensors: Sensors) -> Noiseless:
    return without_noise(simulated(inputs).motion, path=inputs.path, world=inputs.world, sensors=sensors)


@lru_cache(maxsize=2)
def _noise(seed: int, samples: int, ranges: int) -> Noise:
    return draw(np.random.default_rng(seed), samples, ranges)


def drawn(inputs: TruthInputs, sensors: Sensors, seed: int) -> Measurements:
    """One noisy record; the same seed gives the same record to the last bit."""
    exact = _exact(inputs, sensors)
    noise = draw(np.random.default_rng(seed), len(exact.mag), len(exact.distance))
    return with_noise(exact, noise, sensors=sensors)


def observed(
    truth: Truth,
    measurements: Measurements,
    world: World,
    sensors: Sensors,
    gains: Gains,
    guess: Guess,
    form: model.ModelForm,
) -> Outcome:
    """The observers' result on a record, with the time it took; never cached, so the time is measured."""
    (outcome,) = observed_each(truth, [measurements], world, sensors, [gains], guess, form)
    return outcome


def observed_each(
    truth: Truth,
    measurements: Sequence[Measurements],
    world: World,
    sensors: Sensors,
    gains: Sequence[Gains],
    guess: Guess,
    form: model.ModelForm,
) -> list[Outcome]:
    """The same of several records of one truth, each with its gains; the time is an equal share of all of them."""
    start = cascade.start(guess, state=truth.state[0], rotation=truth.motion.rotation[0], world=world)
    settings = [ObserverConfig(world=world, sensors=sensors, gains=one, form=form) for one in gains]
    began = time.perf_counter()
    estimates = cascade.observe_each(measurements, [start] * len(measurements), settings)
    seconds = (time.perf_counter() - began) / max(len(estimates), 1)
    outcomes = []
    for estimate, z in zip(estimates, measurements, strict=True):
        run_errors = errors.of(estimate, truth=truth.state, rotation=truth.motion.rotation)
        summary = summarise(estimate, z, run_errors, seconds, range_sigma=sensors.sigma.range)
        outcomes.append(Outcome(estimate=estimate, errors=run_errors, summary=summary))
    return outcomes


def summarise(
    estimate: Estimate, measurements: Measurements, errors: Errors, seconds: float, *, range_sigma: float
) -> Summary:
    """Peak, settling, steady and final errors of a run, and how well it fits its ranges, of noise range_sigma (m)."""
    taken = (measurements.range_time, measurements.range)
    fit = divergence.with_residual(range_fit.of(estimate), estimate, *taken, range_sigma)
    diverged = divergence.divergence(estimate, *taken, fit)
    return Summary(
        peak_position=float(errors.position.max()),
        settle_position_s=settled(estimate.time, errors.position, SETTLED_POSITION),
        settle_attitude_s=settled(estimate.time, errors.attitude, SETTLED_ATTITUDE),
        steady_position=steady(errors.position),
        steady_velocity=steady(errors.velocity),
        steady_gravity=steady(errors.gravity),
        steady_attitude_deg=math.degrees(steady(errors.attitude)),
        final_position=float(errors.position[-1]),
        final_velocity=float(errors.velocity[-1]),
        final_gravity=float(errors.gravity[-1]),
        final_attitude_deg=math.degrees(float(errors.attitude[-1])),
        diverged=diverged is not None,
        microseconds_per_step=seconds / (len(estimate.time) - 1) * 1e6,
        fit=fit,
        divergence=diverged,
        range_residual=divergence.range_residuals(estimate, *taken)[1],
        own_position=divergence.own_sigma(estimate),
    )


def steady(error: Float[Array, "n"]) -> float:
    """Root mean square over the last quarter."""
    return float(root_mean_square(error[None, last_quarter(len(error)) :])[0])


def last_quarter(count: int) -> int:
    """The number of the sample with which the last quarter of so many begins."""
    return 3 * count // 4


def root_mean_square(errors: Float[Array, "j n"]) -> Float[Array, "j"]:
    """Of each of many errors."""
    return np.sqrt(np.mean(errors**2, axis=1))


def settled(time: Float[Array, "n"], error: Float[Array, "n"], limit: float) -> float | None:
    """The time from which on the error stays below the limit; None if it is above it in the last tenth of the run."""
    (since,) = settled_after(time, np.array([samples_above(error, limit)]))
    return float(since) if math.isfinite(since) else None


def samples_above(error: Float[Array, "n"], limit: float) -> int:
    """How many samples there are up to the last one that is not below the limit."""
    above = np.flatnonzero(~(error < limit))
    return int(above[-1]) + 1 if len(above) else 0


def settled_after(time: Float[Array, "n"], above: Int[Array, "j"]) -> Float[Array, "j"]:
    """The same of many errors, each with its number of `samples_above`; infinite in place of None."""
    latest = time[-1] - SETTLED_SHARE * (time[-1] - time[0])
    since = time[np.minimum(above, len(time) - 1)]
    return np.where((above < len(time)) & (since <= latest), since, np.inf)


def save(record: Record, path: str | Path) -> None:
    """Write every array of a run to one NPZ file, named as in the documentation of `rangenav simulate`."""
    truth, z, estimate = record.truth.motion, record.measurements, record.estimate
    arrays = {
        "time": truth.time,
        **{name: getattr(truth, name) for name in ("position", "velocity", "acceleration", "jerk", "snap")},
        "rotation": truth.rotation,
        "angular_velocity": truth.angular_velocity,
        **{name: getattr(z, name) for name in ("gyro", "accel", "mag", "range", "range_time")},
        "state": estimate.state,
        "std": estimate.std,
        "rotation_estimate": estimate.rotation,
        "model": record.form,
        "phi": excitation.phi(truth),
        "phi_printed": excitation.phi_printed(truth),
    }
    np.savez_compressed(path, **arrays)  # pyright: ignore[reportArgumentType]
