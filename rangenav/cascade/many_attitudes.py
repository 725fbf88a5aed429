"""Many attitude filters on one record and one x̂: hundreds of R̂(0) cost little more than their filters.

x̂ does not depend on R̂, so it is computed once, and all filters share its ĝ. Each is, to the last bit, what `observe`
gives for its start.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model
from rangenav.arguments import array, finite_array
from rangenav.attitude import MISALIGNED
from rangenav.cascade.one_sample import MATRIX, parameters
from rangenav.cascade.values import Estimate, ObserverConfig, Start, attitude_kernel
from rangenav.cascade.whole_record import observe
from rangenav.inputs import require
from rangenav.sensors import Measurements, check


def attitudes(
    measurements: Measurements, start: Start, setting: ObserverConfig, *, rotations: Float[Array, "j 3 3"]
) -> Float[Array, "j n 3 3"]:
    """R̂ over a record from many R̂(0), to the last bit what `observe` gives for each; `start` gives x̂(0) for all.

    x̂ does not depend on R̂, so it is computed once: hundreds of starts cost little more than their attitude filters.
    Raises ValueError as `observe` does, and if the first magnetometer sample is missing: each start would then expect
    another vector there.
    """
    z, rotations = check(measurements), finite_array("rotations", rotations, ("j", *MATRIX))
    _refuse_unknown_mag(z)
    estimates, count = np.empty((len(rotations), len(z.time), 3, 3)), len(z.time)
    _follow(observe(z, start, setting), z, setting, rotations, np.empty((count, 3, 3)), estimates, np.empty((0, count)))
    return estimates


def attitude_errors(
    measurements: Measurements,
    estimate: Estimate,
    setting: ObserverConfig,
    *,
    rotations: Float[Array, "j 3 3"],
    truth: Float[Array, "n 3 3"],
) -> Float[Array, "j n"]:
    """The angle (rad) of R R̂ᵀ over a record from many R̂(0), from the estimate of `observe` with any R̂(0).

    To the last bit the angles of what `attitudes` gives, in a tenth of its memory. Raises as `attitudes` does.
    """
    z, rotations = check(measurements), finite_array("rotations", rotations, ("j", *MATRIX))
    truth = array("truth", truth, (len(z.time), *MATRIX))
    array("estimate.state", estimate.state, (len(z.time), model.STATES))
    _refuse_unknown_mag(z)
    errors = np.empty((len(rotations), len(z.time)))
    _follow(estimate, z, setting, rotations, truth, np.empty((0, len(z.time), 3, 3)), errors)
    return errors


def _follow(
    estimate: Estimate,
    z: Measurements,
    setting: ObserverConfig,
    rotations: Array,
    truth: Array,
    estimates: Array,
    errors: Array,
) -> None:
    """Attitude filters on the ĝ of an estimate; estimates and errors are written where they have rows."""
    require(estimate.mag is not None, "the estimate must be that of cascade.observe")
    gravity = np.ascontiguousarray(estimate.state[:, model.GRAVITY])
    packed = parameters(setting, symmetric=False).packed()
    attitude_kernel().run(
        z.time, z.gyro, estimate.mag, gravity, truth, rotations, estimates, errors, MISALIGNED, packed
    )


def _refuse_unknown_mag(z: Measurements) -> None:
    require(not np.isnan(z.mag[0]).any(), "many starts need a magnetometer sample at the first IMU sample")
