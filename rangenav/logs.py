"""A recorded flight: the rank and the predicted error of its windows, and the observers' estimates on its ranges.

Position is never differentiated: ∫|p⁗|² of a measured path changes 400-fold with the smoothing. The Gramian needs the
IMU alone: in axes turned by the gyro D(s, t) = ∫_t^s (s − r) a_I(r) dr = X(s) − X(t) − (s − t) Ẋ(t), Ẍ = a_I; its rows
are those of `observability.rows`. Noise makes every matrix full rank, so a singular value counts only if little of it
is noise. To estimate the noise's part, noise some times stronger than the record's is added to the record; the part is
the increase of the squared singular values, scaled back.
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
"""Panels of 32 nodes: rows are exact up to 36 rad/s; D, which is integrated twice, has no faster parts."""
MOST_PANELS = 16
DRAWS, STRONGER = 4, 3.0
"""Number of disturbed records, and the size of the added noise in units of the record's own."""
NOISE_SHARE = 0.25
"""A singular value does not count if noise makes more than this share of its square."""
USUAL_NOISE = (0.01, 0.1)
"""rad/s and m/s² per sample, for a record without a rest from which they follow."""
GYRO_DENSITY, ACCEL_DENSITY = 3e-4, 9e-2
"""(rad/s)²/Hz and (m/s²)²/Hz that the observer assumes for a real IMU. They stand for the errors of scale, misalignment
and lever arm in fast motion; the noise itself is a thousand times smaller. The position error on trial 21 of the BROAD
data set (three anchors) is 0.75 m rms with them, and 5 m with the noise at rest."""
K1 = 1.0
"""1/s. With 4, the default of simulations, the attitude follows the errors of the gravity estimate: on the same trial
5.8° rms instead of 4.3°."""
WindowVerdict = verdict.Word | Literal["rank 13"]
"""The verdict on one window of a record; "rank 13" where there are no ranges from which to predict an accuracy."""
RecordVerdict = WindowVerdict | Literal["partly"]
"""The verdict on a whole record; "partly" where its windows differ."""


@result
class Informative:
    """Observability of a record's windows from one range. Only `sigma` needs ranges; the rest needs the IMU alone."""

    start: Float[Array, "w"]
    """s"""
    window: float
    eigenvalues: Float[Array, "w 13"]
    """Eigenvalues of the Gramian (1/δ)∫, ascending, SI."""
    scaled: Float[Array, "w 13"]
    """Singular values in units of 1 m and δ, descending."""
    rank: Int[Array, "w"]
    noise: Float[Array, "w 13"]
    """The part of each scaled singular value that is due to noise and bias of the IMU, in the same units."""
    sigma: Float[Array, "w"]
    """m, predicted 1-σ position at the end of each window from its ranges; NaN where blind or without ranges."""
    worst: int
    """Index of the worst window."""
    each: tuple[WindowVerdict, ...]
    """The verdict on each window."""

    @property
    def verdict(self) -> RecordVerdict:
        """The verdict on the whole record: that of every window, or "partly"."""
        return self.each[0] if len(set(self.each)) == 1 else "partly"

    @property
    def summary(self) -> str:
        """In how many windows the record was informative, and the times around which it was blind."""
        blind = np.array([one == "blind" for one in self.each])
        if blind.all():
            return f"nowhere informative: no window of {self.window:g} s reaches rank {model.STATES}"
        middle = self.start + self.window / 2
        counts = " and ".join(
            f"{count} {word}" for word in ("observable", "weak", "rank 13", "blind") if (count := self.each.count(word))
        )
        parts = [f"{counts} of {len(self.each)} windows of {self.window:g} s"]
        if blind.any():
            places = ", ".join(f"{a:.4g} to {b:.4g} s" for a, b in _stretches(middle, blind))
            parts.append(f"blind around {places}")
        return "; ".join(parts)


@result
class Observed:
    """The observers' estimates on a record, with their errors where the file has the true motion."""

    estimate: Estimate
    world: World
    position: Float[Array, "n 3"]
    """m, inertial: the anchor plus R̂ p̂_B."""
    position_error: Float[Array, "n"] | None
    """m; NaN at samples without a true position, None if the file has none."""
    attitude_error: Float[Array, "n"] | None
    """rad, likewise."""


