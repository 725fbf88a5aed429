"""The cascaded observer (paper, fig. 2): the Riccati observer's gravity estimate feeds the complementary filter.

`observe()` runs a whole record, `step()` takes one IMU sample at a time (on a vehicle, in a loop); both call the same
kernel and give the same numbers; `plain.observe()` is the same scheme in numpy. Exponentially
stable is not monotone: from x̂ = 0 the position error first peaks.
"""

import math
from dataclasses import dataclass
from types import ModuleType
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model, riccati, so3
from rangenav.attitude import AttitudeGains
from rangenav.inputs import Input, Vec3, require
from rangenav.kernels.layout import Arrays, Parameters
from rangenav.motion import World, to_inertial
from rangenav.riccati import Blocks, RiccatiGains
from rangenav.sensors import Measurements, Sensors, check

MAX_OFFSET = 1e4
NO_PENDING = (np.nan, np.nan)


class Gains(Input, frozen=True, kw_only=True):
    """All gains of the cascade."""

    mode: Literal["constant", "noise-matched"] = "constant"
    """noise-matched takes q and v from the sensors' noise at the estimate; the theorem assumes constant ones."""
    riccati: RiccatiGains = RiccatiGains()
    attitude: AttitudeGains = AttitudeGains()


class Guess(Input, frozen=True, kw_only=True):
    """Where the observer starts: x̂(0) and R̃(0) = R(0) R̂(0)ᵀ = exp(angle [axis]x)."""

    state: Literal["zero", "truth", "offset"] = "zero"
    """zero: x̂ = 0; truth: the lifted true state; offset: the lift of the truth plus the offsets below."""
    position_offset: Vec3 = (0.0, 0.0, 0.0)
    """m, inertial axes."""
    velocity_offset: Vec3 = (0.0, 0.0, 0.0)
    """m/s, inertial axes."""
    gravity_offset: Vec3 = (0.0, 0.0, 0.0)
    """m/s², inertial axes."""
    attitude_axis: Vec3 = (0.0, 1.0, 0.0)
    """Inertial axes; any length but zero."""
    attitude_angle: float = 0.0
    """rad, −π to π."""

    def __post_init__(self) -> None:
        super().__post_init__()
        length = math.hypot(*self.attitude_axis)  # unlike numpy's norm it does not overflow
        require(length > 1e-9, "attitude_axis must not be the zero vector")
        require(length < 1e9, f"attitude_axis must be shorter than 1e9, got {length:g}")
        require(
            abs(self.attitude_angle) <= np.pi + 1e-12,
            f"attitude_angle must lie in [-π, π] rad, got {self.attitude_angle:g}",
        )
        for name in ("position_offset", "velocity_offset", "gravity_offset"):
            size = math.hypot(*getattr(self, name))
            require(size <= MAX_OFFSET, f"{name} must not be longer than {MAX_OFFSET:g}, got {size:g}")


@dataclass(frozen=True, eq=False, kw_only=True)
class Setting:
    """What the observer knows beforehand: world, gains, the model's form, and what it may assume of the sensors."""

    world: World
    sensors: Sensors
    gains: Gains
    form: model.Form = "derived"


