"""One sample from Python: what may be wrong with it, then `cascade.advance`. A sample with a fault changes nothing.

The checks are compiled with the step, because a call of a kernel takes longer than all of them together.
"""

import threading

import numpy as np

from rangenav.kernels import attitude, cascade
from rangenav.kernels.jit import kernel
from rangenav.kernels.layout import (
    ACCEL_FAULT,
    GYRO_FAULT,
    MAG_FAULT,
    NO_FAULT,
    RANGE_FAULT,
    RANGE_TIME_FAULT,
    SHAPE_FAULT,
    TIME_AT,
    TIME_FAULT,
)

STEP = f"int64(float64[::1], float64{6 * ', float64[::1]'})"
"""The types of `step`."""
ONE_AT_A_TIME = threading.Lock()
"""Held while `step` is compiled."""


@kernel
def fault(t0, t1, gyro, accel, mag, range_time, distance):
    """The first thing that is wrong with a sample: a shape, stamps out of order, or a number that is not finite."""
    if not (len(gyro) == 3 and len(accel) == 3 and len(mag) == 3 and len(distance) == len(range_time)):
        return SHAPE_FAULT
    if not t1 > t0 or np.isinf(t1):
        return TIME_FAULT
    for i in range(3):
        if not np.isfinite(gyro[i]):
            return GYRO_FAULT
        if not np.isfinite(accel[i]):
            return ACCEL_FAULT
        if np.isinf(mag[i]):
            return MAG_FAULT
    last = t0
    for j in range(len(distance)):
        if not np.isfinite(distance[j]):
            return RANGE_FAULT
        if not last < range_time[j] <= t1:
            return RANGE_TIME_FAULT
        last = range_time[j]
    return NO_FAULT


@kernel
def step(s, t1, gyro, accel, mag, range_time, distance, packed):
    """`advance` with all the ranges of a sample, unless the sample has a fault; returns the fault."""
    found = fault(s[TIME_AT], t1, gyro, accel, mag, range_time, distance)
    if found == NO_FAULT:
        count = len(distance)
        cascade.advance(
            s, t1, cascade.three(gyro, 0), cascade.three(accel, 0), cascade.three(mag, 0), range_time, distance, 0,
            count, np.empty((count, 2)), attitude.unpacked(packed),
        )  # fmt: skip
    return found


def compiled_step():
    """`step` for arrays of float64 in C order alone: a call with others raises TypeError and compiles nothing."""
    with ONE_AT_A_TIME:
        if not step.signatures:
            step.compile(STEP)
            step.disable_compile()
    return step
