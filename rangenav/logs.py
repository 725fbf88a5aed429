"""A recorded flight: was it informative, and what do the observers make of it?

Position is never differentiated (∫|p⁗|² of a measured path moves 400-fold with the smoothing). The Gramian needs the
IMU alone: in axes turned by the gyro D(s, t) = ∫_t^s (s − r) a_I(r) dr = X(s) − X(t) − (s − t) Ẋ(t), Ẍ = a_I; its rows
are those of `observability.rows`. Noise fills up every rank, so a singular value counts only if it is not noise: the
record is disturbed anew, some times stronger than it is noisy, and what rises with that is the noise's own.
"""

from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy import ndarray as Array
from scipy.interpolate import CubicHermiteSpline

from rangenav import cascade, model, motion, so3, verdict
from rangenav.attitude import AttitudeGains
from rangenav.cascade import Estimate, ObserverConfig, Start
from rangenav.formats import recorded_flight
from rangenav.formats.recorded_flight import Flight
from rangenav.gains import Gains
from rangenav.inputs import require
from rangenav.motion import World
from rangenav.observability import quadrature, spectrum
from rangenav.results import result
from rangenav.sensors import Noise, Sensors

WINDOWS = 51
PANELS_PER_SECOND = 1.0
"""Panels of 32 nodes: a window's rows are exact up to 36 rad/s, faster than D, an integral of an integral, turns."""
MOST_PANELS = 16
DRAWS, STRONGER = 4, 3.0
"""Disturbances tried, and how many times the record's own noise each is."""
NOISE_SHARE = 0.25
"""A singular value of whose square more than this is noise does not count."""
USUAL_NOISE = (0.01, 0.1)
"""rad/s and m/s² per sample, where no rest tells them."""
GYRO_DENSITY, ACCEL_DENSITY = 3e-4, 9e-2
"""(rad/s)²/Hz and (m/s²)²/Hz the observer is told for a real IMU: not its noise, a thousand times smaller, but what
scale, misalignment and lever arm make of fast motion. On BROAD's trial 21 (three anchors) they leave 0.75 m rms,
the noise at rest alone 5 m."""
K1 = 1.0
"""1/s; 4, the simulations' default, follows the gravity estimate's own errors: 5.8° rms there instead of 4.3°."""
WindowVerdict = verdict.Word | Literal["rank 13"]
"""On one window of a record; "rank 13" where there are no ranges from which an accuracy could be predicted."""
RecordVerdict = WindowVerdict | Literal["partly"]
"""On a whole record; "partly" where its windows differ."""


@result
class Informative:
    """What windows of a record could tell from one range; from the IMU alone but for `sigma`."""

    start: Float[Array, "w"]
    """s"""
    window: float
    eigenvalues: Float[Array, "w 13"]
    """Of (1/δ)∫, ascending, SI."""
    scaled: Float[Array, "w 13"]
    """Singular values in units of 1 m and δ, descending."""
    rank: Int[Array, "w"]
    noise: Float[Array, "w 13"]
    """The part of each scaled singular value that noise and bias of the IMU make, in the same units."""
    sigma: Float[Array, "w"]
    """m, predicted 1-σ position at the end of each window from its ranges; NaN where blind or without ranges."""
    worst: int
    each: tuple[WindowVerdict, ...]
    """On each window."""

    @property
    def verdict(self) -> RecordVerdict:
        """Of the whole record: that of every window, or "partly"."""
        return self.each[0] if len(set(self.each)) == 1 else "partly"

    @property
    def summary(self) -> str:
        """Where the record was informative."""
        blind = np.array([one == "blind" for one in self.each])
        if blind.all():
            return f"nowhere informative: no window of {self.window:g} s reaches rank {model.STATES}"
        middle = self.start + self.window / 2
        told = " and ".join(
            f"{count} {word}" for word in ("observable", "weak", "rank 13", "blind") if (count := self.each.count(word))
        )
        parts = [f"{told} of {len(self.each)} windows of {self.window:g} s"]
        if blind.any():
            places = ", ".join(f"{a:.4g} to {b:.4g} s" for a, b in _stretches(middle, blind))
            parts.append(f"blind around {places}")
        return "; ".join(parts)


