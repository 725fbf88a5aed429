"""Recorded flights in MATLAB .mat files (v5): arrays of n×3 under names such as gyro, accel, mag, and BROAD's own.

BROAD (Laidig et al.) has imu_gyr (rad/s), imu_acc (m/s²), imu_mag (µT), opt_quat (wxyz, sensor to ENU), opt_pos (m),
with NaN where the cameras lost sight, movement flags and one sampling_rate instead of stamps; its units and frame
are those of its documentation. They count as stated, and are checked against the numbers like any other.
"""

from collections.abc import Mapping

import numpy as np
from numpy import ndarray as Array

from rangenav.formats import entries, flight_columns, log, mat5
from rangenav.formats.import_result import ImportResult
from rangenav.formats.raw_flight import FlightColumns
from rangenav.formats.text import Table
from rangenav.inputs import require

NAMES = {
    "gyro": ("gyro", "gyr", "imu_gyr", "gyroscope", "angular_velocity"),
    "accel": ("accel", "acc", "imu_acc", "accelerometer"),
    "mag": ("mag", "imu_mag", "magnetometer"),
    "position": ("position", "pos", "opt_pos"),
    "quaternion": ("quaternion_wxyz", "quaternion", "quat", "opt_quat"),
    "time": ("time", "t"),
    "range": ("range",),
    "range_time": ("range_time",),
    "rate": ("sampling_rate", "fs"),
    "moving": ("movement", "moving"),
}
BROAD = {"imu_gyr", "imu_acc", "imu_mag", "opt_quat", "opt_pos", "sampling_rate"}
BROAD_UNITS = {"gyro": "rad/s", "accel": "m/s2", "mag": "uT", "time": "s"}
LEAST_RATE, MOST_RATE = 1.0, 1e5


def parse(data: bytes, *, source: str, confirm: Mapping[str, str]) -> ImportResult:
    """The flight of a file, or its questions. Raises ValueError saying what is missing or does not fit."""
    variables = mat5.arrays(data, source=source)
    parts = {kind: _named(variables, kind, source) for kind in NAMES}
    for kind, values in parts.items():
        bounded = values is None or _largest(values) <= entries.LARGEST
        require(bounded, f"{source}: {kind} must be finite and not exceed {entries.LARGEST:g}")
    gyro, accel = _wide(parts["gyro"], 3, "gyro", source), _wide(parts["accel"], 3, "accel", source)
    names = ", ".join(sorted(variables)[:12]) or "none"
    if gyro is None or accel is None:
        raise ValueError(f"{source}: no arrays for gyro and accel; its numeric variables are {names}")
    count = len(gyro)
    require(0 < count <= entries.MAX_ROWS, f"{source}: {count} rows, of 1 to {entries.MAX_ROWS} that are read")
    vectors = {
        kind: _wide(parts[kind], width, kind, source)
        for kind, width in (("mag", 3), ("position", 3), ("quaternion", 4))
    }
    for kind, values in {"accel": accel, **vectors}.items():
        require(values is None or len(values) == count, f"{source}: {kind} must have the {count} rows of gyro")
    quaternion, moving = vectors["quaternion"], parts["moving"]
    broad = set(variables) >= BROAD
    time = _time(parts, count, source)
    return flight_columns.flight(
        FlightColumns(
            table=_table(source, time),
            format="mat",
            time=time,
            gyro=gyro,
            accel=accel,
            mag=vectors["mag"],
            ranges=_ranges(parts, source),
            rotation=None if quaternion is None else log.attitude(quaternion, source),
            position=vectors["position"],
            moving=None if moving is None or moving.size != count else moving.ravel() != 0,
            stated=BROAD_UNITS if broad else {"time": "s"} if parts["rate"] is not None else {},
            frame="z-up" if broad else None,
            findings=(_lost(vectors["position"], quaternion),) if broad else (),
        ),
        confirm,
    )


def _largest(values: Array) -> float:
    """The largest size of a number; NaN is a missing number and has none."""
    ends = (np.fmax.reduce(values, axis=None, initial=0.0), np.fmin.reduce(values, axis=None, initial=0.0))
    return float(max(ends[0], -ends[1]))


def _named(variables: dict[str, Array], kind: str, source: str) -> Array | None:
    names = [name for name in NAMES[kind] if name in variables]
    require(len(names) <= 1, f"{source}: {' and '.join(names)} could both be the {kind}")
    return variables[names[0]] if names else None


def _wide(values: Array | None, width: int, kind: str, source: str) -> Array | None:
    if values is None:
        return None
    right = values.ndim == 2 and values.shape[1] == width
    require(right, f"{source}: {kind} must have {width} columns, got shape {values.shape}")
    return np.ascontiguousarray(values)


def _time(parts: dict[str, Array | None], count: int, source: str) -> Array:
    time, rate = parts["time"], parts["rate"]
    if time is not None:
        require(time.size == count, f"{source}: time must have {count} entries, got {time.size}")
        return time.ravel()
    require(rate is not None and rate.size == 1, f"{source}: neither time nor one sampling_rate")
    assert rate is not None
    value = float(rate.ravel()[0])
    require(LEAST_RATE <= value <= MOST_RATE, f"{source}: sampling_rate must lie between 1 and 1e5 Hz, got {value:g}")
    return np.arange(count) / value


def _ranges(parts: dict[str, Array | None], source: str) -> tuple[Array, Array] | None:
    if parts["range"] is None:
        return None
    stamps, distance = parts["range_time"], parts["range"].ravel()
    require(stamps is not None, f"{source}: range needs range_time beside it")
    assert stamps is not None
    stamps = stamps.ravel()
    fits = len(stamps) == len(distance) and bool(np.isfinite(stamps).all() and np.isfinite(distance).all())
    require(fits, f"{source}: range and range_time must be finite and equally many")
    require(bool(np.all(np.diff(stamps) > 0)), f"{source}: range_time must increase")
    return stamps, distance


def _table(source: str, time: Array) -> Table:
    """A table in which each sample counts as a line, for messages."""
    rows = np.arange(1, len(time) + 1)
    return Table(source=source, names=("time",), comments=(), values=time[:, None], lines=rows)


def _lost(position: Array | None, quaternion: Array | None) -> str:
    lost = [int(np.isnan(values).any(axis=-1).sum()) for values in (position, quaternion) if values is not None]
    return f"BROAD: sensor to ENU; the cameras lost {' positions and '.join(map(str, lost))} attitudes"
