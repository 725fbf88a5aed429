"""The options of `rangenav log` that answer what a file leaves open, and what its sensors contradict.

Each field is the flag of a question: of the reader of the file, or of a row of `record_checks.CHECKS`.
"""

import dataclasses
from dataclasses import dataclass
from typing import Annotated, Literal

import tyro

from rangenav.formats import log_columns
from rangenav.inputs import Vec3, require

Axes = Annotated[str | None, tyro.conf.arg(metavar="AXES")]
Vector = Annotated[Vec3 | None, tyro.conf.arg(metavar="X Y Z")]
KEYS = {f"{kind}_unit": kind for kind in ("time", "gyro", "accel", "mag", "range")}
"""The keys of questions that are not the names of their flags."""


@dataclass(frozen=True, kw_only=True)
class Answers:
    """Answers to the questions about a file."""

    time_unit: Literal["s", "ms", "us", "ns"] | None = None
    """Confirms the unit of the stamps."""
    gyro_unit: Literal["rad/s", "deg/s"] | None = None
    """Confirms the unit of the gyro."""
    accel_unit: Literal["m/s2", "g", "mg"] | None = None
    """Confirms the unit of the accelerometer."""
    mag_unit: Literal["1", "T", "mT", "uT", "nT", "G"] | None = None
    """Confirms the unit of the magnetometer."""
    range_unit: Literal["m", "cm", "mm"] | None = None
    """Confirms the unit of the ranges."""
    frame: Literal["z-up", "z-down"] | None = None
    """Confirms which way z of the inertial frame points."""
    lines: Literal["drop"] | None = None
    """Drop lines with missing numbers or repeated stamps."""
    stamps: Literal["unwrap"] | None = None
    """Let the stamps go on where the clock began again."""
    columns: Annotated[tuple[str, ...], tyro.conf.arg(metavar="QUANTITY=NAME")] = ()
    """Chooses columns where several would do: accel=linear_acceleration."""
    truth: Literal["yes", "no"] | None = None
    """Whether poses whose names do not say so are the truth."""
    gaps: Literal["longest", "bridge"] | None = None
    """Use the longest part without a gap of the IMU, or the record with its gaps."""
    attitude: Literal["inverse", "xyzw", "wxyz", "ignore", "keep"] | None = None
    """Take the inverse of the file's attitude, its quaternion in another order, no attitude, or it as it is."""
    poses: Literal["drop", "keep"] | None = None
    """Whether positions of 0 0 0 far from their neighbours are used."""
    body_axes: Axes = None
    """Axes of all sensors, as +x-y-z: the body's x, y and z in the sensors' axes."""
    gyro_axes: Axes = None
    """Axes of the gyro, likewise."""
    accel_axes: Axes = None
    """Axes of the accelerometer, likewise."""
    mag_axes: Axes = None
    """Axes of the magnetometer, likewise."""
    accel_scale: float | None = None
    """Factor of the accelerometer; 1 takes it as it is."""
    gyro_offset: Vector = None
    """Constant that is subtracted from the gyro (rad/s); 0 0 0 takes it as it is."""
    accel_offset: Vector = None
    """Constant that is subtracted from the accelerometer (m/s²), likewise."""
    mag_offset: Vector = None
    """Constant that is subtracted from the magnetometer, in its own unit; 0 0 0 takes it as it is."""
    range_values: Literal["drop", "keep"] | None = None
    """Whether ranges that are no distances (zeros, sentinels) are used."""
    range_outliers: Literal["drop", "keep"] | None = None
    """Whether single ranges that are far off are used."""
    held_ranges: Literal["once", "each"] | None = None
    """How often a range counts that stands on several rows."""
    range_delay: float | None = None
    """By how many seconds the stamps of the ranges are late; 0 takes them as they are."""
    range_offset: float | None = None
    """Constant that is subtracted from the ranges (m); 0 takes them as they are."""

    def confirm(self) -> dict[str, str]:
        """The answers that were given, by the keys of their questions."""
        given = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        columns = _chosen_columns(given.pop("columns"))
        named = {KEYS.get(name, name.replace("_", "-")): value for name, value in given.items() if value is not None}
        return {key: _text(value) for key, value in named.items()} | columns


def _text(value: str | float | tuple[float, ...]) -> str:
    values = value if isinstance(value, tuple) else (value,)
    return " ".join(one if isinstance(one, str) else f"{one:.10g}" for one in values)


def _chosen_columns(columns: tuple[str, ...]) -> dict[str, str]:
    """Answers to the questions which columns hold a quantity, from `accel=linear_acceleration`."""
    for chosen in columns:
        kind, sign, _ = chosen.partition("=")
        known = ", ".join(log_columns.NAMES)
        require(bool(sign) and kind in log_columns.NAMES, f"--columns must be QUANTITY=NAME of {known}, got {chosen!r}")
    return {log_columns.columns_key(chosen.partition("=")[0]): chosen for chosen in columns}
