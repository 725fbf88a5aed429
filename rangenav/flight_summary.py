"""A recorded flight in a few numbers: what its windows could tell, and how far off the observers were."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import range_fit
from rangenav.divergence import divergence, range_residuals, with_residual
from rangenav.formats.recorded_flight import Flight
from rangenav.inputs import Vec3
from rangenav.logs import FEW, WORDS, Informative, Observed
from rangenav.number_format import quantity, vector
from rangenav.range_fit import RangeFit

QUARTERS = 4
"""Errors are summed up over each quarter of a record; the last one tells the steady errors."""
FAR_OVER = 2.0
"""Innovations that exceed their own σ by more than this factor on the average, in the last quarter: the noise that the
observer assumes, its anchor or its sensors are wrong."""
SETTLING = 3.0
"""Multiples of the required position error within which an observer that starts from zero may still be settling."""


@dataclass(frozen=True, kw_only=True)
class WindowSummary:
    """The verdicts on the sliding windows of a record, and its worst window."""

    window: float
    """s, the length of each window."""
    counts: dict[str, int]
    """How many windows have each verdict."""
    worst_start: float
    """s, by the record's own stamps."""
    worst_rank: int
    """Of 13, of the ranges of the worst window."""
    worst_ranges: int
    """How many ranges the worst window has."""
    motion_rank: int
    """Of 13, that ranges at every time of the worst window would have."""
    worst_eigenvalues: tuple[float, ...]
    """Of the worst window's Gramian (1/δ)∫, ascending, SI."""
    worst_position: float | None
    """m, predicted 1-σ position at the end of the worst window; None where it is blind or without ranges."""
    median_position: float | None
    """m, the median over the windows for which a position error is predicted; None if there are none."""


@dataclass(frozen=True, kw_only=True)
class ErrorSummary:
    """One error of an estimate; None where the estimate overflowed or the truth is missing."""

    quarters: tuple[float | None, ...]
    """Root mean square over each quarter of the record."""
    median: float | None

    @property
    def complete(self) -> bool:
        """Whether every number is known."""
        return None not in self.quarters and self.median is not None


@dataclass(frozen=True, kw_only=True)
class ObserverSummary:
    """What the observers made of a record; None where the estimate overflowed."""

    final_position: tuple[float | None, ...]
    """m, inertial."""
    innovation_rms: float | None
    """m², of y = ½d²."""
    diverged: str | None
    """Why the observer has diverged, one clause; None if it has not."""
    range_residual: float
    """m, RMS of |p̂| − d over the last quarter of the ranges."""
    position: ErrorSummary | None
    """m; None without a true position."""
    attitude: ErrorSummary | None
    """degrees; None without a true attitude."""
    fit: RangeFit
    """How well the estimate fits the ranges; the truth is not used."""

    @property
    def complete(self) -> bool:
        """Whether final position and innovation are known."""
        return None not in self.final_position and self.innovation_rms is not None


def ranges_source(flight: Flight, anchor: Vec3, *, synthetic: float | None, anchor_given: bool) -> str:
    """The ranges that a record is judged with and where their anchor comes from, as one clause; empty without ranges.

    anchor: m, inertial. synthetic: σ of synthetic ranges (m); None for those of the file. anchor_given: whether a
    person gave the anchor.
    """
    if not len(flight.range):
        return ""
    count = "1 range" if len(flight.range) == 1 else f"{len(flight.range)} ranges"
    ranges = f"{count} of the file" if synthetic is None else f"synthetic ranges of σ {quantity(synthetic, 'm')}"
    return f"with {ranges} to an anchor at {vector(anchor)} m, {'as given' if anchor_given else 'as the file says'}"


def more_ranges(counts: Mapping[str, int]) -> str:
    """What windows with too few ranges would tell with more of them, by the counts of the verdicts; else empty."""
    few = counts[FEW]
    return f"13 ranges or more would determine {few} of the windows: their motion has rank 13" if few else ""


def summarise_windows(windows: Informative) -> WindowSummary:
    """Counts of verdicts, and the worst window."""
    worst = windows.worst
    known = windows.sigma[np.isfinite(windows.sigma)]
    return WindowSummary(
        window=windows.window,
        counts={verdict: windows.each.count(verdict) for verdict in WORDS},
        worst_start=float(windows.start[worst]),
        worst_rank=int(windows.rank[worst]),
        worst_ranges=int(windows.ranges[worst]),
        motion_rank=int(windows.motion_rank[worst]),
        worst_eigenvalues=tuple(windows.eigenvalues[worst].tolist()),
        worst_position=_finite(float(windows.sigma[worst])),
        median_position=float(np.median(known)) if len(known) else None,
    )


def summarise_observer(observed: Observed) -> ObserverSummary:
    """Where the observers end, and their errors by quarters where the record has a truth."""
    taken = (observed.range_time, observed.range)
    fit = with_residual(range_fit.of(observed.estimate), observed.estimate, *taken, observed.range_sigma)
    degrees = None if observed.attitude_error is None else np.degrees(observed.attitude_error)
    return ObserverSummary(
        final_position=tuple(_finite(float(value)) for value in observed.position[-1]),
        innovation_rms=_rms(observed.estimate.innovation[:, 0]),
        diverged=divergence(observed.estimate, *taken, fit),
        range_residual=range_residuals(observed.estimate, *taken)[1],
        position=None if observed.position_error is None else _errors(observed.position_error),
        attitude=None if degrees is None else _errors(degrees),
        fit=fit,
    )


def failure(observer: ObserverSummary, required: float) -> str | None:
    """Why the observer failed on a record, one clause; None if it did not. required: the position error asked for (m).

    By its own account, by its ranges, or by the truth in the last quarter of the record.
    """
    if observer.diverged is not None:
        return f"the observer has diverged: {observer.diverged}"
    if not observer.complete:
        return "the observer's estimate overflowed"
    if observer.fit.word == "lost":
        return "the observer is lost: the ranges contradict it again and again"
    last = None if observer.position is None else observer.position.quarters[-1]
    if last is not None and last > SETTLING * required:
        return f"the observer is {quantity(last, 'm')} off in the last quarter of the record"
    fit = observer.fit
    if fit.word == "overconfident" and fit.factor is not None and fit.factor > FAR_OVER:
        return f"the observer's innovations are {fit.factor:.2g} times as large as it expects"
    if observer.position is None and fit.collecting:
        return "the observer has not determined the position yet"
    return None


def _errors(error: Float[Array, "n"]) -> ErrorSummary:
    n = len(error)
    parts = [error[k * n // QUARTERS : (k + 1) * n // QUARTERS] for k in range(QUARTERS)]
    return ErrorSummary(quarters=tuple(_rms(part) for part in parts), median=_finite(float(np.nanmedian(error))))


def _rms(values: Float[Array, "n"]) -> float | None:
    """NaN is a missing value and left out; None if all are missing or the mean is not finite."""
    known = values[~np.isnan(values)]
    return _finite(float(np.sqrt(np.mean(known**2)))) if len(known) else None


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
