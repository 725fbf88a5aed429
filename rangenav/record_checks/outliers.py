"""Single ranges that are far off: against the true positions, or against their neighbours where there is no truth.

    truth       e = d − |p − anchor| against the median of its neighbours: anchor, offset and clock change slowly
    no truth    d above, or below, both of its neighbours and both lines through the next two on either side
The latter holds for a body that passes the anchor at any speed: its distance continues the line on one side at least.
"""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.formats.import_result import lines
from rangenav.formats.recorded_flight import Flight, with_some_ranges
from rangenav.number_format import significant
from rangenav.record_checks import ranges
from rangenav.record_checks.check import Evidence
from rangenav.record_checks.residuals import residuals

LEAST, SPREADS = 1.0, 12.0
"""m, and usual distances from what the others say, beyond which a range is off."""
MOST_ROUNDS = 20
FEWEST = 20
"""Ranges, without which nothing is told."""


def off(flight: Flight) -> Float[Array, "m"]:
    """How far each range is off (m), by the truth or by its neighbours; zero where it is not.

    What is off is left out, and the others are compared again, until none of them is off.
    """
    size = np.zeros(len(flight.range))
    for _ in range(MOST_ROUNDS):
        kept = np.flatnonzero(size == 0)
        found = _off_once(with_some_ranges(flight, size == 0))
        if not found.any():
            break
        size[kept] = found
    return size


def _off_once(flight: Flight) -> Float[Array, "m"]:
    size = np.zeros(len(flight.range))
    if len(flight.range) < FEWEST:
        return size
    left = residuals(flight)
    if left is None:
        size[2:-2] = _by_neighbours(flight.range_time, flight.range)
        return size
    there, error = left
    away = ranges.from_neighbours(error)
    size[there] = np.where(away > _limit(float(np.median(away))), away, 0.0)
    return size


def _limit(usual: float) -> float:
    return max(LEAST, SPREADS * usual)


def _by_neighbours(time: Float[Array, "m"], distance: Float[Array, "m"]) -> Float[Array, "k"]:
    """How far each range but the first and last two is off (m), by its neighbours alone; zero where it is not."""
    step = np.maximum(np.diff(time), np.finfo(float).tiny)
    slope = np.diff(distance) / step
    before = distance[1:-3] + slope[:-3] * step[1:-2]
    after = distance[3:-1] - slope[3:] * step[2:-1]
    others, here = np.stack([before, distance[1:-3], distance[3:-1], after]), distance[2:-2]
    outside = np.maximum(here - others.max(axis=0), others.min(axis=0) - here)
    usual = float(np.median(np.abs(here - (distance[1:-3] + distance[3:-1]) / 2)))
    return np.where(outside > _limit(usual), outside, 0.0)


def is_outlier(flight: Flight) -> Bool[Array, "m"]:
    """Which ranges are off."""
    return off(flight) > 0


def outliers(flight: Flight) -> Evidence | None:
    """Ranges that are far off, by count, size and line."""
    size = off(flight)
    bad = size > 0
    if not bad.any():
        return None
    low, high = float(size[bad].min()), float(size[bad].max())
    span = significant(high) if significant(low) == significant(high) else f"{significant(low)} to {significant(high)}"
    by = "what their neighbours allow" if residuals(flight) is None else "the distance from the true position"
    where = "" if flight.range_lines is None else f", on {lines(flight.range_lines[bad], counted=True)}"
    count = "1 of" if bad.sum() == 1 else f"{int(bad.sum())} of"
    is_off = "is" if bad.sum() == 1 else "are"
    text = f"{count} {len(bad)} ranges {is_off} {span} m off {by}{where}"
    return Evidence(text=text, suggestion="drop")
