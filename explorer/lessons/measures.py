"""Numbers of a state that the figures of a text and the checks of several lessons share.

What takes more than a few milliseconds is cached by the preset, because a check is asked after every change.
"""

import math
from functools import lru_cache

import numpy as np

from explorer.lessons.state import State
from explorer.model import details
from explorer.model.compute import Picture, compute
from rangenav import analysis, attitude, ensemble, formats, motion, record, so3, vehicle
from rangenav.certificate import exports
from rangenav.ensemble.runs import attitude_errors
from rangenav.model import GRAVITY, POSITION
from rangenav.motion import Limits, Motion, to_body
from rangenav.observability import excitation
from rangenav.preset import Preset
from rangenav.record import SETTLED_ATTITUDE
from rangenav.signals import Polynomials, polynomials
from rangenav.twin import Twin
from rangenav.vehicle import Break

CACHED = 8
STARTS = 101
"""Windows over which the excitation of a file is computed."""
SEEDS = 5
"""Runs by which gains are judged: in a single one the noise may happen to favour them."""
NEAR_HALF_TURN = math.pi - 0.01
"""rad: an initial attitude error close to an undesired equilibrium."""

PARTS = {
    "path": "the path",
    "angular_velocity": "the angular velocity",
    "duration": "the flight duration",
    "world": "the anchor, gravity and the magnetic direction",
    "sensors": "the sensors",
    "gains": "the gains",
    "guess": "the initial estimate",
    "requirement": "the time window",
    "vehicle": "the vehicle",
}
"""What sentences call the parts of a preset."""


def changed(preset: Preset, start: Preset, *parts: str) -> str:
    """One sentence if a part of a preset that belongs to the task is not as at the start; empty if all are."""
    others = [words for name, words in PARTS.items() if name in parts and getattr(preset, name) != getattr(start, name)]
    return f"Put back what is part of the task: {' and '.join(others)}." if others else ""


def picture(state: State) -> Picture:
    """What the page shows of a state. Its stages are cached, so that several figures compute it once."""
    return compute(state.settings)


def twin(state: State) -> Twin | None:
    """The evil twin; None if the motion has none."""
    found = details.details(state.preset, turn=state.settings.twin_turn).twin
    return found if isinstance(found, Twin) else None


def mu(preset: Preset) -> float:
    """The least excitation over the windows (m²/s⁷); 0 where it is rounding."""
    return analysis.sampled(preset).resolved_mu


def mu_printed(preset: Preset) -> float:
    """The excitation (m²/s⁷) that the printed condition finds on its worst window."""
    return details.details(preset).printed.mu_printed


def rank(preset: Preset) -> int:
    """How many of the 13 quantities every window determines."""
    return analysis.sampled(preset).known_rank


def sigma(preset: Preset) -> float:
    """The position error of one window (m), linear model, on the worst window; infinite if it is blind."""
    return analysis.sampled(preset).lifted_end.position


def sigma_nonlinear(preset: Preset) -> float:
    """The position error of one window (m), true model."""
    return analysis.sampled(preset).nonlinear_end.position


def moved(preset: Preset) -> Motion:
    """The motion."""
    return record.simulated(record.truth_inputs(preset)).motion


def limits(preset: Preset) -> Limits:
    """The largest speed, acceleration and thrust of the motion."""
    return motion.limits(moved(preset), world=preset.world)


def broken(preset: Preset) -> tuple[Break, ...]:
    """The limits of the vehicle that the motion exceeds."""
    return vehicle.broken(moved(preset), preset.vehicle, world=preset.world)


def anchor_distance(preset: Preset) -> float:
    """The least distance to the anchor (m)."""
    return float(np.linalg.norm(moved(preset).position - np.array(preset.world.anchor), axis=1).min())


def range_swing(preset: Preset) -> float:
    """How far the true range goes to each side of its middle (m)."""
    return float(np.ptp(np.linalg.norm(moved(preset).position - np.array(preset.world.anchor), axis=1))) / 2


def swing(preset: Preset) -> float:
    """How far the height goes to each side of its middle (m)."""
    gravity = np.array(preset.world.gravity)
    height = moved(preset).position @ gravity / np.linalg.norm(gravity)
    return float(np.ptp(height)) / 2


