"""The sections of a certificate on observability: excitation, rank and accuracy."""

from typing import Literal

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.certificate import schema
from rangenav.certificate.schema import Claim, figure, known
from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.observability import accuracy, blindness, derivative_bounds, excitation, spectrum
from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.observability.excitation_bound import TIE, ExcitationBounds, excitation_bounds, oriented
from rangenav.preset import Preset
from rangenav.sensors import noise_assumption

WINDOWS = 201
"""Start times at which ranks and accuracy are sampled; added are those at which a knot enters or leaves the window."""
MAX_EVENTS = 100
Starts = Literal["every t >= 0", "every t in [0, duration - window]"]
EVERY: Starts = "every t >= 0"
FLIGHT: Starts = "every t in [0, duration - window]"
SIGMA_TIE = 1e-3
"""Predicted errors that differ by less than this share are equally bad: they come from an integral over the ranges."""


def excitation_section(preset: Preset) -> tuple[Claim, schema.Excitation]:
    """Bounds of μ over every window at any t ≥ 0 if the path is periodic, else over every window of the flight."""
    period, why, needed = preset.path.period, "the path does not repeat", preset.requirement.mu
    of_period: ExcitationBounds | None = None
    if period is not None:
        try:
            end = period or _last(preset)  # a period of 0: a straight path, whose windows are all alike
            of_period = excitation_bounds(preset.path, preset.requirement.window, end)
            if of_period.lower >= needed or of_period.least < needed:
                return _bounded(preset, of_period, EVERY, None)
            why = f"over the period of {period:.4g} s no less than {of_period.lower:.4g} m²/s⁷ can be shown"
        except UnboundedDerivativeError as error:
            why = str(error)
    try:
        of_flight = excitation_bounds(preset.path, preset.requirement.window, _last(preset))
    except UnboundedDerivativeError as error:
        return _sampled(preset, str(error))
    if of_period is not None and of_flight.lower < needed:
        return _bounded(preset, of_period, EVERY, None)
    return _bounded(preset, of_flight, FLIGHT, why)


def _last(preset: Preset) -> float:
    """The last start of a window within the flight (s)."""
    return preset.duration - preset.requirement.window


def _claim(preset: Preset, starts: Starts, why: str | None) -> Claim:
    return Claim(
        starts=starts,
        window=preset.requirement.window,
        duration=preset.duration,
        period=None if preset.path.period is None else figure(preset.path.period),
        reason=msgspec.UNSET if why is None else f"not every t: {why}",
    )


def _bounded(
    preset: Preset, bounds: ExcitationBounds, starts: Starts, why: str | None
) -> tuple[Claim, schema.Excitation]:
    blind = bounds.least <= bounds.floor
    part = schema.Excitation(
        required=preset.requirement.mu,
        lower=figure(bounds.lower, toward=-1),
        upper=figure(bounds.upper, toward=1),
        upper_everywhere=figure(bounds.upper_everywhere, toward=1),
        found=None if blind else figure(bounds.least),
        floor=figure(bounds.floor, toward=1),
        at=figure(bounds.at),
        direction=_vec(bounds.direction),
        starts=bounds.starts,
        reason="found: null, below the floor of rounding" if blind else msgspec.UNSET,
    )
    return _claim(preset, starts, why), part


def _sampled(preset: Preset, why: str) -> tuple[Claim, schema.Excitation]:
    """The section without a bound: μ on sampled windows, and the reason why there is no bound."""
    path, window = preset.path, preset.requirement.window
    start = _starts(preset, _last(preset))
    every = excitation.eigenvalues(path, start, window)[:, 0]
    k = int(np.argmin(every))
    mu, at = float(every[k]), float(start[k])
    values, axes = excitation.directions(path, at, window)
    floor = excitation.floor(values[None])
    part = schema.Excitation(
        required=preset.requirement.mu,
        lower=None,
        upper=None,
        upper_everywhere=None,
        found=figure(mu) if mu > floor else None,
        floor=figure(floor, toward=1),
        at=figure(at),
        direction=_vec(oriented(axes[:, 0])),
        starts=len(start),
        reason=f"lower, upper: null, sampled only, as {why}" + ("" if mu > floor else "; found: null, below the floor"),
    )
    return _claim(preset, FLIGHT, why), part


