"""The cascaded observer over a whole record, from one start or from many attitudes."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model
from rangenav.arguments import finite_array
from rangenav.cascade.one_sample import MATRIX, begin
from rangenav.cascade.values import Estimate, ObserverConfig, Sample, Start, kernel
from rangenav.inputs import require
from rangenav.sensors import Measurements, Sensors, check


def observe(measurements: Measurements, start: Start, setting: ObserverConfig) -> Estimate:
    """Run both observers over a record.

    Raises ValueError for arrays of the wrong shape or type, stamps out of order, or numbers that are not finite; only
    mag may be NaN, where the magnetometer gave no sample.
    """
    z = check(measurements)
    count, ranges = len(z.time), len(z.range_time)
    state = begin(_first_sample(z), start, setting, symmetric=ranges_at_imu_rate(z, setting.sensors))
    k1, phase = np.empty(count), np.empty(count, dtype=np.int8)
    estimate = Estimate(
        time=z.time,
        state=np.empty((count, model.STATES)),
        covariance=np.empty((count, 3, 3, 3)),
        xi_variance=np.empty((count, 4)),
        rotation=np.empty((count, 3, 3)),
        innovation=np.full((ranges, 2), np.nan),
        k1=k1,
        phase=phase,
    )
    kernel().run(
        state.packed, z.time, z.gyro, z.accel, z.mag, z.range_time, z.range, estimate.state, estimate.xi_variance,
        estimate.covariance, estimate.rotation, k1, phase, estimate.innovation, _skipped(z),
        state.packed_parameters,
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
    kernel().run_attitudes(
        state.packed, z.time, z.gyro, z.accel, z.mag, z.range_time, z.range, estimates, np.empty((len(z.range), 2)),
        _skipped(z), state.packed_parameters,
    )  # fmt: skip
    return estimates


def ranges_at_imu_rate(measurements: Measurements, sensors: Sensors) -> bool:
    """Whether the symmetric scheme applies: every range on an IMU stamp, at the IMU's rate. Gaps do not matter."""
    if sensors.range_rate != sensors.imu_rate:
        return False
    time, stamps = measurements.time, measurements.range_time
    if len(time) == 0 or len(stamps) == 0:
        return len(stamps) == 0
    return bool(np.array_equal(time[np.minimum(np.searchsorted(time, stamps), len(time) - 1)], stamps))


def _first_sample(z: Measurements) -> Sample:
    due = z.range_time == z.time[0]
    return Sample(z.time[0], z.gyro[0], z.accel[0], z.mag[0], z.range_time[due], z.range[due])


def _skipped(z: Measurements) -> int:
    """How many ranges are stamped at the first sample or before it."""
    return int(np.searchsorted(z.range_time, z.time[0], side="right"))