@result
class Observed:
    """The observers on a record, with errors where the file has a truth."""

    estimate: Estimate
    world: World
    position: Float[Array, "n 3"]
    """m, inertial: the anchor plus R̂ p̂_B."""
    position_error: Float[Array, "n"] | None
    """m; NaN where the truth is missing."""
    attitude_error: Float[Array, "n"] | None
    """rad"""


def informative(
    flight: Flight, *, window: float, range_sigma: float, requirement: float, noise: tuple[float, float, float] | None
) -> Informative:
    """Spectra over sliding windows (s). noise: (gyro rad/s, accel m/s², gyro bias rad/s) at rest, None if unknown.

    requirement: the predicted position error (m) above which a window of full rank is weak.
    """
    length = float(flight.time[-1] - flight.time[0])
    require(0 < window < length, f"the window must be shorter than the record's {length:.4g} s, got {window:g} s")
    start = flight.time[0] + np.linspace(0, length - window, WINDOWS)
    curve, (tau, weight) = _twice_integrated(flight), _nodes(window)

    def spectra(curve: CubicHermiteSpline) -> spectrum.Spectrum:
        matrix = _rows(curve, start, tau)
        return spectrum.spectra(matrix, weight, window, time_powers=spectrum.LIFTED_TIME_POWERS, rounding=0.0)

    found, own = spectra(curve), np.zeros((WINDOWS, model.STATES))
    for seed in range(DRAWS):
        risen = spectra(_twice_integrated(_disturbed(flight, noise or (*USUAL_NOISE, 0.0), seed))).scaled
        own += np.maximum(risen**2 - found.scaled**2, 0.0) / (DRAWS * STRONGER**2)
    counts = (found.scaled > found.tolerance[:, None]) & (own < NOISE_SHARE * found.scaled**2)
    rank = np.sum(np.logical_and.accumulate(counts, axis=-1), axis=-1)
    sigma = np.array([_sigma(flight, curve, t, window, range_sigma) for t in start])
    sigma[rank < model.STATES] = np.nan
    worst = _worst(rank, found.scaled, sigma)
    return Informative(
        start=start,
        window=window,
        eigenvalues=found.eigenvalues,
        scaled=found.scaled,
        rank=rank,
        noise=np.sqrt(own),
        sigma=sigma,
        worst=worst,
        each=tuple(_verdict(int(r), float(s), requirement) for r, s in zip(rank, sigma, strict=True)),
    )


def observe(flight: Flight, world: World, *, sensors: Sensors, gains: Gains | None = None) -> Observed:
    """Run the cascade from x̂ = 0, R̂ = I. Raises ValueError without ranges."""
    require(len(flight.range) > 0, "no ranges: the observers need them (synthetic ones need a true position)")
    start = Start(state=np.zeros(model.STATES), rotation=np.eye(3))
    chosen = gains or Gains(mode="noise-matched", attitude=AttitudeGains(k1=K1))
    estimate = cascade.observe(
        recorded_flight.measurements(flight), start, ObserverConfig(world=world, sensors=sensors, gains=chosen)
    )
    position = estimate.position(world)
    return Observed(
        estimate=estimate,
        world=world,
        position=position,
        position_error=None if flight.position is None else np.linalg.norm(position - flight.position, axis=-1),
        attitude_error=None if flight.rotation is None else _turned(flight.rotation, estimate.rotation),
    )


def sensors_of(flight: Flight, *, range_sigma: float) -> Sensors:
    """Rates of the record, and the noise a real IMU is taken to have."""
    rate = float(1 / np.median(np.diff(flight.time)))
    ranges = float(1 / np.median(np.diff(flight.range_time))) if len(flight.range_time) > 1 else rate
    noise = Noise(
        gyro=float(np.sqrt(GYRO_DENSITY * rate)), accel=float(np.sqrt(ACCEL_DENSITY * rate)), range=range_sigma
    )
    rate = min(max(rate, 1.0), 1e4)
    return Sensors(imu_rate=rate, mag_rate=rate, range_rate=min(max(ranges, 1.0), 1e4), noise=noise)


