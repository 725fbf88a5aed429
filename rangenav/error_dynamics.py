"""The error of the Riccati observer by itself, without noise: ė = (𝒜 − K𝒞) e, K = P𝒞ᵀq (paper, proof of theorem 1).

The error does not depend on the measured ranges, only on the motion, the gains and the stamps of the ranges. Its
transition Ψ over a window is measured in the metric in which the observer contracts. With P = LLᵀ, the singular values
of L(t+δ)⁻¹ Ψ L(t) lie in (0, 1], whatever the units and the axes. The largest one belongs to the error that fades most
slowly. Where the path repeats after T and P has become periodic, the eigenvalues λ of Ψ over T (Floquet multipliers)
give the rate for good: each period multiplies an error along one of their eigenvectors by its λ.

Constant gains only: noise-matched gains depend on the estimate, so that their error is not linear.
"""

import math

import numpy as np
from jaxtyping import Complex, Float
from numpy import ndarray as Array

from rangenav import cascade, model, record
from rangenav.cascade import ObserverConfig
from rangenav.gains import Gains
from rangenav.inputs import require
from rangenav.motion import Motion, World
from rangenav.preset import Preset
from rangenav.record import SETTLED_POSITION, settled
from rangenav.results import result
from rangenav.sensors import Measurements, Sensors
from rangenav.signals import Signal

MOMENTS = 201
"""Moments of a flight at which P and the eigenvalues are kept."""
STILL_CHANGING = 1e-6
"""P counts as periodic when a period changes it by less than this share, in the metric of P itself."""
MOST_STEPS = 2e5
"""Steps of the Riccati equation until P must be periodic: a fifth of a second."""
LONGEST_PERIOD = 600.0
"""s"""
ANY_PERIOD = 1.0
"""s, for a path without acceleration: it repeats after any time."""
ONLY_CONSTANT = "error dynamics need constant gains, got noise-matched"


@result
class ErrorDynamics:
    """How the error of the position, velocity, gravity and ξ fades, by the motion and the gains alone."""

    time: Float[Array, "m"]
    """s"""
    eigenvalues: Complex[Array, "m 13"]
    """1/s, of 𝒜 − K𝒞 at each moment in body axes, the slowest first. Of a time-varying system they prove nothing."""
    position: Float[Array, "m"]
    """m, the length of the position error that the initial error leaves, without noise."""
    window: float
    """s"""
    start: Float[Array, "w"]
    """s, of each window that lies in the flight."""
    contraction: Float[Array, "w 13"]
    """Singular values of the window's transition in the metric of P, the largest first."""
    settle_s: float | None
    """From when on `position` stays below the limit of `record.settled`; None if it does not."""


def time_constant(multipliers: Complex[Array, "13"], period: float) -> float:
    """s, in which the error of the largest multiplier falls to 1/e; infinite if it does not fall."""
    slowest = float(np.abs(multipliers).max())
    return -period / math.log(slowest) if slowest < 1 else math.inf


def of(preset: Preset) -> ErrorDynamics:
    """The error dynamics of a preset's run with constant gains; no observer runs.

    Raises ValueError for noise-matched gains.
    """
    inputs = record.truth_inputs(preset)
    truth, z = record.simulated(inputs), record.measured(inputs, preset.sensors, preset.seed)
    start = cascade.start(preset.guess, state=truth.state[0], rotation=truth.motion.rotation[0], world=preset.world)
    setting = ObserverConfig(world=preset.world, sensors=preset.sensors, gains=preset.gains)
    error = start.state - truth.state[0]
    return along(truth.motion, z, setting, window=preset.requirement.window, error=error)


def along(
    motion: Motion,
    measurements: Measurements,
    setting: ObserverConfig,
    *,
    window: float,
    error: Float[Array, "13"],
) -> ErrorDynamics:
    """As `of`, for a motion, its measurements, of which the stamps count, and an initial error x̂ − x in body axes.

    Raises ValueError for noise-matched gains and for windows longer than the flight.
    """
    require(setting.gains.mode == "constant", ONLY_CONSTANT)
    flight = float(motion.time[-1] - motion.time[0])
    require(0 < window <= flight, f"window must lie in (0, {flight:g}] s, got {window:g}")
    marks = np.unique(np.linspace(0, len(motion.time) - 1, MOMENTS).round().astype(int))
    covariances, transitions = _closed_loop(motion, measurements, setting, marks)
    time, roots = motion.time[marks], np.linalg.cholesky(covariances)
    steps = np.linalg.solve(roots[1:], transitions @ roots[:-1])
    position = _position(transitions, motion.rotation[0], error)
    begin, contraction = _contraction(time, steps, window)
    return ErrorDynamics(
        time=time,
        eigenvalues=_eigenvalues(motion, marks, covariances, setting),
        position=position,
        window=window,
        start=begin,
        contraction=contraction,
        settle_s=settled(time, position, SETTLED_POSITION),
    )


def _closed_loop(
    motion: Motion, z: Measurements, setting: ObserverConfig, marks: Array
) -> tuple[Float[Array, "m 13 13"], Float[Array, "k 13 13"]]:
    """P at the marks, and the transition of the error between neighbouring marks; inertial axes."""
    gains, accel = setting.gains, motion.acceleration - np.asarray(setting.world.gravity)
    variance, symmetric = setting.sensors.range_rate / gains.riccati.q, cascade.ranges_at_imu_rate(z, setting.sensors)
    P = np.diag(gains.riccati.p0.diagonal())
    return _run(motion.time, accel, z.range_time, marks, variance, symmetric, gains, P)


