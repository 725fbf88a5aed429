"""Many attitude filters on one record and one x̂: hundreds of R̂(0) cost little more than their filters.

x̂ does not depend on R̂, so it is computed once, and all filters share its ĝ. Each is, to the last bit, what `observe`
gives for its start. All functions raise ValueError as `observe` does, and if the first magnetometer sample is missing:
each start would then expect another vector there.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy import ndarray as Array

from rangenav import model
from rangenav.arguments import array, described, finite_array, number
from rangenav.attitude import MISALIGNED
from rangenav.cascade.one_sample import MATRIX, parameters
from rangenav.cascade.values import Estimate, ObserverConfig, Start, attitude_kernel
from rangenav.cascade.whole_record import observe
from rangenav.inputs import require, require_within
from rangenav.results import result
from rangenav.sensors import Measurements, check


@result
class AttitudeInputs:
    """What all filters share, checked once, in the kernel's terms."""

    time: Float[Array, "n"]
    """s"""
    gyro: Float[Array, "n 3"]
    """rad/s"""
    mag: Float[Array, "n 3"]
    """Of the estimate: turned by the gyro where the magnetometer gave no sample."""
    gravity: Float[Array, "n 3"]
    """m/s², ĝ of the estimate, body axes."""
    truth: Float[Array, "n 3 3"]
    """R, from body to inertial axes."""
    packed_parameters: Float[Array, "p"]


def attitudes(
    measurements: Measurements, start: Start, setting: ObserverConfig, *, rotations: Float[Array, "j 3 3"]
) -> Float[Array, "j n 3 3"]:
    """R̂ over a record from many R̂(0); `start` gives x̂(0) for all."""
    rotations, estimate = _starts(rotations), observe(measurements, start, setting)
    inputs = attitude_inputs(measurements, estimate, setting, truth=estimate.rotation)  # no error is asked for
    written = np.empty((len(rotations), len(inputs.time), *MATRIX))
    nothing = np.empty(0, dtype=bool), np.empty((0, 0)), 0.0, np.empty(0, dtype=np.int64)
    _follow(inputs, rotations, written, *nothing)
    return written


def attitude_errors(
    measurements: Measurements,
    estimate: Estimate,
    setting: ObserverConfig,
    *,
    rotations: Float[Array, "j 3 3"],
    truth: Float[Array, "n 3 3"],
) -> Float[Array, "j n"]:
    """The angle (rad) of R R̂ᵀ over a record from many R̂(0), from the estimate of `observe` with any R̂(0).

    To the last bit the angles of what `attitudes` gives, in a tenth of its memory.
    """
    inputs = attitude_inputs(measurements, estimate, setting, truth=truth)
    every = np.ones(len(inputs.time), dtype=bool)
    return attitude_settling(inputs, rotations=rotations, chosen=every, limit=np.pi)[0]


def attitude_inputs(
    measurements: Measurements, estimate: Estimate, setting: ObserverConfig, *, truth: Float[Array, "n 3 3"]
) -> AttitudeInputs:
    """What `attitude_settling` is given, from the estimate of `observe` with any R̂(0)."""
    z = check(measurements)
    state = array("estimate.state", estimate.state, (len(z.time), model.STATES))
    require(estimate.mag is not None, "the estimate must be that of cascade.observe")
    require(not np.isnan(z.mag[0]).any(), "many starts need a magnetometer sample at the first IMU sample")
    return AttitudeInputs(
        time=z.time,
        gyro=z.gyro,
        mag=array("estimate.mag", estimate.mag, z.gyro.shape),
        gravity=np.ascontiguousarray(state[:, model.GRAVITY]),
        truth=array("truth", truth, (len(z.time), *MATRIX)),
        packed_parameters=parameters(setting, symmetric=False).packed(),
    )


def attitude_settling(
    inputs: AttitudeInputs, *, rotations: Float[Array, "j 3 3"], chosen: Bool[Array, "n"], limit: float
) -> tuple[Float[Array, "j t"], Int[Array, "j"]]:
    """The same angles at the chosen samples, and how many samples there are up to the last one not below a limit (rad).

    At all other samples the angle is compared with the limit and not computed, which takes a third of the time.
    """
    rotations, count = _starts(rotations), len(inputs.time)
    fits = type(chosen) is Array and chosen.dtype == bool and chosen.shape == (count,)
    require(fits, f"chosen must hold a truth value for each of the {count} samples, got {described(chosen)}")
    require_within("limit", number("limit", limit), 0.0, np.pi, "rad")
    errors, above = np.empty((len(rotations), np.count_nonzero(chosen))), np.empty(len(rotations), dtype=np.int64)
    estimates = np.empty((0, count, *MATRIX))
    _follow(inputs, rotations, estimates, np.ascontiguousarray(chosen), errors, float(limit), above)
    return errors, above


def _starts(rotations: Float[Array, "j 3 3"]) -> Array:
    return finite_array("rotations", rotations, ("j", *MATRIX))


def _follow(
    inputs: AttitudeInputs, rotations: Array, estimates: Array, chosen: Array, errors: Array, limit: float, above: Array
) -> None:
    """Attitude filters on the ĝ of an estimate; what has rows is written."""
    i = inputs
    attitude_kernel().run(
        i.time, i.gyro, i.mag, i.gravity, i.truth, rotations, estimates, chosen, errors, limit, above, MISALIGNED,
        i.packed_parameters,
    )  # fmt: skip
