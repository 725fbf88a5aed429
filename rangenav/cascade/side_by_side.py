"""Many runs of the cascaded observer at once, several side by side: seeds of one flight, or gains on one record."""

from collections.abc import Sequence

import numpy as np
from numpy import ndarray as Array

from rangenav import model
from rangenav.arguments import instance
from rangenav.cascade.one_sample import begun, checked_start, parameters
from rangenav.cascade.values import Estimate, ObserverConfig, Start, State, lanes_kernel
from rangenav.cascade.whole_record import first_sample, observe, ranges_at_imu_rate, skipped, together
from rangenav.inputs import require
from rangenav.kernels.layout import ACQUISITION_AT, CONSTANT
from rangenav.sensors import Measurements, check

LEAST = 3
"""From so many runs on this is faster than one after the other: a vector takes the same time however few runs fill
it."""
LINE = 64
"""Bytes of a line of the cache; vectors that begin with one are read at once."""
Run = tuple[Measurements, Start, ObserverConfig]


def observe_each(
    measurements: Sequence[Measurements], starts: Sequence[Start], settings: Sequence[ObserverConfig]
) -> list[Estimate]:
    """What `observe` gives for each record, start and configuration, to the last bit, in a fraction of the time.

    The time is shorter for constant gains on records with the same stamps: other runs are made one after the other.
    Raises ValueError as `observe` does, and unless there are as many of each.
    """
    same = len(measurements) == len(starts) == len(settings)
    require(
        same, f"each run needs a record, a start and a setting, got {len(measurements)}, {len(starts)}, {len(settings)}"
    )
    for setting in settings:
        instance("setting", setting, ObserverConfig, called="cascade.ObserverConfig")
    records = {id(z): check(z) for z in measurements}
    runs = [(records[id(z)], start, setting) for z, start, setting in zip(measurements, starts, settings, strict=True)]
    estimates: list[Estimate] = []
    lanes = lanes_kernel().LANES
    for first in range(0, len(runs), lanes):
        some = runs[first : first + lanes]
        alike = len(some) >= LEAST and _alike(some)
        estimates += _side_by_side(some) if alike else [observe(*run) for run in some]
    return estimates


def _alike(runs: list[Run]) -> bool:
    """Whether the runs share their stamps, what decides which formulas are computed, and gains that are constant."""
    (first, _, setting), decided = runs[0], _decided(runs[0][2])
    lost = np.isnan(first.mag[:, 0])
    return setting.gains.mode == "constant" and all(
        _decided(config) == decided
        and np.array_equal(z.time, first.time)
        and np.array_equal(z.range_time, first.range_time)
        and np.array_equal(np.isnan(z.mag[:, 0]), lost)
        for z, _, config in runs[1:]
    )


def _decided(setting: ObserverConfig) -> tuple[object, ...]:
    gains, sensors = setting.gains, setting.sensors
    return gains.mode, gains.attitude.schedule is None, sensors.range_rate == sensors.imu_rate


def _side_by_side(runs: list[Run]) -> list[Estimate]:
    z, _, setting = runs[0]
    symmetric, count, ranges, n = ranges_at_imu_rate(z, setting.sensors), len(z.time), len(z.range_time), len(runs)
    states = [
        begun(first_sample(z), checked_start(start), parameters(config, symmetric=symmetric))
        for z, start, config in runs
    ]
    each = ((count, model.STATES), (count, 4), (count, 3, 3, 3), (count, 3, 3), (count,), (count, 3), (ranges, 2))
    written = together([(n, *shape) for shape in each])
    written[-1][:] = np.nan
    imu = _innermost([(z.gyro, z.accel, z.mag) for z, _, _ in runs])
    distance = _innermost([(z.range[:, None],) for z, _, _ in runs])
    lanes_kernel().run(_packed(states), z.time, imu, z.range_time, distance, *written, skipped(z))
    phase = np.full(count, CONSTANT, dtype=np.int8)
    return [
        Estimate(
            time=one.time,
            state=x,
            covariance=covariance,
            xi_variance=xi_variance,
            rotation=rotation,
            innovation=innovation,
            k1=k1,
            phase=phase.copy(),
            mag=mag,
        )
        for (one, _, _), x, xi_variance, covariance, rotation, k1, mag, innovation in zip(runs, *written, strict=True)
    ]


def _innermost(parts: list[tuple[Array, ...]]) -> Array:
    """Tables of each run, one flat table with each number beside those of the others; the last run fills the lanes."""
    kernel, place = lanes_kernel(), 0
    rows, width = len(parts[0][0]), sum(table.shape[1] for table in parts[0])
    filled = aligned(rows * width * kernel.LANES)
    table = filled.reshape(rows, width, kernel.LANES)
    filling = [parts[-1]] * (kernel.LANES - len(parts))
    for runs in zip(*parts, *filling, strict=True):
        kernel.lay(table, place, tuple(np.ascontiguousarray(one) for one in runs))
        place += runs[0].shape[1]
    return filled


def aligned(count: int) -> Array:
    """So many numbers, the first of them at the beginning of a line of the cache."""
    block = np.empty(count + LINE // 8)
    first = -block.ctypes.data % LINE // 8
    return block[first : first + count]


def _packed(states: list[State]) -> Array:
    """The first states, the parameters and the work space of the kernel."""
    begun = _innermost([(one.packed[None, :ACQUISITION_AT], one.packed_parameters[None]) for one in states])
    w = aligned(lanes_kernel().LENGTH * lanes_kernel().LANES)
    w[:] = 0.0
    w[: len(begun)] = begun
    return w
