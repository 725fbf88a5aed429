"""The cascaded observer, one IMU sample at a time: `begin` at the first sample, `step` at each that follows."""

from collections.abc import Callable
from functools import cache
from typing import get_args

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model, so3
from rangenav.arguments import array, described, finite_array, increasing_array, instance, number
from rangenav.attitude import MISALIGNED, Schedule
from rangenav.cascade.values import ObserverConfig, Sample, Start, State, kernel, sample_kernel
from rangenav.gains import Guess
from rangenav.inputs import Vec3, require
from rangenav.kernels.layout import (
    ACCEL_FAULT,
    COLLECTS,
    CONSTANT,
    GYRO_FAULT,
    LENGTH,
    MAG_FAULT,
    MATCHED,
    NO_FAULT,
    PHASE,
    RANGE_FAULT,
    RANGE_TIME_FAULT,
    SCALE,
    SHAPE_FAULT,
    TIME_FAULT,
    Parameters,
    views,
)
from rangenav.motion import World
from rangenav.riccati import Blocks
from rangenav.sensors import NO_SAMPLE

VECTOR, MATRIX = (3,), (3, 3)
BLOCK_SIZES = (4, 3, 3, 3)
"""Of ξ, position, velocity and gravity."""
UNUSED = Schedule()
"""Numbers in the place of a schedule, which the kernel does not use without one."""
FINITE = "gyro, accel and range must be finite"
FAULTS = {
    GYRO_FAULT: FINITE,
    ACCEL_FAULT: FINITE,
    RANGE_FAULT: FINITE,
    MAG_FAULT: "mag must be finite, or NaN where there is none",
    RANGE_TIME_FAULT: "range_time must increase and lie after the last sample and not after this one",
}
"""The rule that a sample breaks, by the fault code that the kernel returns."""


