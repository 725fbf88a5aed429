"""The cascaded observer (paper, fig. 2): the Riccati observer's gravity estimate feeds the complementary filter.

`observe()` runs a whole record, `step()` takes one IMU sample at a time (on a vehicle, in a loop). Both call the same
compiled kernel and give the same numbers; `reference.observe()` is the same scheme in numpy. Everything that a caller
gives is checked here, before a kernel reads it: a ValueError says in one sentence what is wrong.
Exponentially stable is not monotone: from x̂ = 0 the position error first peaks.
"""

from collections.abc import Sequence
from functools import cache
from types import ModuleType
from typing import NamedTuple, get_args

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model, riccati, so3
from rangenav.arguments import DOUBLE, array, described, finite_array, increasing_array, instance, number
from rangenav.attitude import MISALIGNED, Schedule
from rangenav.gains import Gains, Guess
from rangenav.inputs import Vec3, require
from rangenav.kernels.layout import (
    ACCEL_FAULT,
    GYRO_FAULT,
    MAG_FAULT,
    NO_FAULT,
    RANGE_FAULT,
    RANGE_TIME_FAULT,
    TIME_FAULT,
    Arrays,
    Parameters,
)
from rangenav.motion import World, to_inertial
from rangenav.results import result
from rangenav.riccati import Blocks
from rangenav.sensors import NO_SAMPLE, Measurements, Sensors, check

NO_PENDING = (np.nan, np.nan)
VECTOR, MATRIX = (3,), (3, 3)
FINITE = "gyro, accel and range must be finite"
FAULTS = {
    GYRO_FAULT: FINITE,
    ACCEL_FAULT: FINITE,
    RANGE_FAULT: FINITE,
    MAG_FAULT: "mag must be finite, or NaN where there is none",
    RANGE_TIME_FAULT: "range_time must increase and lie after the last sample and not after this one",
}
"""The rule that a sample breaks, by what the kernel returns."""


@result
class ObserverConfig:
    """What the observer knows beforehand: world, gains, the model's form, and the sensors' rates and noise."""

    world: World
    sensors: Sensors
    gains: Gains
    form: model.ModelForm = "derived"


@result
class Start:
    """An initial estimate."""

    state: Float[Array, "13"]
    """x̂(0), the 13-state of `model`, body axes."""
    rotation: Float[Array, "3 3"]
    """R̂(0), from body to inertial axes."""


@result
class Estimate:
    """What the observers estimate of a record, time first."""

    time: Float[Array, "n"]
    """s, the IMU's clock."""
    state: Float[Array, "n 13"]
    """x̂, the 13-state of `model`, body axes."""
    covariance: Float[Array, "n 3 3 3"]
    """Position, velocity and gravity blocks of P, body axes."""
    xi_variance: Float[Array, "n 4"]
    """The first four diagonal entries of P, of ξ1…ξ4."""
    rotation: Float[Array, "n 3 3"]
    """R̂, from body to inertial axes."""
    innovation: Float[Array, "m 2"]
    """y − ŷ (m²) and its variance P₁₁ + R (m⁴), one row for each range; NaN for a range before the first step."""
    k1: Float[Array, "n"] | None = None
    """1/s, the attitude gain in force, constant without a schedule; None for an estimator without this gain."""

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
    """One IMU sample, with the ranges that came since the sample before it; body axes. Lists will do for arrays."""

    time: float
    """s"""
    gyro: Float[Array, "3"] | Sequence[float]
    """rad/s"""
    accel: Float[Array, "3"] | Sequence[float]
    """m/s², apparent acceleration (specific force) Rᵀ(p̈ − g)."""
    mag: Float[Array, "3"] | Sequence[float]
    """Unit vector; three NaN if the magnetometer gave no sample."""
    range_time: Float[Array, "r"] | Sequence[float]
    """s, increasing, after the time of the sample before and not after the time of this one; empty without ranges."""
    range: Float[Array, "r"] | Sequence[float]
    """m"""


