"""The rank and the predicted error of the windows of a recorded flight.

Position is never differentiated: ∫|p⁗|² of a measured path changes 400-fold with the smoothing. The Gramian needs the
IMU alone, whose motion and rows are those of `imu_motion`. Noise makes every matrix full rank, so a singular value
counts only if little of it is noise. To estimate the noise's part, noise some times stronger than the record's is added
to the record; the part is the increase of the squared singular values, scaled back.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy import ndarray as Array
from scipy.interpolate import CubicHermiteSpline

from rangenav import model, verdict
from rangenav.formats.recorded_flight import Flight
from rangenav.imu_motion import lifted_rows, twice_integrated
from rangenav.observability import quadrature, spectrum
from rangenav.results import result

WINDOWS = 51
PANELS_PER_SECOND = 1.0
"""Panels of 32 nodes: rows are exact up to 36 rad/s; D, which is integrated twice, has no faster parts."""
MOST_PANELS = 16
KEPT = 2
"""Records whose curves are kept: windows and the whole of a record are judged one after the other."""
DRAWS, STRONGER = 4, 3.0
"""Number of disturbed records, and the size of the added noise in units of the record's own."""
NOISE_SHARE = 0.25
"""A singular value does not count if noise makes more than this share of its square."""
USUAL_NOISE = (0.01, 0.1)
"""rad/s and m/s² per sample, for a record without a rest from which they follow."""
WindowVerdict = verdict.Word | Literal["too few ranges"]
"""The verdict on one window of a record. Fewer ranges than unknowns determine nothing, whatever the motion."""
RecordVerdict = WindowVerdict | Literal["partly"]
"""The verdict on the windows of a record; "partly" where they differ."""
FEW: WindowVerdict = "too few ranges"
WORDS: tuple[WindowVerdict, ...] = ("observable", "weak", FEW, "blind", "not judged")


@result
class Informative:
    """Observability of a record's windows from one range."""

    start: Float[Array, "w"]
    """s"""
    window: float
    eigenvalues: Float[Array, "w 13"]
    """Eigenvalues of the Gramian (1/δ)∫, ascending, SI."""
    scaled: Float[Array, "w 13"]
    """Singular values in units of 1 m and δ, descending."""
    motion_rank: Int[Array, "w"]
    """Of the Gramian, by the IMU alone: the rank that ranges at every time would have."""
    ranges: Int[Array, "w"]
    """How many ranges each window has."""
    rank: Int[Array, "w"]
    """Of the ranges that each window has, never more than their number, nor than the motion's rank."""
    noise: Float[Array, "w 13"]
    """The part of each scaled singular value that is due to noise and bias of the IMU, in the same units."""
    sigma: Float[Array, "w"]
    """m, predicted 1-σ position at the end of each window from its ranges; NaN where its rank is below 13."""
    worst: int
    """Index of the worst window."""
    each: tuple[WindowVerdict, ...]
    """The verdict on each window."""
    restriction: str | None = None
    """Why the record is not judged; None if it is."""

    @property
    def verdict(self) -> RecordVerdict:
        """The verdict on all windows: that of every window, or "partly"."""
        return self.each[0] if len(set(self.each)) == 1 else "partly"

    @property
    def summary(self) -> str:
        """In how many windows the record was informative, and the times at which its blind windows begin."""
        if self.restriction is not None:
            return f"not judged: {self.restriction}"
        blind = np.array([one == "blind" for one in self.each])
        if blind.all():
            return f"nowhere informative: no window of {self.window:g} s reaches rank {model.STATES}"
        counts = " and ".join(f"{count} {word}" for word in WORDS if (count := self.each.count(word)))
        parts = [f"{counts} of {len(self.each)} windows of {self.window:g} s"]
        if FEW in self.each:
            number = self.ranges[np.array([one == FEW for one in self.each])]
            span = f"{number.min()}" if np.ptp(number) == 0 else f"{number.min()} to {number.max()}"
            parts.append(f"{span} of the {model.STATES} ranges that a window needs")
        if blind.any():
            places = ", ".join(f"{a:.4g} to {b:.4g} s" for a, b in _stretches(self.start, blind))
            parts.append(f"blind where they begin at {places}")
        return "; ".join(parts)


