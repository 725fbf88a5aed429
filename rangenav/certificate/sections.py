"""The sections of a certificate on observability: excitation, rank and accuracy, each with its scope."""

import math

import msgspec
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import verdict
from rangenav.certificate import schema
from rangenav.certificate.schema import Claim, Scope, figure, known
from rangenav.inputs import Vec3
from rangenav.model import STATES
from rangenav.motion_analysis import farthest_from_anchor
from rangenav.observability import accuracy
from rangenav.observability.worst_excitation import WorstExcitation
from rangenav.preset import Preset
from rangenav.proof import Proof
from rangenav.sensors import noise_assumption


def claim_section(preset: Preset, worst: WorstExcitation) -> Claim:
    """The windows for which the excitation is bounded or sampled."""
    return Claim(
        starts=worst.starts,
        window=preset.requirement.window,
        duration=preset.duration,
        period=None if preset.path.period is None else figure(preset.path.period),
        reason=msgspec.UNSET if worst.reason is None else f"not every t: {worst.reason}",
    )


def excitation_section(worst: WorstExcitation, required: float) -> schema.Excitation:
    """μ and its bounds; null bounds where it is sampled."""
    bounds, blind = worst.bounds, worst.mu <= worst.floor
    sampled = [] if bounds is not None else [f"lower, upper: null, sampled only, as {worst.reason}"]
    reasons = [*sampled, *(["found: null, below the floor of rounding"] if blind else [])]
    return schema.Excitation(
        required=required,
        lower=None if bounds is None else figure(bounds.lower, toward=-1),
        upper=None if bounds is None else figure(bounds.upper, toward=1),
        upper_everywhere=None if bounds is None else figure(bounds.upper_everywhere, toward=1),
        found=None if blind else figure(worst.mu),
        floor=figure(worst.floor, toward=1),
        at=figure(worst.at),
        direction=vec(worst.direction),
        starts=worst.count,
        scope=_scope(worst.proven(required), worst.starts, worst.reason),
        reason="; ".join(reasons) or msgspec.UNSET,
    )


def rank_section(proof: Proof) -> schema.Rank:
    """The least ranks, and a bound of the thirteenth singular value where one is known."""
    worst, full = proof.rank, proof.rank.rank == STATES
    bound = None if worst.proof is None else worst.proof.smallest_singular
    reasons = [] if full else ["smallest_singular: null, below the tolerance"]
    reasons += ["smallest_bound: null, not bounded"] if bound is None else []
    return schema.Rank(
        rank=worst.rank,
        of=STATES,
        tolerance=figure(worst.tolerance),
        rounded=True if worst.rounded else msgspec.UNSET,
        smallest_singular=figure(worst.smallest) if full else None,
        smallest_bound=None if bound is None else figure(bound, toward=-1),
        at=figure(worst.at),
        nonlinear=worst.nonlinear,
        windows=worst.count,
        blind=tuple(direction.summary for direction in worst.directions),
        scope=_scope(proof.rank_proven, worst.starts, worst.reason),
        reason="; ".join(reasons) or msgspec.UNSET,
    )


def accuracy_section(preset: Preset, proof: Proof) -> schema.Accuracy:
    """Predicted σ on the window of the flight that is worst for the lifted position at its end, and its bound."""
    worst, windows, sensors, rounded = proof.accuracy, proof.accuracy.windows, preset.sensors, proof.rounded
    bounded = math.isfinite(windows.bound)
    at_this = " at this precision" if rounded else ""
    return schema.Accuracy(
        required=preset.requirement.position_sigma,
        at=figure(windows.at),
        ranges=windows.ranges,
        bound=figure(windows.bound, toward=1) if bounded else None,
        rounded=True if proof.undetermined == "rounding" else msgspec.UNSET,
        scope=_scope(proof.accuracy_proven, worst.starts, worst.reason),
        range_sigma=sensors.sigma.range,
        range_rate=sensors.range_rate,
        noise=noise_assumption(sensors),
        sphere=figure(verdict.sphere(farthest_from_anchor(preset.path, preset.world, preset.duration))),
        reason=msgspec.UNSET if bounded else f"bound: null, the worst window does not determine the position{at_this}",
        lifted=schema.Ends(
            start=sigma(worst.lifted_start, rounded=rounded), end=sigma(worst.lifted_end, rounded=rounded)
        ),
        nonlinear=schema.Ends(start=sigma(worst.nonlinear_start), end=sigma(worst.nonlinear_end)),
    )


def _scope(proven: bool, starts: schema.Starts, reason: str | None) -> Scope:
    said = msgspec.UNSET if reason is None else f"not every t: {reason}"
    return Scope(basis="proven" if proven else "sampled", starts=starts, reason=said)


def sigma(predicted: accuracy.Accuracy, *, rounded: bool = False) -> schema.Sigma:
    """One accuracy with its reason where it is not determined."""
    position, velocity, gravity = known(predicted.position), known(predicted.velocity), known(predicted.gravity)
    blind = None in (position, velocity, gravity)
    return schema.Sigma(
        position=position,
        velocity=velocity,
        gravity=gravity,
        reason=verdict.undetermined(rounded) if blind else msgspec.UNSET,
    )


def vec(vector: Float[Array, "3"]) -> Vec3:
    """A unit vector in eight digits; what is rounding is 0."""
    x, y, z = (figure(float(value)) if abs(value) > 1e-9 else 0.0 for value in vector)
    return (x, y, z)