def _run(
    time: Float[Array, "n"],
    accel: Float[Array, "n 3"],
    range_time: Float[Array, "r"],
    marks: Array,
    variance: float,
    symmetric: bool,
    gains: Gains,
    P: Float[Array, "13 13"],
) -> tuple[Float[Array, "m 13 13"], Float[Array, "k 13 13"]]:
    from rangenav.kernels import error_dynamics as kernel

    n, v = model.STATES, gains.riccati.v
    first, blocks = int(np.searchsorted(range_time, time[0], side="right")), (v.xi, v.position, v.velocity, v.gravity)
    covariances, transitions = np.empty((len(marks), n * n)), np.empty((len(marks) - 1, n * n))
    kernel.run(
        time, accel, range_time, first, first > 0, marks, variance, symmetric, blocks, P.ravel().copy(), covariances,
        transitions,
    )  # fmt: skip
    return covariances.reshape(-1, n, n), transitions.reshape(-1, n, n)


def _eigenvalues(
    motion: Motion, marks: Array, covariances: Float[Array, "m 13 13"], setting: ObserverConfig
) -> Complex[Array, "m 13"]:
    closed = np.empty((len(marks), model.STATES, model.STATES))
    gravity_norm = float(np.linalg.norm(setting.world.gravity))
    for k, mark in enumerate(marks):
        gyro, accel = motion.angular_velocity[mark], motion.apparent_acceleration[mark]
        A, _ = model.dynamics(gyro, accel, gravity_norm=gravity_norm)
        turn = _in_body(motion.rotation[mark])
        closed[k] = A
        closed[k][:, 0] -= setting.gains.riccati.q * (turn @ covariances[k][:, 0])
    values = np.linalg.eigvals(closed)
    return np.take_along_axis(values, np.argsort(-values.real, axis=1, kind="stable"), axis=1)


def _in_body(rotation: Float[Array, "3 3"]) -> Float[Array, "13 13"]:
    """The turn of the 13-state from inertial to body axes."""
    turn = np.eye(model.STATES)
    for block in (model.POSITION, model.VELOCITY, model.GRAVITY):
        turn[block, block] = rotation.T
    return turn


def _position(
    transitions: Float[Array, "k 13 13"], rotation: Float[Array, "3 3"], error: Float[Array, "13"]
) -> Float[Array, "m"]:
    """The length of the position error at the marks."""
    now = _in_body(rotation).T @ error
    lengths = [np.linalg.norm(now[model.POSITION])]
    for transition in transitions:
        now = transition @ now
        lengths.append(np.linalg.norm(now[model.POSITION]))
    return np.array(lengths)


def _contraction(
    time: Float[Array, "m"], steps: Float[Array, "k 13 13"], window: float
) -> tuple[Float[Array, "w"], Float[Array, "w 13"]]:
    """Singular values over the windows that begin at a mark, each as long as whole steps come nearest to."""
    length = max(1, round(window / float(np.mean(np.diff(time)))))
    count = len(steps) - length + 1
    product = np.broadcast_to(np.eye(model.STATES), (count, model.STATES, model.STATES))
    for k in range(length):
        product = steps[k : k + count] @ product
    return time[:count], np.linalg.svd(product, compute_uv=False)


def multipliers(path: Signal, world: World, sensors: Sensors, gains: Gains) -> tuple[Complex[Array, "13"] | None, str]:
    """Floquet multipliers of the error over one period of a path, the largest first, or None and why there are none.

    The ranges stand at equal intervals, as many in a period as come nearest to their rate. The Riccati equation is
    run until P repeats. Raises ValueError for noise-matched gains.
    """
    require(gains.mode == "constant", ONLY_CONSTANT)
    period = path.period
    if period is None:
        return None, "the path does not repeat"
    period = period or ANY_PERIOD
    if period > LONGEST_PERIOD:
        return None, f"the path repeats only after {period:.3g} s"
    ranges = max(1, round(period * sensors.range_rate))
    time = np.linspace(0.0, period, 1 + ranges * max(1, round(sensors.imu_rate / sensors.range_rate)))
    accel, marks = path(time, 2) - np.asarray(world.gravity), np.array([0, len(time) - 1])
    every = (len(time) - 1) // ranges
    stamps = time[every::every].copy()  # contiguous, or the kernel is compiled once more
    variance, root = ranges / period / gains.riccati.q, np.diag(np.sqrt(gains.riccati.p0.diagonal()))
    P = np.diag(gains.riccati.p0.diagonal())
    for _ in range(1 + int(MOST_STEPS / len(time))):
        covariances, transitions = _run(time, accel, stamps, marks, variance, False, gains, P)
        P, inverse = covariances[1], np.linalg.inv(root)
        change = np.linalg.norm(inverse @ P @ inverse.T - np.eye(model.STATES), 2)
        if change < STILL_CHANGING:
            values = np.linalg.eigvals(transitions[0])
            return values[np.argsort(-np.abs(values), kind="stable")], ""
        root = np.linalg.cholesky(P)
    return None, "P does not become periodic: on this motion some error does not fade"
