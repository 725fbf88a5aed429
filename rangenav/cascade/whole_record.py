"""The cascaded observer over a whole record, from one start."""

import math
from collections.abc import Sequence

import numpy as np
from numpy import ndarray as Array

from rangenav import model
from rangenav.cascade.one_sample import begin
from rangenav.cascade.values import Estimate, ObserverConfig, Sample, Start, kernel
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