@result
class State:
    """The observer between two samples, made by `begin` and `step`. Treat it as a value: `step` returns a new one."""

    time: float
    """s, of the last sample."""
    arrays: Arrays
    """The kernel's own, in turned axes; read them through `state`, `std`, `rotation`."""
    parameters: Parameters
    """The configuration in the kernel's terms."""

    @property
    def state(self) -> Float[Array, "13"]:
        """x̂, body axes."""
        return self._read()[0]

    @property
    def std(self) -> Float[Array, "13"]:
        """Square roots of P's diagonal, body axes, in the units of the state."""
        vectors = np.diagonal(self._read()[1], axis1=-2, axis2=-1).ravel()
        return np.sqrt(np.concatenate([self.arrays.P[: 4 * (model.STATES + 1) : model.STATES + 1], vectors]))

    @property
    def rotation(self) -> Float[Array, "3 3"]:
        """R̂, from body to inertial axes."""
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
    """The initial estimate that a guess stands for, where the true first state (body axes) and R(0) are these."""
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
    """The configuration in the kernel's terms; `symmetric` where ranges come at the IMU's rate."""
    instance("setting", setting, ObserverConfig, called="cascade.ObserverConfig")
    forms = get_args(model.ModelForm)
    require(setting.form in forms, f"setting.form must be {' or '.join(forms)}, got {described(setting.form)}")
    gains, sensors, world = setting.gains, setting.sensors, setting.world
    plan = gains.attitude.schedule or Schedule()  # without a schedule the kernel does not use these numbers
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
    """The observer at its first IMU sample; ranges stamped at that time are applied when the next sample comes.

    `symmetric` where every range comes with an IMU sample, at the IMU's rate: half of each correction is then applied
    before the estimate is read and half after, which makes the estimate second order in the step.
    Raises ValueError for arrays of the wrong shape or type, stamps out of order, or numbers that are not finite.
    """
    instance("first", first, Sample, called="cascade.Sample")
    time, start, p = number("time", first.time), checked_start(start), parameters(setting, symmetric=symmetric)
    mag = array("mag", first.mag, VECTOR, none=NO_SAMPLE)
    require(not np.isinf(mag).any(), f"{FAULTS[MAG_FAULT]}, at time {time:g}")
    range_time = increasing_array("range_time", first.range_time, ("r",))
    distance = finite_array("range", first.range, range_time.shape)
    expected = start.rotation.T @ np.asarray(p.magnetic)
    arrays = Arrays(
        x=start.state.copy(),
        P=np.diag(setting.gains.riccati.p0.diagonal()).ravel(),
        turned=np.eye(3),
        rotation=start.rotation.copy(),
        gyro=finite_array("gyro", first.gyro, VECTOR).copy(),
        accel=finite_array("accel", first.accel, VECTOR).copy(),
        mag=expected if np.isnan(mag).any() else mag.copy(),
        misaligned=np.array([MISALIGNED]),
        pending=np.array(NO_PENDING),
    )
    at_start = range_time == time
    if at_start.any():
        _kernel().begin(arrays, float(distance[at_start][-1]), p)
    return State(time=time, arrays=arrays, parameters=p)


def step(state: State, sample: Sample) -> State:
    """The observer at the next IMU sample.

    Raises ValueError for arrays of the wrong shape or type, stamps out of order, or numbers that are not finite.
    """
    if type(state) is not State:
        raise ValueError(f"state must be a cascade.State, got {described(state)}")
    if type(sample) is not Sample:
        raise ValueError(f"sample must be a cascade.Sample, got {described(sample)}")
    time, gyro, accel, mag, range_time, distance = checked_sample(sample)
    arrays = Arrays(*(part.copy() for part in state.arrays))
    fault = _kernel().step(
        arrays, state.time, time, gyro, accel, mag, range_time, distance, np.empty((len(distance), 2)),
        state.parameters,
    )  # fmt: skip
    if fault != NO_FAULT:
        _refuse_sample(fault, state.time, time)
    return State(time=time, arrays=arrays, parameters=state.parameters)


