"""The ranges by themselves: values that are no distances, values that a logger holds, and lost samples of a radio.

A range of zero weighs most of all: the variance of ½d² is d²σ², which vanishes at d = 0. A value that is held over n
rows is one measurement, and not n.
"""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.formats.import_result import lines
from rangenav.formats.recorded_flight import Flight
from rangenav.record_checks.check import Evidence

LEAST = 10
"""Ranges, without which nothing is told."""
NEIGHBOURS = 4
"""Ranges before and after one, with whose median it is compared."""
BEYOND, SPREADS = 10.0, 10.0
"""m, and usual distances from the neighbours' median, beyond which a range is out of reach."""
AGAIN, APART = 3, 2.0
"""How often a value comes back that stands for no measurement, and m from its neighbours' median."""
HELD = 0.7
"""Least share of runs of equal values that have the usual length, for values that are held."""
NOISE = 1.0
"""m from its neighbours' median, within which a single range below zero is the noise of one close to zero."""
NAMED = 6
"""Most kinds of values that a finding lists."""


def no_distances(flight: Flight) -> Bool[Array, "m"]:
    """Ranges that are no distances: zero and below, all the same, out of reach, or coming back from elsewhere."""
    distance = flight.range
    if len(distance) >= LEAST and np.ptp(distance) == 0:
        return np.ones(len(distance), dtype=bool)
    bad = np.asarray(distance <= 0)
    if len(distance) > 2 * NEIGHBOURS and bad.any():
        _, place, count = np.unique(distance, return_inverse=True, return_counts=True)
        bad &= (count[place.reshape(-1)] > 1) | (
            from_neighbours(distance) > NOISE
        )  # else the noise of a pass of the anchor
    if (~bad).sum() < LEAST:
        return bad
    for _ in range(2):  # the second time without what the first found, which may outnumber the neighbours
        good = np.flatnonzero(~bad)
        away = from_neighbours(distance[good])
        limit = max(BEYOND, SPREADS * float(np.median(away)))
        _, place, count = np.unique(distance[good], return_inverse=True, return_counts=True)
        returning = (count[place.reshape(-1)] >= AGAIN) & (away > max(APART, SPREADS * float(np.median(away))))
        bad[good[(away > limit) | returning]] = True
        if (~bad).sum() < LEAST:
            break
    return bad


def from_neighbours(distance: Float[Array, "m"]) -> Float[Array, "m"]:
    """How far each range (m) is from the median of its neighbours and itself."""
    padded = np.pad(distance, NEIGHBOURS, mode="reflect" if len(distance) > NEIGHBOURS else "edge")
    around = np.lib.stride_tricks.sliding_window_view(padded, 2 * NEIGHBOURS + 1)
    return np.abs(distance - np.median(around, axis=-1))


def values(flight: Flight) -> Evidence | None:
    """Ranges that are no distances, by value, count and line."""
    if len(flight.range) == 0:
        return None
    bad = no_distances(flight)
    if not bad.any():
        return None
    kinds, count = np.unique(flight.range[bad], return_counts=True)
    where = "" if flight.range_lines is None else f", on {lines(flight.range_lines[bad], counted=True)}"
    if bad.all() and len(kinds) == 1:
        text = f"all {len(bad)} ranges are the same, {kinds[0]:g} m, and no distances of this motion{where}"
        return Evidence(text=text, suggestion="drop")
    order = np.argsort(-count, kind="stable")[:NAMED]
    named = ", ".join(f"{count[k]} of {kinds[k]:g} m" for k in order)
    more = f" and {len(kinds) - NAMED} other values" if len(kinds) > NAMED else ""
    text = f"{int(bad.sum())} of {len(bad)} ranges are no distances of this motion: {named}{more}{where}"
    return Evidence(text=text, suggestion="drop")


def _runs(distance: Float[Array, "m"]) -> tuple[Array, Array]:
    """The first range of each run of equal values, and the length of each run."""
    first = np.flatnonzero(np.concatenate([[True], np.diff(distance) != 0])) if len(distance) else np.empty(0, int)
    return first, np.diff(np.append(first, len(distance)))


def held(flight: Flight) -> Evidence | None:
    """Values that are written again and again until the next one comes."""
    first, length = _runs(flight.range)
    inner = length[1:-1]
    if len(inner) < LEAST // 2:
        return None
    usual = int(np.median(inner))
    if usual < 2 or np.mean(np.abs(inner - usual) <= 1) < HELD:
        return None
    text = (
        f"each range stands on {usual} rows, held until the next one: {len(flight.range)} rows are {len(first)} ranges"
    )
    return Evidence(text=text, suggestion="once")


def first_of_each(flight: Flight) -> Bool[Array, "m"]:
    """The first row of each range that is held."""
    kept = np.zeros(len(flight.range), dtype=bool)
    kept[_runs(flight.range)[0]] = True
    return kept
