"""The cascaded observer over a whole record, from one start or from many attitudes."""

import math
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model
from rangenav.arguments import array, finite_array
from rangenav.attitude import MISALIGNED
from rangenav.cascade.one_sample import MATRIX, begin, parameters
from rangenav.cascade.values import Estimate, ObserverConfig, Sample, Start, attitude_kernel, kernel
from rangenav.inputs import require
from rangenav.sensors import Measurements, Sensors, check


def observe(measurements: Measurements, start: Start, setting: ObserverConfig) -> Estimate:
    """Run both observers over a record.

    Raises ValueError for arrays of the wrong shape or type, stamps out of order, or numbers that are not finite; only
    mag may be NaN, where the magnetometer gave no sample.
    """
    z = check(measurements)
    count, ranges = len(z.time), len(z.range_time)
    state = begin(first_sample(z), start, setting, symmetric=ranges_at_imu_rate(z, setting.sensors))
    shapes = ((count, model.STATES), (count, 3, 3, 3), (count, 4), (count, 3, 3), (count,), (count, 3), (ranges, 2))
    states, covariances, xi_variances, rotations, k1, mag, innovation = together(shapes)
    phase = np.empty(count, dtype=np.int8)
    innovation[:] = np.nan
    estimate = Estimate(
        time=z.time,
        state=states,
        covariance=covariances,
        xi_variance=xi_variances,
        rotation=rotations,
        innovation=innovation,
        k1=k1,
        phase=phase,
        mag=mag,
    )
    kernel().run(
        state.packed, z.time, z.gyro, z.accel, z.mag, z.range_time, z.range, estimate.state, estimate.xi_variance,
        estimate.covariance, estimate.rotation, k1, phase, mag, estimate.innovation, skipped(z),
        state.packed_parameters,
    )  # fmt: skip
    return estimate


def together(shapes: Sequence[tuple[int, ...]]) -> list[Array]:
    """Arrays of these shapes in one block: of a long record it lies in large pages, and is ready much sooner."""
    ends = np.cumsum([0, *(math.prod(shape) for shape in shapes)]).tolist()
    block = np.empty(ends[-1])
    return [block[begin:end].reshape(shape) for begin, end, shape in zip(ends, ends[1:], shapes, strict=False)]


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


def ranges_at_imu_rate(measurements: Measurements, sensors: Sensors) -> bool:
    """Whether the symmetric scheme applies: every range on an IMU stamp, at the IMU's rate. Gaps do not matter."""
    if sensors.range_rate != sensors.imu_rate:
        return False
    time, stamps = measurements.time, measurements.range_time
    if len(time) == 0 or len(stamps) == 0:
        return len(stamps) == 0
    return bool(np.array_equal(time[np.minimum(np.searchsorted(time, stamps), len(time) - 1)], stamps))


def first_sample(z: Measurements) -> Sample:
    """The first IMU sample of a record, with a range stamped there."""
    due = z.range_time == z.time[0]
    return Sample(z.time[0], z.gyro[0], z.accel[0], z.mag[0], z.range_time[due], z.range[due])


def skipped(z: Measurements) -> int:
    """How many ranges are stamped at the first sample or before it."""
    return int(np.searchsorted(z.range_time, z.time[0], side="right"))