def _twice_integrated(flight: Flight) -> CubicHermiteSpline:
    """X with Ẍ = a_I in axes turned by the gyro alone; trapezoids, on whatever stamps there are."""
    h = np.diff(flight.time)[:, None]
    turns = so3.exp(h * (flight.gyro[1:] + flight.gyro[:-1]) / 2)
    rotation = motion.cumulative_product(np.concatenate([np.eye(3)[None], turns]))
    force = motion.to_inertial(rotation, flight.accel)
    velocity = np.concatenate([np.zeros((1, 3)), np.cumsum(h * (force[1:] + force[:-1]) / 2, axis=0)])
    steps = h * velocity[:-1] + h**2 * (2 * force[:-1] + force[1:]) / 6
    place = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    return CubicHermiteSpline(flight.time, place, velocity)


def _nodes(window: float) -> tuple[Float[Array, "k"], Float[Array, "k"]]:
    panels = min(MOST_PANELS, max(1, round(window * PANELS_PER_SECOND)))
    return quadrature.composite(window, panels)


def _rows(curve: CubicHermiteSpline, reference: Float[Array, "w"], tau: Float[Array, "k"]) -> Float[Array, "w k 13"]:
    """𝒞Φ = [1, τ, τ²/2, τ³/6, Dᵀ, τDᵀ, ½τ²Dᵀ] at each reference time; τ may be negative."""
    s = tau[:, None]
    D = curve(reference[:, None] + tau) - curve(reference)[:, None] - s * curve(reference, 1)[:, None]
    powers = np.broadcast_to(np.stack([tau**0, tau, tau**2 / 2, tau**3 / 6], axis=-1), (len(reference), len(tau), 4))
    return np.concatenate([powers, D, s * D, s**2 / 2 * D], axis=-1)


def _disturbed(flight: Flight, noise: tuple[float, float, float], seed: int) -> Flight:
    """The record with more noise than it has, and a bias along some axis."""
    gyro, accel, bias = noise
    rng = np.random.default_rng(seed)
    axis = rng.standard_normal(3)
    turned = gyro * rng.standard_normal(flight.gyro.shape) + bias * axis / np.linalg.norm(axis)
    shaken = accel * rng.standard_normal(flight.accel.shape)
    return replace(flight, gyro=flight.gyro + STRONGER * turned, accel=flight.accel + STRONGER * shaken)


def _worst(rank: Int[Array, "w"], scaled: Float[Array, "w 13"], sigma: Float[Array, "w"]) -> int:
    """The window of lowest rank and then of largest error, or of least singular value where none is predicted."""
    error = np.where(np.isnan(sigma), 1 / np.maximum(scaled[:, -1], np.finfo(float).tiny), sigma)
    return int(np.lexsort((-error, rank))[0])


def _sigma(flight: Flight, curve: CubicHermiteSpline, start: float, window: float, range_sigma: float) -> float:
    """1-σ position (m) at the window's end from its measured ranges: their own distances weigh them."""
    first, last = np.searchsorted(flight.range_time, [start, start + window])
    if last - first < model.STATES:
        return np.nan
    stamps, distance = flight.range_time[first:last], flight.range[first:last]
    end = start + window
    variance = distance**2 * range_sigma**2 + range_sigma**4 / 2
    scale = window ** -spectrum.LIFTED_TIME_POWERS.astype(float)
    weighted = _rows(curve, np.array([end]), stamps - end)[0] * scale / np.sqrt(variance)[:, None]
    _, singular, right = np.linalg.svd(np.linalg.qr(weighted, mode="r"))
    if not singular[-1] > spectrum.RANK_TOLERANCE * singular[0]:
        return np.nan
    return float(np.linalg.norm(right[:, model.POSITION] / singular[:, None]))


def _stretches(time: Float[Array, "w"], where: Bool[Array, "w"]) -> list[tuple[float, float]]:
    """First and last time of every run of windows that the mask names."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], where.astype(int), [0]])))
    return [(float(time[a]), float(time[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _verdict(rank: int, sigma: float, requirement: float) -> WindowVerdict:
    """On a window of a recorded flight, whose path is never restricted; NaN where no accuracy is predicted."""
    if rank == model.STATES and np.isnan(sigma):
        return "rank 13"
    return verdict.judge(rank, sigma, requirement).word


def _turned(truth: Float[Array, "n 3 3"], estimate: Float[Array, "n 3 3"]) -> Float[Array, "n"]:
    """The angle (rad) of R R̂ᵀ; NaN where the truth is missing."""
    known = ~np.isnan(truth).any(axis=(1, 2))
    found = np.full(len(truth), np.nan)
    found[known] = so3.angle(truth[known] @ np.swapaxes(estimate[known], -1, -2))
    return found
