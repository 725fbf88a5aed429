"""The cascaded observer (paper, fig. 2): the Riccati observer's gravity estimate feeds the complementary filter.

`observe()` runs a whole record, `step()` takes one IMU sample at a time (on a vehicle, in a loop); both call the same
kernel and give the same numbers; `plain.observe()` is the same scheme in numpy. Exponentially
stable is not monotone: from x̂ = 0 the position error first peaks.
"""

from dataclasses import dataclass
from types import ModuleType
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model, riccati, so3
from rangenav.attitude import MISALIGNED, Schedule
from rangenav.gains import Gains, Guess
from rangenav.inputs import Vec3, require
from rangenav.kernels.layout import Arrays, Parameters
from rangenav.motion import World, to_inertial
from rangenav.riccati import Blocks
from rangenav.sensors import Measurements, Sensors, check

NO_PENDING = (np.nan, np.nan)


@dataclass(frozen=True, eq=False, kw_only=True)
class ObserverConfig:
    """What the observer knows beforehand: world, gains, the model's form, and what it may assume of the sensors."""

    world: World
    sensors: Sensors
    gains: Gains
    form: model.ModelForm = "derived"


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
    k1: Float[Array, "n"] | None = None
    """1/s, the attitude gain in force, constant without a schedule; None of an estimator that has none."""

    @property
    def std(self) -> Float[Array, "n 13"]:
        """Square roots of P's diagonal in body axes; NaN where P has diverged."""
        vectors = np.diagonal(self.covariance, axis1=-2, axis2=-1).reshape(len(self.time), 9)
        with np.errstate(invalid="ignore"):
            return np.sqrt(np.concatenate([self.xi_variance, vectors], axis=-1))

    def position(self, world: World) -> Float[Array, "n 3"]:
        """p̂_I = p_anchor + R̂ p̂_B (m, inertial axes)."""
        return np.asarray(world.anchor) + to_inertial(self.rotation, self.state[:, model.POSITION])


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

    @property
    def k1(self) -> float:
        """1/s, the attitude gain in force."""
        return _kernel().k1(self.arrays, self.parameters)

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


def parameters(setting: ObserverConfig, *, symmetric: bool) -> Parameters:
    """The setting in the kernel's terms; `symmetric` where ranges come at the IMU's rate."""
    gains, sensors, world = setting.gains, setting.sensors, setting.world
    plan = gains.attitude.schedule or Schedule()  # without one its numbers are passed on all the same, and not asked
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
        scheduled=gains.attitude.schedule is not None,
        k1_steady=float(plan.steady),
        halfway=float(plan.halfway),
        memory=float(plan.memory),
        symmetric=symmetric and not matched,
        matched=matched,
        range_sigma=float(sensors.sigma.range),
        accel_density=sensors.sigma.accel**2 / sensors.imu_rate,
        gyro_density=sensors.sigma.gyro**2 / sensors.imu_rate,
    )


def begin(first: Sample, start: Start, setting: ObserverConfig, *, symmetric: bool = False) -> State:
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
        misaligned=np.array([MISALIGNED]),
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


def observe(measurements: Measurements, start: Start, setting: ObserverConfig) -> Estimate:
    """Run both observers over a record."""
    check(measurements)
    z = measurements
    count, ranges = len(z.time), len(z.range_time)
    state = begin(_first_sample(z), start, setting, symmetric=ranges_at_imu_rate(z, setting.sensors))
    k1 = np.empty(count)
    estimate = Estimate(
        time=z.time,
        state=np.empty((count, model.STATES)),
        covariance=np.empty((count, 3, 3, 3)),
        xi_variance=np.empty((count, 4)),
        rotation=np.empty((count, 3, 3)),
        innovation=np.full((ranges, 2), np.nan),
        k1=k1,
    )
    _kernel().run(
        state.arrays, z.time, z.gyro, z.accel, z.mag, z.range_time, z.range, estimate.state, estimate.xi_variance,
        estimate.covariance, estimate.rotation, k1, estimate.innovation, _skipped(z), state.parameters,
    )  # fmt: skip
    return estimate


def attitudes(
    measurements: Measurements, start: Start, setting: ObserverConfig, *, rotations: Float[Array, "j 3 3"]
) -> Float[Array, "j n 3 3"]:
    """R̂ over a record from many R̂(0), to the last bit what `observe` makes of each; `start` gives x̂(0) for all.

    x̂ does not know R̂, so it is found once: hundreds of starts cost little more than their attitude filters. Raises
    ValueError if the first magnetometer sample is missing, for then each start would expect another one.
    """
    check(measurements)
    z = measurements
    require(not np.isnan(z.mag[0]).any(), "many starts need a magnetometer sample at the first IMU sample")
    state = begin(_first_sample(z), start, setting, symmetric=ranges_at_imu_rate(z, setting.sensors))
    found = np.empty((len(rotations), len(z.time), 3, 3))
    found[:, 0] = rotations
    _kernel().run_attitudes(
        state.arrays, z.time, z.gyro, z.accel, z.mag, z.range_time, z.range, found, np.empty((len(z.range), 2)),
        _skipped(z), state.parameters,
    )  # fmt: skip
    return found


def ranges_at_imu_rate(measurements: Measurements, sensors: Sensors) -> bool:
    """Whether the symmetric scheme applies: every range on an IMU stamp, at the IMU's rate. Gaps do not matter."""
    on_stamp = bool(np.isin(measurements.range_time, measurements.time).all())
    return on_stamp and sensors.range_rate == sensors.imu_rate


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


def _skipped(z: Measurements) -> int:
    """How many ranges are not later than the first sample."""
    return int(np.searchsorted(z.range_time, z.time[0], side="right"))


def _floats(vector: Vec3) -> Vec3:
    """Whole numbers become floats, so that the kernels meet one type only and compile once."""
    return float(vector[0]), float(vector[1]), float(vector[2])


def _densities(v: Blocks) -> tuple[float, float, float, float]:
    return float(v.xi), float(v.position), float(v.velocity), float(v.gravity)


def _kernel() -> ModuleType:
    """The compiled kernels, imported where they are used: numba alone takes as long to import as everything else."""
    from rangenav.kernels import cascade as kernel

    return kernel
