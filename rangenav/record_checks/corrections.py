"""What an answer changes in a record: units, axes, scale, offset, clock, and values that are not used."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rangenav.formats.recorded_flight import Flight, with_some_ranges
from rangenav.inputs import Vec3, require
from rangenav.record_checks import axes, clock, order, outliers, poses, ranges
from rangenav.record_checks.check import unit_factor

Correction = Callable[[Flight, str], Flight]
LARGEST_DELAY = 100.0
"""s"""
LARGEST = 1e9


def unit(kind: str) -> Correction:
    """The record with one quantity in another unit of the file."""

    def corrected(flight: Flight, answer: str) -> Flight:
        factor = unit_factor(flight, kind, answer)
        flight = replace(flight, units={**flight.units, kind: answer})
        if kind == "time":
            return replace(flight, time=flight.time * factor, range_time=flight.range_time * factor)
        return replace(flight, **{kind: getattr(flight, kind) * factor})

    return corrected


def sensor_axes(*sensors: str) -> Correction:
    """The record with the axes of one or more sensors as in `+y+x-z`."""

    def corrected(flight: Flight, answer: str) -> Flight:
        matrix = axes.matrix(answer)
        there = {name: getattr(flight, name) for name in sensors}
        return replace(flight, **{name: v if v is None else v @ matrix.T for name, v in there.items()})

    return corrected


def accel_scale(flight: Flight, answer: str) -> Flight:
    """The record with the accelerometer times a factor."""
    (factor,) = numbers(answer, 1, "the scale of the accelerometer")
    require(factor > 0, f"the scale of the accelerometer must be positive, got {factor:g}")
    return replace(flight, accel=factor * flight.accel)


def gaps(flight: Flight, answer: str) -> Flight:
    """The longest part of the record without a gap, or the record with its gaps."""
    return clock.without_gaps(flight) if answer == "longest" else flight


def gyro_offset(flight: Flight, answer: str) -> Flight:
    """The record without a constant (rad/s) of the gyro."""
    return replace(flight, gyro=flight.gyro - np.array(numbers(answer, 3, "the offset of the gyro")))


def accel_offset(flight: Flight, answer: str) -> Flight:
    """The record without a constant (m/s²) of the accelerometer."""
    return replace(flight, accel=flight.accel - np.array(numbers(answer, 3, "the offset of the accelerometer")))


def mag_offset(flight: Flight, answer: str) -> Flight:
    """The record without a constant (in the unit of the file) of the magnetometer."""
    offset = np.array(numbers(answer, 3, "the offset of the magnetometer"))
    if flight.mag is None or not offset.any():
        return flight
    mag = flight.mag - offset / flight.field_length
    length = float(np.nanmedian(np.linalg.norm(mag, axis=-1)))
    require(length > 0, "the magnetometer reads nothing but this offset")
    return replace(flight, mag=mag / length, field_length=flight.field_length * length)


def attitude(flight: Flight, answer: str) -> Flight:
    """The record with the inverse attitude of the file, with its quaternion in another order, or without any."""
    if flight.rotation is None or answer == "keep":
        return flight
    if answer in order.ORDERS:
        return replace(flight, rotation=order.reordered(flight.rotation, answer))
    return replace(flight, rotation=np.swapaxes(flight.rotation, -1, -2) if answer == "inverse" else None)


def frame(flight: Flight, answer: str) -> Flight:
    """The record in a frame whose z points the other way."""
    return replace(flight, frame="z-down" if answer == "z-down" else "z-up")


def truth(flight: Flight, answer: str) -> Flight:
    """The record with its poses as the truth, or without them."""
    flight = replace(flight, unconfirmed=())
    return replace(flight, rotation=None, position=None) if answer == "no" else flight


def lost_poses(flight: Flight, answer: str) -> Flight:
    """The record without the poses that a tracker has lost."""
    rows = poses.lost(flight)
    if answer != "drop" or flight.position is None or not rows.any():
        return flight
    position = np.where(rows[:, None], np.nan, flight.position)
    rotation = None if flight.rotation is None else np.where(rows[:, None, None], np.nan, flight.rotation)
    return replace(flight, position=position, rotation=rotation)


def range_values(flight: Flight, answer: str) -> Flight:
    """The record without ranges that are no distances."""
    return with_some_ranges(flight, ~ranges.no_distances(flight)) if answer == "drop" else flight


def range_outliers(flight: Flight, answer: str) -> Flight:
    """The record without single ranges that are far off."""
    return with_some_ranges(flight, ~outliers.is_outlier(flight)) if answer == "drop" else flight


def range_offset(flight: Flight, answer: str) -> Flight:
    """The record without a constant (m) of its ranges."""
    (constant,) = numbers(answer, 1, "the offset of the ranges")
    return replace(flight, range=flight.range - constant)


def held_ranges(flight: Flight, answer: str) -> Flight:
    """The record with the first of each range that is held."""
    held = answer == "once" and ranges.held(flight) is not None
    return with_some_ranges(flight, ranges.first_of_each(flight)) if held else flight


def range_delay(flight: Flight, answer: str) -> Flight:
    """The record with the stamps of its ranges earlier by a delay (s)."""
    (delay,) = numbers(answer, 1, "the delay of the ranges")
    require(abs(delay) <= LARGEST_DELAY, f"the delay of the ranges must not exceed {LARGEST_DELAY:g} s, got {delay:g}")
    moved = replace(flight, range_time=flight.range_time - delay)
    return with_some_ranges(moved, (moved.range_time >= flight.time[0]) & (moved.range_time <= flight.time[-1]))


def anchor(flight: Flight, answer: str) -> Flight:
    """The record with its anchor elsewhere."""
    x, y, z = numbers(answer, 3, "the anchor")
    place: Vec3 = (x, y, z)
    return replace(flight, anchor=place)


def numbers(text: str, count: int, what: str) -> list[float]:
    """So many finite numbers with blanks between. Raises ValueError otherwise."""
    rule = f"{what} must be {'one number' if count == 1 else f'{count} numbers'}, got {text[:40]!r}"
    try:
        numbers = [float(part) for part in text.split()]
    except ValueError:
        raise ValueError(rule) from None
    require(len(numbers) == count and all(math.isfinite(v) and abs(v) <= LARGEST for v in numbers), rule)
    return numbers