def start(guess: Guess, *, state: Float[Array, "13"], rotation: Float[Array, "3 3"], world: World) -> Start:
    """The initial estimate that a guess describes. state: the true first state, body axes. rotation: the true R(0)."""
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
    """The configuration as the kernel's parameters. symmetric: whether ranges come at the IMU's rate; see `begin`."""
    instance("setting", setting, ObserverConfig, called="cascade.ObserverConfig")
    forms = get_args(model.ModelForm)
    require(setting.form in forms, f"setting.form must be {' or '.join(forms)}, got {described(setting.form)}")
    gains, sensors, world = setting.gains, setting.sensors, setting.world
    plan = gains.attitude.schedule or UNUSED
    matched = gains.mode == "noise-matched"
    return Parameters(
        gravity=_floats(world.gravity),
        magnetic=_floats(world.magnetic),
        b4=model.input_4(float(np.linalg.norm(world.gravity)), setting.form),
        variance=sensors.range_rate / gains.riccati.q,
        v=_of_blocks(gains.riccati.v),
        p0=_of_blocks(gains.riccati.p0),
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
    """The observer at its first IMU sample. A range stamped at that time is applied when the next sample comes.

    symmetric: whether every IMU sample has a range. Then half of each correction is applied before the estimate is read
    and half after it, which makes the estimate second order in the step.
    Raises ValueError for arrays of the wrong shape or type, stamps out of order, or numbers that are not finite.
    """
    instance("first", first, Sample, called="cascade.Sample")
    time, start, p = number("time", first.time), checked_start(start), parameters(setting, symmetric=symmetric)
    mag = array("mag", first.mag, VECTOR, none=NO_SAMPLE)
    require(not np.isinf(mag).any(), f"{FAULTS[MAG_FAULT]}, at time {time:g}")
    range_time = increasing_array("range_time", first.range_time, ("r",))
    distance = finite_array("range", first.range, range_time.shape)
    gyro, accel = finite_array("gyro", first.gyro, VECTOR), finite_array("accel", first.accel, VECTOR)
    return begun(Sample(time, gyro, accel, mag, range_time, distance), start, p)


def begun(first: Sample, start: Start, p: Parameters) -> State:
    """The same for arguments that were checked."""
    packed, packed_parameters = np.zeros(LENGTH), p.packed()
    arrays = views(packed)
    arrays.x[:], arrays.P[:: model.STATES + 1] = start.state, np.repeat(p.p0, BLOCK_SIZES)
    arrays.turned[:], arrays.rotation[:] = np.eye(3), start.rotation
    arrays.gyro[:], arrays.accel[:] = first.gyro, first.accel
    arrays.mag[:] = start.rotation.T @ np.asarray(p.magnetic) if np.isnan(first.mag).any() else first.mag
    arrays.gravity[:], arrays.misaligned[0], arrays.time[0] = start.state[model.GRAVITY], MISALIGNED, first.time
    arrays.acquisition[[PHASE, COLLECTS, SCALE]] = (MATCHED, 1.0, 1.0) if p.matched else (CONSTANT, 0.0, 1.0)
    at_start = first.range_time == first.time
    if np.any(at_start):
        kernel().begin(packed, float(np.asarray(first.range)[at_start][-1]), packed_parameters)
    return State(packed=packed, packed_parameters=packed_parameters)


def step(state: State, sample: Sample) -> State:
    """The observer at the next IMU sample.

    Raises ValueError for arrays of the wrong shape or type, stamps out of order, or numbers that are not finite.
    """
    if type(state) is not State:
        raise ValueError(f"state must be a cascade.State, got {described(state)}")
    if type(sample) is not Sample:
        raise ValueError(f"sample must be a cascade.Sample, got {described(sample)}")
    time, gyro, accel, mag, range_time, distance = sample
    packed, parameters = state.packed.copy(), state.packed_parameters
    try:
        fault = _step()(packed, time, gyro, accel, mag, range_time, distance, parameters)
    except (TypeError, ValueError):  # something is no array of float64 in C order
        fault = SHAPE_FAULT
    if fault != NO_FAULT:
        checked = checked_sample(sample)
        fault = _step()(packed, *checked, parameters)
        if fault != NO_FAULT:
            _refuse_sample(fault, state.time, checked[0])
    return State(packed=packed, packed_parameters=parameters)


@cache
def _step() -> Callable[..., int]:
    return sample_kernel().compiled_step()


def checked_sample(sample: Sample) -> tuple[float, Array, Array, Array, Array, Array]:
    """The fields of a sample as a float and as arrays of the shapes that the kernel reads.

    Raises ValueError for an array of the wrong shape or type. The kernel itself checks that the numbers are finite.
    """
    time, gyro, accel, mag, range_time, distance = sample
    gyro, accel = array("gyro", gyro, VECTOR), array("accel", accel, VECTOR)
    mag = array("mag", mag, VECTOR, none=NO_SAMPLE)
    range_time = array("range_time", range_time, ("r",))
    return number("time", time), gyro, accel, mag, range_time, array("range", distance, range_time.shape)


def checked_start(start: Start) -> Start:
    """The start as float64 arrays. Raises ValueError for a wrong shape or type, and for numbers that are not finite."""
    instance("start", start, Start, called="cascade.Start")
    state = finite_array("start.state", start.state, (model.STATES,))
    return Start(state=state, rotation=finite_array("start.rotation", start.rotation, MATRIX))


def _refuse_sample(fault: int, before: float, time: float) -> None:
    if fault == TIME_FAULT:
        raise ValueError(f"time must increase: {time:g} after {before:g}")
    raise ValueError(f"{FAULTS[fault]}, at time {time:g}")


def _floats(vector: Vec3) -> Vec3:
    """The vector with floats for whole numbers: the kernels then see one type only and compile once."""
    return float(vector[0]), float(vector[1]), float(vector[2])


def _of_blocks(v: Blocks) -> tuple[float, float, float, float]:
    return float(v.xi), float(v.position), float(v.velocity), float(v.gravity)
