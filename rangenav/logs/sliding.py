"""Sliding windows of a recorded flight: none of them tells less than a shorter window inside it.

The noise of the IMU, integrated over a longer window, may hide what a part of the window determines. So windows of
several lengths are judged, and a window has at least the rank of each of them that it contains.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model
from rangenav.formats.recorded_flight import Flight
from rangenav.inputs import require
from rangenav.logs.windows import WINDOWS, Criteria, Curves, Informative, by_ranges, curves, judge, judged, worst

LENGTHS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0)
"""s, the windows that are tried."""
LOOKS = 13
"""Windows of each length; a length that suffices in all of them is confirmed by as many as `informative` has."""
GROWTH = 3
"""The power of time with which the position error of a part is taken to grow, to choose the best part of a window."""
CLOSE = 1e-9
"""s, by which a window may be outside of another one that contains it, by rounding."""


def informative(
    flight: Flight,
    *,
    window: float,
    range_sigma: float,
    requirement: float,
    noise: tuple[float, float, float] | None,
    restriction: str | None = None,
) -> Informative:
    """Spectra, predicted errors and verdicts over sliding windows of `window` seconds.

    range_sigma: m. requirement: the predicted position error (m) above which a window of full rank is weak.
    noise: gyro (rad/s) and accelerometer (m/s²) per sample, gyro bias (rad/s), at rest; None if unknown.
    restriction: why the record is not judged, if it is not; see `record_checks`.
    Raises ValueError for a window that is not shorter than the record.
    """
    length = float(flight.time[-1] - flight.time[0])
    require(0 < window < length, f"the window must be shorter than the record's {length:.4g} s, got {window:g} s")
    criteria = Criteria(range_sigma=range_sigma, requirement=requirement, restriction=restriction)
    record = curves(flight, noise)
    own = judged(record, starts(flight, window, WINDOWS), window, criteria)
    shorter = [one for one in LENGTHS if one < window] if restriction is None else []
    return _with_parts(record, own, [looks(record, one, criteria) for one in shorter], criteria)


def starts(flight: Flight, window: float, count: int) -> Float[Array, "w"]:
    """Where so many windows of `window` seconds begin (s), over all of the record."""
    return flight.time[0] + np.linspace(0, float(flight.time[-1] - flight.time[0]) - window, count)


@lru_cache(maxsize=2 * len(LENGTHS))
def looks(record: Curves, window: float, criteria: Criteria) -> Informative:
    """LOOKS windows of one length, all over the record."""
    return judged(record, starts(record.flight, window, LOOKS), window, criteria)


def _with_parts(record: Curves, own: Informative, shorter: list[Informative], criteria: Criteria) -> Informative:
    """The windows, each with the rank of the shorter windows that it contains, if theirs is higher."""
    motion_rank, rank, sigma = own.motion_rank.copy(), own.rank.copy(), own.sigma.copy()
    for i in np.flatnonzero(own.rank < model.STATES):
        begin, end = float(own.start[i]), float(own.start[i] + own.window)
        best: tuple[float, float, float] | None = None
        for parts in shorter:
            inside = (parts.start >= begin - CLOSE) & (parts.start + parts.window <= end + CLOSE)
            if not inside.any():
                continue
            motion_rank[i] = max(motion_rank[i], parts.motion_rank[inside].max())
            rank[i] = max(rank[i], parts.rank[inside].max())
            for j in np.flatnonzero(inside & (parts.rank == model.STATES)):
                part = float(parts.start[j]), float(parts.start[j] + parts.window)
                at_end = float(parts.sigma[j]) * ((end - part[0]) / parts.window) ** GROWTH
                best = min(best or (np.inf, *part), (at_end, *part))
        if best is not None:  # what its ranges tell of the position at the end of the window
            sigma[i] = by_ranges(record, best[1], best[2], criteria.range_sigma, until=end)[2]
    return replace(
        own,
        motion_rank=motion_rank,
        rank=rank,
        sigma=sigma,
        worst=worst(rank, own.scaled, sigma),
        each=tuple(judge(*one, criteria) for one in zip(motion_rank, own.ranges, rank, sigma, strict=True)),
    )