def checked_sample(sample: Sample) -> tuple[float, Array, Array, Array, Array, Array]:
    """The fields of a sample as a float and arrays of the shapes that the kernel reads; it looks at their numbers.

    Raises ValueError in one sentence for an array of the wrong shape or type.
    """
    time, gyro, accel, mag, range_time, distance = sample
    time = number("time", time)
    for vector in (gyro, accel, mag):  # what `array` finds to be right already, without the call: half the time
        if not (type(vector) is Array and vector.dtype is DOUBLE and vector.shape == VECTOR and vector.flags.carray):
            gyro, accel = array("gyro", gyro, VECTOR), array("accel", accel, VECTOR)
            mag = array("mag", mag, VECTOR, none=NO_SAMPLE)
            break
    range_time = array("range_time", range_time, ("r",))
    return time, gyro, accel, mag, range_time, array("range", distance, range_time.shape)


def checked_start(start: Start) -> Start:
    """The start as float64 arrays. Raises ValueError for a wrong shape or type, and for numbers that are not finite."""
    instance("start", start, Start, called="cascade.Start")
    state = finite_array("start.state", start.state, (model.STATES,))
    return Start(state=state, rotation=finite_array("start.rotation", start.rotation, MATRIX))


def observe(measurements: Measurements, start: Start, setting: ObserverConfig) -> Estimate:
    """Run both observers over a record.

    Raises ValueError for arrays of the wrong shape or type, stamps out of order, or numbers that are not finite; only
    mag may be NaN, where the magnetometer gave no sample.
    """
    z = check(measurements)
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
    """R̂ over a record from many R̂(0), to the last bit what `observe` gives for each; `start` gives x̂(0) for all.

    x̂ does not depend on R̂, so it is computed once: hundreds of starts cost little more than their attitude filters.
    Raises ValueError as `observe` does, and if the first magnetometer sample is missing: each start would then expect
    another vector there.
    """
    z, rotations = check(measurements), finite_array("rotations", rotations, ("j", *MATRIX))
    require(not np.isnan(z.mag[0]).any(), "many starts need a magnetometer sample at the first IMU sample")
    state = begin(_first_sample(z), start, setting, symmetric=ranges_at_imu_rate(z, setting.sensors))
    estimates = np.empty((len(rotations), len(z.time), 3, 3))
    estimates[:, 0] = rotations
    _kernel().run_attitudes(
        state.arrays, z.time, z.gyro, z.accel, z.mag, z.range_time, z.range, estimates, np.empty((len(z.range), 2)),
        _skipped(z), state.parameters,
    )  # fmt: skip
    return estimates


def ranges_at_imu_rate(measurements: Measurements, sensors: Sensors) -> bool:
    """Whether the symmetric scheme applies: every range on an IMU stamp, at the IMU's rate. Gaps do not matter."""
    on_stamp = bool(np.isin(measurements.range_time, measurements.time).all())
    return on_stamp and sensors.range_rate == sensors.imu_rate


def _refuse_sample(fault: int, before: float, time: float) -> None:
    if fault == TIME_FAULT:
        raise ValueError(f"time must increase: {time:g} after {before:g}")
    raise ValueError(f"{FAULTS[fault]}, at time {time:g}")


def _first_sample(z: Measurements) -> Sample:
    due = z.range_time == z.time[0]
    return Sample(z.time[0], z.gyro[0], z.accel[0], z.mag[0], z.range_time[due], z.range[due])


def _skipped(z: Measurements) -> int:
    """How many ranges are stamped at the first sample or before it."""
    return int(np.searchsorted(z.range_time, z.time[0], side="right"))


def _floats(vector: Vec3) -> Vec3:
    """Whole numbers become floats, so that the kernels are called with one type only and compile once."""
    return float(vector[0]), float(vector[1]), float(vector[2])


def _densities(v: Blocks) -> tuple[float, float, float, float]:
    return float(v.xi), float(v.position), float(v.velocity), float(v.gravity)


@cache
def _kernel() -> ModuleType:
    """The compiled kernels, imported where they are used: numba alone takes as long to import as everything else."""
    from rangenav.kernels import cascade as kernel

    return kernel