def _starts(preset: Preset, end: float) -> Float[Array, "w"]:
    """Start times in [0, end]: evenly spaced ones, and those at which a knot enters or leaves the window."""
    window = preset.requirement.window
    try:
        edges = derivative_bounds.knots_until(preset.path, end + window)
    except UnboundedDerivativeError:
        edges = np.zeros(0)
    edges = edges[:: 1 + 2 * len(edges) // MAX_EVENTS]
    events = np.concatenate([edges, edges - window])
    return np.union1d(np.linspace(0, end, WINDOWS), events[(events > 0) & (events < end)])


def rank_section(preset: Preset, claim: Claim) -> schema.Rank:
    """The least ranks of the lifted and of the nonlinear Gramian over sampled windows, and the blind directions."""
    path, window, world = preset.path, preset.requirement.window, preset.world
    period = preset.path.period if claim.starts == EVERY else None
    start = _starts(preset, period or _last(preset))
    lifted = spectrum.window_spectra(path, world.gravity, start, window)
    local = spectrum.nonlinear_spectra(path, world.anchor, start, window)
    rank = int(lifted.rank.min())
    least = np.where(lifted.rank == rank, lifted.scaled[:, STATES - 1] if rank == STATES else 0.0, np.inf)
    k = _first_near(least, float(least.min()), TIE)
    values, axes = excitation.directions(path, float(start[k]), window)
    blind = blindness.directions(spectrum.null_basis(lifted, k), values, axes) if rank < STATES else ()
    return schema.Rank(
        rank=rank,
        of=STATES,
        tolerance=figure(float(lifted.tolerance[k] / lifted.scaled[k, 0])),
        smallest_singular=figure(float(lifted.scaled[k, -1])) if rank == STATES else None,
        at=figure(float(start[k])),
        nonlinear=int(local.rank.min()),
        windows=len(start),
        blind=tuple(direction.summary for direction in blind),
        reason=msgspec.UNSET if rank == STATES else "smallest_singular: null, below the tolerance",
    )


def accuracy_section(preset: Preset) -> schema.Accuracy:
    """Predicted σ on the sampled window of the flight that is worst for the lifted position at its end."""
    path, window, world, sensors = preset.path, preset.requirement.window, preset.world, preset.sensors
    sigma, rate, share = sensors.sigma.range, sensors.range_rate, sensors.arriving
    start = _starts(preset, _last(preset))
    curve = accuracy.end_sigmas(path, world, start, window, sigma=sigma, rate=rate, kind="lifted", share=share)[:, 0]
    curve = np.nan_to_num(curve, nan=np.inf)
    worst = float(curve.max())
    k = int(np.argmax(curve >= worst * (1 - SIGMA_TIE)))
    at = float(start[k])

    def ends(kind: accuracy.Problem) -> schema.Ends:
        both = [
            accuracy.predict(path, world, at, window, sigma=sigma, rate=rate, kind=kind, at=end, share=share)
            for end in ("start", "end")
        ]
        return schema.Ends(start=_sigma(both[0]), end=_sigma(both[1]))

    return schema.Accuracy(
        required=preset.requirement.position_sigma,
        at=figure(at),
        range_sigma=sigma,
        range_rate=rate,
        noise=noise_assumption(sensors),
        lifted=ends("lifted"),
        nonlinear=ends("nonlinear"),
    )


def _sigma(predicted: accuracy.Accuracy) -> schema.Sigma:
    position, velocity, gravity = known(predicted.position), known(predicted.velocity), known(predicted.gravity)
    blind = None in (position, velocity, gravity)
    return schema.Sigma(
        position=position,
        velocity=velocity,
        gravity=gravity,
        reason="null: blind, this window does not determine it" if blind else msgspec.UNSET,
    )


def _first_near(values: Float[Array, "n"], target: float, share: float) -> int:
    """Index of the first value within a share of the target, so that rounding does not choose among equal ones."""
    return int(np.argmax(values <= target + share * abs(target)))


def _vec(vector: Float[Array, "3"]) -> Vec3:
    x, y, z = (figure(float(value)) if abs(value) > 1e-9 else 0.0 for value in vector)
    return (x, y, z)