@dataclass(frozen=True, eq=False, kw_only=True)
class Start:
    """An initial estimate: the 13-state in body axes and R̂."""

    state: Float[Array, "13"]
    rotation: Float[Array, "3 3"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """What the observers made of a record, time first; the 13-state in body axes."""

    time: Float[Array, "n"]
    state: Float[Array, "n 13"]
    covariance: Float[Array, "n 3 3 3"]
    """Position, velocity and gravity blocks of P, body axes."""
    xi_variance: Float[Array, "n 4"]
    rotation: Float[Array, "n 3 3"]
    innovation: Float[Array, "m 2"]
    """y − ŷ (m²) and its variance P₁₁ + R (m⁴), one row for each range; NaN for a range before the first step."""

    @property
    def std(self) -> Float[Array, "n 13"]:
        """Square roots of P's diagonal in body axes; NaN where P has diverged."""
        vectors = np.diagonal(self.covariance, axis1=-2, axis2=-1).reshape(len(self.time), 9)
        with np.errstate(invalid="ignore"):
            return np.sqrt(np.concatenate([self.xi_variance, vectors], axis=-1))

    def position(self, world: World) -> Float[Array, "n 3"]:
        """p̂_I = p_anchor + R̂ p̂_B (m, inertial axes)."""
        return np.asarray(world.anchor) + to_inertial(self.rotation, self.state[:, model.POSITION])


@dataclass(frozen=True, eq=False, kw_only=True)
class Errors:
    """Norms of the errors over time: the Riccati observer's in body axes (paper, fig. 3), the attitude's (fig. 4)."""

    position: Float[Array, "n"]
    velocity: Float[Array, "n"]
    gravity: Float[Array, "n"]
    attitude: Float[Array, "n"]
    """rad"""


class Sample(NamedTuple):
    """One IMU sample, with the ranges that came since the one before it."""

    time: float
    gyro: Float[Array, "3"]
    accel: Float[Array, "3"]
    mag: Float[Array, "3"]
    """NaN if the magnetometer gave no sample."""
    range_time: Float[Array, "r"]
    """s, increasing, after the sample before and not after this one."""
    range: Float[Array, "r"]


@dataclass(frozen=True, eq=False, kw_only=True)
class State:
    """The observer between two samples. Treat it as a value: `step` returns a new one."""

    time: float
    arrays: Arrays
    """The kernel's own, in turned axes; read them through `state`, `std`, `rotation`."""
    parameters: Parameters

    @property
    def state(self) -> Float[Array, "13"]:
        """x̂, body axes."""
        return self._read()[0]

    @property
    def std(self) -> Float[Array, "13"]:
        """Square roots of P's diagonal, body axes."""
        vectors = np.diagonal(self._read()[1], axis1=-2, axis2=-1).ravel()
        return np.sqrt(np.concatenate([self.arrays.P[: 4 * (model.STATES + 1) : model.STATES + 1], vectors]))

    @property
    def rotation(self) -> Float[Array, "3 3"]:
        """R̂."""
        return self.arrays.rotation

    def _read(self) -> tuple[Array, Array]:
        state, covariance = np.empty(model.STATES), np.empty((3, 3, 3))
        _kernel().read(self.arrays, state, covariance)
        return state, covariance


def start(guess: Guess, *, state: Float[Array, "13"], rotation: Float[Array, "3 3"], world: World) -> Start:
    """The initial estimate that a guess means for a vehicle whose true first state and R(0) are given."""
    axis = np.asarray(guess.attitude_axis) / np.linalg.norm(guess.attitude_axis)
    start_rotation = so3.exp(-guess.attitude_angle * axis) @ rotation
    if guess.state == "zero":
        return Start(state=np.zeros(model.STATES), rotation=start_rotation)
    if guess.state == "truth":
        return Start(state=state.copy(), rotation=start_rotation)
    offsets = (guess.position_offset, guess.velocity_offset, guess.gravity_offset)
    blocks = (model.POSITION, model.VELOCITY, model.GRAVITY)
    body = [state[block] + rotation.T @ np.asarray(offset) for block, offset in zip(blocks, offsets, strict=True)]
    return Start(state=model.lift(*body), rotation=start_rotation)


def parameters(setting: Setting, *, symmetric: bool) -> Parameters:
    """The setting in the kernel's terms; `symmetric` where ranges come at the IMU's rate."""
    gains, sensors, world = setting.gains, setting.sensors, setting.world
    matched = gains.mode == "noise-matched"
    v = gains.riccati.v
    floor = riccati.V_RANGE[0]
    return Parameters(
        gravity=_floats(world.gravity),
        magnetic=_floats(world.magnetic),
        b4=model.input_4(float(np.linalg.norm(world.gravity)), setting.form),
        variance=sensors.range_rate / gains.riccati.q,
        v=(floor, floor, floor, floor) if matched else _densities(v),
        k1=float(gains.attitude.k1),
        rho1=float(gains.attitude.rho1),
        rho2=float(gains.attitude.rho2),
        symmetric=symmetric and not matched,
        matched=matched,
        range_sigma=float(sensors.sigma.range),
        accel_density=sensors.sigma.accel**2 / sensors.imu_rate,
        gyro_density=sensors.sigma.gyro**2 / sensors.imu_rate,
    )


def begin(first: Sample, start: Start, setting: Setting, *, symmetric: bool = False) -> State:
    """The observer at its first IMU sample; ranges stamped at that time are applied when the next sample comes."""
    given = parameters(setting, symmetric=symmetric)
    missing = np.isnan(first.mag).any()
    expected = start.rotation.T @ np.asarray(given.magnetic)
    arrays = Arrays(
        x=start.state.astype(float),
        P=np.diag(setting.gains.riccati.p0.diagonal()).ravel(),
        turned=np.eye(3),
        rotation=start.rotation.astype(float),
        gyro=np.array(first.gyro, dtype=float),
        accel=np.array(first.accel, dtype=float),
        mag=np.array(expected if missing else first.mag, dtype=float),
        pending=np.array(NO_PENDING),
    )
    at_start = np.asarray(first.range_time) == first.time
    if at_start.any():
        _kernel().begin(arrays, float(np.asarray(first.range)[at_start][-1]), given)
    return State(time=float(first.time), arrays=arrays, parameters=given)


def step(state: State, sample: Sample) -> State:
    """The observer at the next IMU sample. Raises ValueError for stamps out of order or numbers that are not finite."""
    _check(state.time, sample)
    arrays = Arrays(*(array.copy() for array in state.arrays))
    count = len(sample.range)
    innovation = np.empty((count, 2))
    _kernel().advance(
        arrays, state.time, sample.time, sample.gyro, sample.accel, sample.mag,
        sample.range_time, sample.range, 0, count, innovation, state.parameters,
    )  # fmt: skip
    return State(time=sample.time, arrays=arrays, parameters=state.parameters)


def observe(measurements: Measurements, start: Start, setting: Setting) -> Estimate:
    """Run both observers over a record."""
    check(measurements)
    z = measurements
    count, ranges = len(z.time), len(z.range_time)
    state = begin(_first_sample(z), start, setting, symmetric=ranges_at_imu_rate(z, setting.sensors))
    estimate = Estimate(
        time=z.time,
        state=np.empty((count, model.STATES)),
        covariance=np.empty((count, 3, 3, 3)),
        xi_variance=np.empty((count, 4)),
        rotation=np.empty((count, 3, 3)),
        innovation=np.full((ranges, 2), np.nan),
    )
    skipped = int(np.searchsorted(z.range_time, z.time[0], side="right"))
    _kernel().run(
        state.arrays, z.time, z.gyro, z.accel, z.mag, z.range_time, z.range, estimate.state,
        estimate.xi_variance, estimate.covariance, estimate.rotation, estimate.innovation, skipped, state.parameters,
    )  # fmt: skip
    return estimate


def ranges_at_imu_rate(measurements: Measurements, sensors: Sensors) -> bool:
    """Whether the symmetric scheme applies: every range on an IMU stamp, at the IMU's rate. Gaps do not matter."""
    on_stamp = bool(np.isin(measurements.range_time, measurements.time).all())
    return on_stamp and sensors.range_rate == sensors.imu_rate


def errors(estimate: Estimate, *, truth: Float[Array, "n 13"], rotation: Float[Array, "n 3 3"]) -> Errors:
    """Norms of the body-axes errors and the angle of R̃ = R R̂ᵀ."""
    difference = estimate.state - truth
    blocks = (model.POSITION, model.VELOCITY, model.GRAVITY)
    position, velocity, gravity = (np.linalg.norm(difference[:, block], axis=-1) for block in blocks)
    attitude_error = so3.angle(rotation @ np.swapaxes(estimate.rotation, -1, -2))
    return Errors(position=position, velocity=velocity, gravity=gravity, attitude=attitude_error)


def _check(time: float, sample: Sample) -> None:
    require(sample.time > time, f"time must increase: {sample.time:g} after {time:g}")
    finite = np.isfinite(sample.gyro).all() and np.isfinite(sample.accel).all() and np.isfinite(sample.range).all()
    require(bool(finite), f"gyro, accel and range must be finite, at time {sample.time:g}")
    require(not np.isinf(sample.mag).any(), f"mag must be finite, or NaN where there is none, at time {sample.time:g}")
    stamps = np.concatenate([[time], sample.range_time])
    ordered = bool(np.all(np.diff(stamps) > 0)) and stamps[-1] <= sample.time
    require(ordered, f"range_time must increase and lie after the last sample and not after time {sample.time:g}")


def _first_sample(z: Measurements) -> Sample:
    due = z.range_time == z.time[0]
    return Sample(z.time[0], z.gyro[0], z.accel[0], z.mag[0], z.range_time[due], z.range[due])


def _floats(vector: Vec3) -> Vec3:
    """Whole numbers become floats, so that the kernels meet one type only and compile once."""
    return float(vector[0]), float(vector[1]), float(vector[2])


def _densities(v: Blocks) -> tuple[float, float, float, float]:
    return float(v.xi), float(v.position), float(v.velocity), float(v.gravity)


def _kernel() -> ModuleType:
    """The compiled kernels, imported where they are used: numba alone takes as long to import as everything else."""
    from rangenav.kernels import cascade as kernel

    return kernel