def stiffness(state: State) -> float:
    """The fastest rate of the attitude filter times the step of the IMU; from 2 on the filter is unstable."""
    p = state.preset
    return float(1 / attitude.time_constants(p.gains.attitude, p.world)[-1] / p.sensors.imu_rate)


def gravity_estimate(state: State) -> tuple[float, float]:
    """Mean and standard deviation of |ĝ| over the last quarter of the run (m/s²)."""
    return _middle(np.linalg.norm(picture(state).estimate.state[:, GRAVITY], axis=1))


def correction(state: State) -> float:
    """Length of the mean of k1 σ over the last quarter (rad/s): what the attitude filter adds to the gyro."""
    shown = picture(state)
    last = slice(3 * len(shown.estimate.time) // 4, None)
    gains, world, rotation = shown.preset.gains.attitude, shown.preset.world, shown.estimate.rotation[last]
    field, down = (np.broadcast_to(vector, (len(rotation), 3)) for vector in (world.magnetic, world.gravity))
    mag = np.cross(shown.measurements.mag[last], to_body(rotation, field))
    gravity = np.cross(shown.estimate.state[last, GRAVITY], to_body(rotation, down))
    mean = np.nanmean(gains.rho1 * mag + gains.rho2 * gravity, axis=0)
    return gains.k1 * float(np.linalg.norm(mean))


def lift_mismatch(state: State) -> tuple[float, float]:
    """Mean and standard deviation of ξ̂1 − ½|p̂|² over the last quarter of the run (m²)."""
    x = picture(state).estimate.state
    return _middle(x[:, 0] - 0.5 * (x[:, POSITION] ** 2).sum(axis=1))


def innovation(state: State) -> tuple[float, float]:
    """Mean and standard deviation of y − ŷ over the last quarter of the ranges (m²)."""
    found = picture(state).estimate.innovation[:, 0]
    return _middle(found[np.isfinite(found)])


def _middle(values: np.ndarray) -> tuple[float, float]:
    last = values[3 * len(values) // 4 :]
    return float(last.mean()), float(last.std())


@lru_cache(maxsize=CACHED)
def worst_of_seeds(preset: Preset) -> tuple[float, float]:
    """The largest steady position error of five runs with other noise, and the largest peak of the error (m)."""
    runs = ensemble.seeds(preset, SEEDS)
    return float(runs.steady_position.max()), float(runs.peak_position.max())


@lru_cache(maxsize=CACHED)
def slowest_start(preset: Preset) -> float:
    """From when on the attitude error stays below 5° (s), from the slowest of three starts: nearly half a turn about
    each eigenvector of M. Infinite if it does not get there."""
    inputs = record.truth_inputs(preset)
    truth, z = record.simulated(inputs), record.measured(inputs, preset.sensors, preset.seed)
    _, axes = np.linalg.eigh(attitude.decay_matrix(preset.gains.attitude, preset.world))
    starts = so3.exp(-NEAR_HALF_TURN * axes.T) @ truth.motion.rotation[0]
    times = [record.settled(z.time, e, SETTLED_ATTITUDE) for e in attitude_errors(preset, truth, z, starts)]
    return max(math.inf if time is None else time for time in times)


def file_mu(state: State) -> float | None:
    """The excitation (m²/s⁷) of the polynomials in the exported file, read again, over the window of the preset: of a
    path that closes, of the loop without its ramps. None without such a file. Raises ValueError for a broken one."""
    if state.exported is None or state.exported[0] != "polynomial":
        return None
    p = state.preset
    return _file_mu(state.exported[1], bool(p.path.period), p.requirement.window)


@lru_cache(maxsize=CACHED)
def _file_mu(content: bytes, closed: bool, window: float) -> float:
    path = formats.parse(content, "polynomial", source="the exported file", confirm={}).path
    assert isinstance(path, Polynomials)
    length = sum(piece.duration for piece in path.pieces)
    last = length if closed else length - window
    if last <= 0:
        return 0.0
    course = polynomials.loop(path, 0, len(path.pieces)) if closed else path
    return float(excitation.eigenvalues(course, np.linspace(0, last, STARTS), window)[:, 0].min())


def misses(preset: Preset) -> tuple[str, ...]:
    """The names of the requirements that the preset's certificate says it misses. It takes up to a second."""
    return tuple(check.name for check in exports.certificate_of(preset).checks if not check.met)