def informative(
    flight: Flight, *, window: float, range_sigma: float, requirement: float, noise: tuple[float, float, float] | None
) -> Informative:
    """Spectra, predicted errors and verdicts over sliding windows of `window` seconds.

    range_sigma: m. requirement: the predicted position error (m) above which a window of full rank is weak.
    noise: gyro (rad/s) and accelerometer (m/s²) per sample, gyro bias (rad/s), at rest; None if unknown.
    Raises ValueError for a window that is not shorter than the record.
    """
    length = float(flight.time[-1] - flight.time[0])
    require(0 < window < length, f"the window must be shorter than the record's {length:.4g} s, got {window:g} s")
    start = flight.time[0] + np.linspace(0, length - window, WINDOWS)
    curve, (tau, weight) = _twice_integrated(flight), _nodes(window)

    def spectra(curve: CubicHermiteSpline) -> spectrum.Spectrum:
        matrix = _rows(curve, start, tau)
        return spectrum.spectra(matrix, weight, window, time_powers=spectrum.LIFTED_TIME_POWERS, rounding=0.0)

    undisturbed, noise_part = spectra(curve), np.zeros((WINDOWS, model.STATES))
    for seed in range(DRAWS):
        disturbed = spectra(_twice_integrated(_disturbed(flight, noise or (*USUAL_NOISE, 0.0), seed))).scaled
        noise_part += np.maximum(disturbed**2 - undisturbed.scaled**2, 0.0) / (DRAWS * STRONGER**2)
    counted = (undisturbed.scaled > undisturbed.tolerance[:, None]) & (noise_part < NOISE_SHARE * undisturbed.scaled**2)
    rank = np.sum(np.logical_and.accumulate(counted, axis=-1), axis=-1)
    sigma = np.array([_sigma(flight, curve, t, window, range_sigma) for t in start])
    sigma[rank < model.STATES] = np.nan
    worst = _worst(rank, undisturbed.scaled, sigma)
    return Informative(
        start=start,
        window=window,
        eigenvalues=undisturbed.eigenvalues,
        scaled=undisturbed.scaled,
        rank=rank,
        noise=np.sqrt(noise_part),
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
        attitude_error=None if flight.rotation is None else _angle_between(flight.rotation, estimate.rotation),
    )


def sensors_of(flight: Flight, *, range_sigma: float) -> Sensors:
    """The record's rates, and the noise that the observer assumes (GYRO_DENSITY, ACCEL_DENSITY; range_sigma in m)."""
    rate = float(1 / np.median(np.diff(flight.time)))
    ranges = float(1 / np.median(np.diff(flight.range_time))) if len(flight.range_time) > 1 else rate
    noise = Noise(
        gyro=float(np.sqrt(GYRO_DENSITY * rate)), accel=float(np.sqrt(ACCEL_DENSITY * rate)), range=range_sigma
    )
    rate = min(max(rate, 1.0), 1e4)
    return Sensors(imu_rate=rate, mag_rate=rate, range_rate=min(max(ranges, 1.0), 1e4), noise=noise)


def _twice_integrated(flight: Flight) -> CubicHermiteSpline:
    """X with Ẍ = a_I in axes turned by the gyro alone, by the trapezoidal rule; stamps may be uneven."""
    h = np.diff(flight.time)[:, None]
    turns = so3.exp(h * (flight.gyro[1:] + flight.gyro[:-1]) / 2)
    rotation = motion.cumulative_product(np.concatenate([np.eye(3)[None], turns]))
    force = motion.to_inertial(rotation, flight.accel)
    velocity = np.concatenate([np.zeros((1, 3)), np.cumsum(h * (force[1:] + force[:-1]) / 2, axis=0)])
    steps = h * velocity[:-1] + h**2 * (2 * force[:-1] + force[1:]) / 6
    position = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    return CubicHermiteSpline(flight.time, position, velocity)


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
    """The record with added noise, STRONGER times its own, and an added gyro bias along a random axis."""
    gyro, accel, bias = noise
    rng = np.random.default_rng(seed)
    axis = rng.standard_normal(3)
    turned = gyro * rng.standard_normal(flight.gyro.shape) + bias * axis / np.linalg.norm(axis)
    shaken = accel * rng.standard_normal(flight.accel.shape)
    return replace(flight, gyro=flight.gyro + STRONGER * turned, accel=flight.accel + STRONGER * shaken)


def _worst(rank: Int[Array, "w"], scaled: Float[Array, "w 13"], sigma: Float[Array, "w"]) -> int:
    """The window of lowest rank, then of largest error, or of least singular value where no error is predicted."""
    error = np.where(np.isnan(sigma), 1 / np.maximum(scaled[:, -1], np.finfo(float).tiny), sigma)
    return int(np.lexsort((-error, rank))[0])


def _sigma(flight: Flight, curve: CubicHermiteSpline, start: float, window: float, range_sigma: float) -> float:
    """1-σ position (m) at the window's end. Each measured range d has the weight 1/(d²σ² + ½σ⁴)."""
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
    """First and last time of every run of consecutive windows in the mask."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], where.astype(int), [0]])))
    return [(float(time[a]), float(time[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _verdict(rank: int, sigma: float, requirement: float) -> WindowVerdict:
    """The verdict on one window; sigma (m) is NaN where none is predicted. A recorded path is never restricted."""
    if rank == model.STATES and np.isnan(sigma):
        return "rank 13"
    return verdict.judge(rank, sigma, requirement).word


def _angle_between(truth: Float[Array, "n 3 3"], estimate: Float[Array, "n 3 3"]) -> Float[Array, "n"]:
    """The angle (rad) of R R̂ᵀ; NaN at samples without a true attitude."""
    known = ~np.isnan(truth).any(axis=(1, 2))
    angle = np.full(len(truth), np.nan)
    angle[known] = so3.angle(truth[known] @ np.swapaxes(estimate[known], -1, -2))
    return angle
