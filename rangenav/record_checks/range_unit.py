"""The unit of the ranges: against true positions, or against what the IMU can reach.

|d(s) − d(t)| ≤ |p(s) − p(t)|       whatever the anchor
"""

import math

import numpy as np
from numpy import ndarray as Array

from rangenav.formats.recorded_flight import Flight
from rangenav.imu_motion import twice_integrated
from rangenav.number_format import significant
from rangenav.record_checks.check import Evidence, unit_factor, unit_for
from rangenav.record_checks.distances import LEAST, delay_by_imu, known_positions
from rangenav.record_checks.force import GRAVITY

FAST, FASTER = 100.0, 20.0
"""m/s of change of a range over half a second, and times the change of velocity by the IMU, that nothing reaches."""
SCATTER, CLOSE = 10.0, 0.5
"""m rms about every motion that the IMU allows, of ranges in a finer unit; and m rms in their own."""
NEAREST, FARTHEST, USUAL = 0.3, 100.0, 20.0
"""m, between which the median of ranges lies in their own unit, and m/s that they change by at most."""
WIDER, MARGIN = 5.0, 5.0
"""Times the extent of the true positions, and m, that the ranges' extent exceeds if their unit is finer."""
BENT, FEWEST, SURE = 2.0, 8, 5.0
"""s over which the second derivative of ranges is taken, the fewest ranges for it, and its standard deviations."""
BENDS = 1.2
"""Times the largest acceleration of the body: beyond it no distance is bent towards the anchor."""
TWICE = 2.0
"""Factor between ranges and true distances that no bias explains."""


def unit(flight: Flight) -> Evidence | None:
    """Ranges in another unit: against true positions, or against what the IMU can reach."""
    if len(flight.range) < LEAST:
        return None
    known = known_positions(flight)
    if known is not None:
        return _unit_by_truth(flight, *known)
    return _unit_by_speed(flight) or _unit_by_bend(flight) or _unit_by_scatter(flight)


def _unit_by_truth(flight: Flight, time: Array, position: Array) -> Evidence | None:
    if flight.anchor is not None:
        there = np.stack([np.interp(flight.range_time, time, axis) for axis in position.T], axis=-1)
        far = float(np.median(np.linalg.norm(there - np.asarray(flight.anchor), axis=-1)))
        ratio = float(np.median(flight.range)) / far if far > 0 else 1.0
        chosen = unit_for(flight, "range", 1 / ratio) if ratio > 0 and not 1 / TWICE < ratio < TWICE else None
        if chosen is not None:
            text = f"the ranges are {significant(ratio)} times the distance from the true positions to the anchor"
            return Evidence(text=text, suggestion=chosen)
    low, high = np.quantile(flight.range, [0.05, 0.95])
    extent = float(np.linalg.norm(np.ptp(position, axis=0)))
    if high - low <= WIDER * extent + MARGIN:
        return None
    text = f"the ranges change by {significant(high - low)} m, and the true positions by {significant(extent)} m"
    fits = [u for u in ("cm", "mm") if (high - low) * unit_factor(flight, "range", u) <= 1.5 * extent + 0.5]
    return Evidence(text=text, suggestion=fits[0] if fits else None)


def _unit_by_speed(flight: Flight) -> Evidence | None:
    """Ranges that change faster than anything moves."""
    place = np.floor((flight.range_time - flight.range_time[0]) / 0.5)
    number, first = np.unique(place, return_index=True)
    middle = np.array([np.median(part) for part in np.split(flight.range, first[1:])])
    if len(middle) < 4:
        return None
    speed = float(np.quantile(np.abs(np.diff(middle) / (0.5 * np.diff(number))), 0.75))
    velocity = twice_integrated(flight)(flight.time, 1)
    velocity -= np.linspace(velocity[0], velocity[-1], len(velocity))
    gained = float(np.linalg.norm(velocity, axis=-1).max())
    if speed < max(FAST, FASTER * gained):
        return None
    text = (
        f"the ranges change by {significant(speed)} m/s, and the velocity by {significant(gained)} m/s according to "
        "the accelerometer"
    )
    delay = delay_by_imu(flight)
    return Evidence(text=text, suggestion=_finer(flight, 0.0 if delay is None else delay.now, speed))


def _unit_by_bend(flight: Flight) -> Evidence | None:
    """Ranges that are accelerated towards the anchor more than the body is: d̈ ≥ −|p̈|, whatever the motion."""
    bends = [_bend(flight, begin) for begin in np.arange(flight.time[0], flight.time[-1] - BENT, BENT / 2)]
    surely = [value + SURE * sigma for value, sigma in bends if np.isfinite(sigma)]
    limit = BENDS * (float(np.quantile(np.linalg.norm(flight.accel, axis=-1), 0.99)) + GRAVITY)
    if not surely or -min(surely) < limit:
        return None
    delay = delay_by_imu(flight)
    text = (
        f"the ranges are accelerated towards the anchor by at least {significant(-min(surely))} m/s², and the body by "
        f"at most {significant(limit / BENDS)} m/s² according to the accelerometer"
    )
    return Evidence(text=text, suggestion=_finer(flight, 0.0 if delay is None else delay.now))


def _bend(flight: Flight, begin: float) -> tuple[float, float]:
    """The second derivative of the ranges over BENT seconds (m/s²) and its σ; no number with too few of them."""
    first, last = np.searchsorted(flight.range_time, [begin, begin + BENT])
    if last - first < FEWEST:
        return math.nan, math.nan
    tau, distance = flight.range_time[first:last] - begin - BENT / 2, flight.range[first:last]
    design = np.column_stack([tau**0, tau, tau**2 / 2])
    if np.ptp(tau) < BENT / 2:
        return math.nan, math.nan
    solution, *_ = np.linalg.lstsq(design, distance, rcond=None)
    variance = float(np.sum((distance - design @ solution) ** 2)) / (last - first - 3)
    return float(solution[2]), math.sqrt(variance * float(np.linalg.inv(design.T @ design)[2, 2]))


def _unit_by_scatter(flight: Flight) -> Evidence | None:
    """Ranges that scatter too much about every motion that the IMU allows."""
    delay = delay_by_imu(flight)
    suggested = None if delay is None or delay.now < SCATTER else _finer(flight, delay.now)
    if delay is None or suggested is None:
        return None
    text = f"the ranges scatter by {significant(delay.now)} m about every motion that the IMU allows"
    return Evidence(text=text, suggestion=suggested)


def _finer(flight: Flight, scatter: float, speed: float = 0.0) -> str | None:
    """The first unit in which distances, their scatter (m) and their change (m/s) are usual."""
    middle = float(np.median(flight.range))
    for unit in ("cm", "mm"):
        factor = unit_factor(flight, "range", unit)
        usual = factor * scatter <= CLOSE and factor * speed <= USUAL and NEAREST <= factor * middle <= FARTHEST
        if factor < 1 and usual:
            return unit
    return None
