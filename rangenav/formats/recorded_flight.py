"""A recorded flight in SI units, its part between two times, and synthetic ranges for it."""

from collections.abc import Mapping
from dataclasses import field, replace
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy import ndarray as Array

from rangenav.inputs import Vec3, require
from rangenav.results import result
from rangenav.sensors import Measurements

Frame = Literal["z-up", "z-down"]
SYNTHETIC_RATE = 50.0
"""Hz: the usual rate of a ranging radio."""


@result
class Flight:
    """A recorded flight in SI units; what the record does not have is None."""

    time: Float[Array, "n"]
    """s from the first sample, increasing."""
    gyro: Float[Array, "n 3"]
    """rad/s, body."""
    accel: Float[Array, "n 3"]
    """m/s², body: apparent acceleration."""
    mag: Float[Array, "n 3"] | None
    """Body; NaN between samples. Divided by its median length, whatever its unit was."""
    range_time: Float[Array, "m"]
    """s"""
    range: Float[Array, "m"]
    """m"""
    rotation: Float[Array, "n 3 3"] | None = None
    """Truth, body to inertial; NaN where unknown."""
    position: Float[Array, "n 3"] | None = None
    """Truth (m, inertial); NaN where unknown."""
    moving: Bool[Array, "n"] | None = None
    """Samples that the file marks as movement."""
    frame: Frame = "z-up"
    gravity: Vec3 | None = None
    """m/s², inertial, if the file says."""
    magnetic: Vec3 | None = None
    anchor: Vec3 | None = None
    unconfirmed: tuple[str, ...] = ()
    """Columns of `rotation` and `position` whose names do not say that they are the truth, before it is confirmed."""
    units: Mapping[str, str] = field(default_factory=dict)
    """The units of the file from which the quantities were converted; SI where there is none."""
    field_length: float = 1.0
    """The median length of the magnetometer's readings in the unit of the file, by which `mag` was divided."""
    lines: Int[Array, "n"] | None = None
    """The line of each sample in its file, from 1."""
    range_lines: Int[Array, "m"] | None = None
    """The line of each range in its file, from 1."""


def measurements(flight: Flight) -> Measurements:
    """The record in the form that the observers take; without a magnetometer, mag is NaN."""
    mag = np.full_like(flight.gyro, np.nan) if flight.mag is None else flight.mag
    return Measurements(
        time=flight.time,
        gyro=flight.gyro,
        accel=flight.accel,
        mag=mag,
        range_time=flight.range_time,
        range=flight.range,
    )


def with_ranges(flight: Flight, anchor: Vec3, *, sigma: float, seed: int, rate: float = SYNTHETIC_RATE) -> Flight:
    """The record with synthetic ranges to a point (m), on those stamps near `rate` (Hz) where the position is known."""
    require(flight.position is not None, "synthetic ranges need a true position in the file")
    assert flight.position is not None
    known = np.flatnonzero(np.isfinite(flight.position).all(axis=-1))
    require(len(known) > 1, "synthetic ranges need a true position in the file")
    stride = max(1, round(1 / (rate * float(np.median(np.diff(flight.time))))))
    k = known[known % stride == 0]
    noise = sigma * np.random.default_rng(seed).standard_normal(len(k))
    distance = np.linalg.norm(flight.position[k] - np.asarray(anchor), axis=-1)
    return replace(flight, range_time=flight.time[k], range=distance + noise, range_lines=None, anchor=anchor)


def between(flight: Flight, begin: float, end: float) -> Flight:
    """The part of a record from begin to end (s); its own stamps are kept. Raises ValueError for no part of it."""
    require(begin < end, f"the part must begin before it ends, got {begin:g} s to {end:g} s")
    inside = (flight.time >= begin) & (flight.time <= end)
    until = f"to {end:g} s" if np.isfinite(end) else "on"
    record = f"the record goes from {flight.time[0]:.4g} s to {flight.time[-1]:.4g} s"
    require(int(inside.sum()) >= 2, f"no two samples from {begin:g} s {until}: {record}")
    flight = with_some_ranges(flight, (flight.range_time >= begin) & (flight.range_time <= end))
    optional = {
        name: None if getattr(flight, name) is None else getattr(flight, name)[inside]
        for name in ("mag", "rotation", "position", "moving", "lines")
    }
    return replace(
        flight,
        time=flight.time[inside],
        gyro=flight.gyro[inside],
        accel=flight.accel[inside],
        **optional,
    )


def with_some_ranges(flight: Flight, kept: Bool[Array, "m"]) -> Flight:
    """The record with some of its ranges."""
    lines = None if flight.range_lines is None else flight.range_lines[kept]
    return replace(flight, range_time=flight.range_time[kept], range=flight.range[kept], range_lines=lines)
