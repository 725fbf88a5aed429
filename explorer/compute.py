"""settings -> Picture, in stages cached by their own inputs: a gain slider never recomputes a Gramian. No viser here.

motion        <- path, angular velocity, world, duration, rate
gramian       <- path, gravity, window            (not attitude, not gains, not the anchor)
accuracy      <- gramian's inputs, anchor, sensors
printed       <- path, angular velocity, world, window
measurements  <- motion's inputs, sensors, seed
estimate      <- measurements' inputs, gains, guess
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from explorer.settings import Printed, Settings, effective
from rangenav import attitude, cascade, motion, record
from rangenav.analysis import WINDOWS, Analysis, analyse
from rangenav.cascade import Gains, Guess
from rangenav.inputs import Vec3
from rangenav.model import Form
from rangenav.motion import Limits, Motion, World
from rangenav.observability import excitation, reduced
from rangenav.preset import Preset
from rangenav.record import Summary
from rangenav.sensors import Measurements, Sensors
from rangenav.signals import Signal, Turning

CACHED = 4


@dataclass(frozen=True, eq=False, kw_only=True)
class Picture:
    """Everything the page draws, all of it belonging to the same settings."""

    settings: Settings
    preset: Preset
    """The preset as computed: time scale and printed initial values applied."""
    motion: Motion
    limits: Limits
    phi: Float[Array, "n 3"]
    """Rᵀp⁗ (m/s⁴), body axes."""
    phi_printed: Float[Array, "n 3"]
    """The printed φ, body axes."""
    analysis: Analysis
    """Spectra over sliding windows, worst windows, blind directions, predicted accuracy, verdict (derived forms)."""
    printed_excitation: Float[Array, "w 3"]
    """Eigenvalues of the excitation under the printed switches that are on, at analysis.windows.start."""
    measurements: Measurements
    estimate: cascade.Estimate
    errors: cascade.Errors
    position_estimate: Float[Array, "n 3"]
    """p̂_I (m, inertial)."""
    summary: Summary
    """Peak, settling and steady errors, in numbers; and whether the covariance diverged."""
    attitude_time_constants: Float[Array, "3"]
    """s, slowest first; under the printed switch twice as long."""
    reduced_min: float
    """Least eigenvalue of the reduced pair (Proposition 1) under the printed switches that are on."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Run:
    """The estimate stage: what depends on gains and guess."""

    estimate: cascade.Estimate
    errors: cascade.Errors
    position: Float[Array, "n 3"]
    summary: Summary


def compute(settings: Settings) -> Picture:
    """The picture of the settings. Raises ValueError with one sentence if they cannot be computed."""
    p, printed = effective(settings), settings.printed
    truth = record.simulated(p.path, p.angular_velocity, p.world, p.initial_rotation, p.duration, p.sensors.imu_rate)
    phi, phi_printed = _phi(*_motion_inputs(p))
    found = analyse(p)
    form: Form = "printed" if printed.model else "derived"
    run = _observed(*_motion_inputs(p), p.sensors, p.seed, p.gains, p.guess, form)
    return Picture(
        settings=settings,
        preset=p,
        motion=truth.motion,
        limits=_limits(*_motion_inputs(p)),
        phi=phi,
        phi_printed=phi_printed,
        analysis=found,
        printed_excitation=_printed_excitation(*_motion_inputs(p), p.requirement.window, printed),
        measurements=record.measured(*_motion_inputs(p)[:-1], p.sensors, p.seed),
        estimate=run.estimate,
        errors=run.errors,
        position_estimate=run.position,
        summary=run.summary,
        attitude_time_constants=attitude.time_constants(
            p.gains.attitude, p.world, "printed" if printed.attitude_rate else "derived"
        ),
        reduced_min=_reduced(p, found, printed),
    )


def warm_up(progress: Callable[[float, str], None]) -> None:
    """Compile the kernels (seconds the first time ever, then read from disk), saying how far it has come."""
    from rangenav.kernels import warm

    warm.compile_all(progress)


def _motion_inputs(p: Preset) -> tuple[Signal, Turning, World, Vec3, float, float]:
    return p.path, p.angular_velocity, p.world, p.initial_rotation, p.duration, p.sensors.imu_rate


@lru_cache(maxsize=CACHED)
def _phi(
    path: Signal, angular_velocity: Turning, world: World, initial_rotation: Vec3, duration: float, rate: float
) -> tuple[Array, Array]:
    truth = record.simulated(path, angular_velocity, world, initial_rotation, duration, rate)
    return excitation.phi(truth.motion), excitation.phi_printed(truth.motion)


@lru_cache(maxsize=CACHED)
def _limits(
    path: Signal, angular_velocity: Turning, world: World, initial_rotation: Vec3, duration: float, rate: float
) -> Limits:
    truth = record.simulated(path, angular_velocity, world, initial_rotation, duration, rate)
    return motion.limits(truth.motion, world=world)


@lru_cache(maxsize=CACHED)
def _printed_excitation(
    path: Signal,
    angular_velocity: Turning,
    world: World,
    initial_rotation: Vec3,
    duration: float,
    rate: float,
    window: float,
    printed: Printed,
) -> Array:
    """Excitation under the switches; with none of them on, the derived one from the same samples."""
    moved = record.simulated(path, angular_velocity, world, initial_rotation, duration, rate).motion
    signal = excitation.chosen_signal(moved, printed_formula=printed.excitation, body_axes=printed.body_axes)
    start = np.linspace(0, duration - window, WINDOWS)
    return excitation.sampled_eigenvalues(signal, moved.time, start, window)


@lru_cache(maxsize=CACHED)
def _observed(
    path: Signal,
    angular_velocity: Turning,
    world: World,
    initial_rotation: Vec3,
    duration: float,
    rate: float,
    sensors: Sensors,
    seed: int,
    gains: Gains,
    guess: Guess,
    form: Form,
) -> _Run:
    truth = record.simulated(path, angular_velocity, world, initial_rotation, duration, rate)
    z = record.measured(path, angular_velocity, world, initial_rotation, duration, sensors, seed)
    estimate, seconds = record.observed(truth, z, world, sensors, gains, guess, form)
    errors = cascade.errors(estimate, truth=truth.state, rotation=truth.motion.rotation)
    summary = record.summarise(estimate, errors, seconds)
    return _Run(estimate=estimate, errors=errors, position=estimate.position(world), summary=summary)


def _reduced(p: Preset, found: Analysis, printed: Printed) -> float:
    if not (printed.excitation or printed.reduced_row or printed.body_axes):
        return found.reduced_min
    return reduced.sampled_least_eigenvalue(
        record.simulated(*_motion_inputs(p)).motion,
        found.gramian_at,
        p.requirement.window,
        printed_formula=printed.excitation,
        printed_row=printed.reduced_row,
        body_axes=printed.body_axes,
    )