@dataclass(frozen=True, kw_only=True)
class Criteria:
    """What the windows of a record are judged by."""

    range_sigma: float
    """m"""
    requirement: float
    """m, the predicted position error above which a window of full rank is weak."""
    restriction: str | None
    """Why the record is not judged; None if it is."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Curves:
    """A record, twice integrated, as it is and with noise added."""

    flight: Flight
    curve: CubicHermiteSpline
    disturbed: tuple[CubicHermiteSpline, ...]


@lru_cache(maxsize=KEPT)
def curves(flight: Flight, noise: tuple[float, float, float] | None) -> Curves:
    """The record, twice integrated. noise: as for `informative`."""
    known = noise or (*USUAL_NOISE, 0.0)
    disturbed = tuple(twice_integrated(_disturbed(flight, known, seed)) for seed in range(DRAWS))
    return Curves(flight=flight, curve=twice_integrated(flight), disturbed=disturbed)


def judged(record: Curves, start: Float[Array, "w"], window: float, criteria: Criteria) -> Informative:
    """The windows of `window` seconds that begin at the times `start`."""
    tau, weight = _nodes(window)

    def spectra(curve: CubicHermiteSpline) -> spectrum.Spectrum:
        matrix = lifted_rows(curve, start, tau)
        return spectrum.spectra(matrix, weight, window, time_powers=spectrum.LIFTED_TIME_POWERS, rounding=0.0)

    undisturbed, noise_part = spectra(record.curve), np.zeros((len(start), model.STATES))
    for curve in record.disturbed:
        noise_part += np.maximum(spectra(curve).scaled ** 2 - undisturbed.scaled**2, 0.0) / (DRAWS * STRONGER**2)
    counted = (undisturbed.scaled > undisturbed.tolerance[:, None]) & (noise_part < NOISE_SHARE * undisturbed.scaled**2)
    motion_rank = np.sum(np.logical_and.accumulate(counted, axis=-1), axis=-1)
    ranged = [by_ranges(record, float(t), float(t) + window, criteria.range_sigma) for t in start]
    ranges, of_ranges, sigma = (np.array(values) for values in zip(*ranged, strict=True))
    rank = np.minimum(motion_rank, of_ranges)
    sigma[rank < model.STATES] = np.nan
    return Informative(
        start=start,
        window=window,
        eigenvalues=undisturbed.eigenvalues,
        scaled=undisturbed.scaled,
        motion_rank=motion_rank,
        ranges=ranges,
        rank=rank,
        noise=np.sqrt(noise_part),
        sigma=sigma,
        worst=worst(rank, undisturbed.scaled, sigma),
        each=tuple(judge(*one, criteria) for one in zip(motion_rank, ranges, rank, sigma, strict=True)),
        restriction=criteria.restriction,
    )


def _nodes(window: float) -> tuple[Float[Array, "k"], Float[Array, "k"]]:
    panels = min(MOST_PANELS, max(1, round(window * PANELS_PER_SECOND)))
    return quadrature.composite(window, panels)


def _disturbed(flight: Flight, noise: tuple[float, float, float], seed: int) -> Flight:
    """The record with added noise, STRONGER times its own, and an added gyro bias along a random axis."""
    gyro, accel, bias = noise
    rng = np.random.default_rng(seed)
    axis = rng.standard_normal(3)
    turned = gyro * rng.standard_normal(flight.gyro.shape) + bias * axis / np.linalg.norm(axis)
    shaken = accel * rng.standard_normal(flight.accel.shape)
    return replace(flight, gyro=flight.gyro + STRONGER * turned, accel=flight.accel + STRONGER * shaken)


def worst(rank: Int[Array, "w"], scaled: Float[Array, "w 13"], sigma: Float[Array, "w"]) -> int:
    """The window of lowest rank, then of largest error, or of least singular value where no error is predicted."""
    error = np.where(np.isnan(sigma), 1 / np.maximum(scaled[:, -1], np.finfo(float).tiny), sigma)
    return int(np.lexsort((-error, rank))[0])


def by_ranges(
    record: Curves, begin: float, end: float, range_sigma: float, *, until: float | None = None
) -> tuple[int, int, float]:
    """Number and rank of the ranges from `begin` to `end`, and the 1-σ position (m) that they tell at `until` (s).

    until: the end, if None. The position is NaN where they determine none. Each measured range d has the weight
    1/(d²σ² + ½σ⁴).
    """
    flight, until = record.flight, end if until is None else until
    first, last = (int(k) for k in np.searchsorted(flight.range_time, [begin, end]))
    if last - first < model.STATES:
        return last - first, last - first, np.nan
    stamps, distance = flight.range_time[first:last], flight.range[first:last]
    variance = distance**2 * range_sigma**2 + range_sigma**4 / 2
    scale = (until - begin) ** -spectrum.LIFTED_TIME_POWERS.astype(float)
    rows = lifted_rows(record.curve, np.array([until]), stamps - until)[0]
    weighted = rows * scale / np.sqrt(variance)[:, None]
    _, singular, right = np.linalg.svd(np.linalg.qr(weighted, mode="r"))
    rank = int(np.sum(singular > spectrum.RANK_TOLERANCE * singular[0]))
    if rank < model.STATES:
        return last - first, rank, np.nan
    return last - first, rank, float(np.linalg.norm(right[:, model.POSITION] / singular[:, None]))


def _stretches(time: Float[Array, "w"], where: Bool[Array, "w"]) -> list[tuple[float, float]]:
    """First and last time of every run of consecutive windows in the mask."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], where.astype(int), [0]])))
    return [(float(time[a]), float(time[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def judge(motion_rank: int, ranges: int, rank: int, sigma: float, criteria: Criteria) -> WindowVerdict:
    """The verdict on one window; sigma (m) is NaN where none is predicted."""
    if criteria.restriction is None and motion_rank == model.STATES > ranges:
        return FEW
    return verdict.judge(int(rank), float(sigma), criteria.requirement, restriction=criteria.restriction).word
