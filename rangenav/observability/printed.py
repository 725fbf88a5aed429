"""The paper's persistency of excitation as printed, compared with the derived condition.

derived   φ = ä + 2ω×ȧ + ω̇×a + ω×(ω×a) = Rᵀp⁗,   ∫(Rφ)(Rφ)ᵀ ≥ μ I₃   (inertial axes)
printed   φ = ä − ω×ȧ − 2ω×(ω×a),                  ∫φφᵀ ≥ μ I₃         (body axes)
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.model import STATES
from rangenav.motion import Motion, to_inertial
from rangenav.observability import excitation
from rangenav.results import result


@result
class PrintedAndDerived:
    """Both conditions on the same motion, at their worst windows."""

    phi: float
    """m/s⁴: RMS of the derived φ over the flight."""
    phi_printed: float
    least_formula: Float[Array, "w"]
    """m²/s⁷: the least eigenvalue over each window with the printed φ, in inertial axes."""
    least_axes: Float[Array, "w"]
    """With the derived φ, in body axes."""
    least_printed: Float[Array, "w"]
    """With both misprints, as the paper has it."""
    mu: float
    """m²/s⁷: the derived one of the worst window; 0 if it is rounding."""
    mu_printed: float
    """The least of `least_printed`."""
    false_certificate: bool
    """Whether the printed condition, and not the derived one, holds where the Gramian is singular."""
    summary: str


def compare(
    motion: Motion, start: Float[Array, "w"], window: float, *, mu: float, floor: float, required: float, rank: int
) -> PrintedAndDerived:
    """Compare on the windows that start at `start` (s); mu, its rounding floor and the rank are the derived ones."""

    def least(signal: Array) -> Array:
        return np.maximum(excitation.sampled_eigenvalues(signal, motion.time, start, window)[:, 0], 0.0)

    derived, printed = excitation.phi(motion), excitation.phi_printed(motion)
    mu, both = mu if mu > floor else 0.0, least(printed)
    mu_printed = float(both.min())
    return PrintedAndDerived(
        phi=_rms(derived),
        phi_printed=_rms(printed),
        least_formula=least(to_inertial(motion.rotation, printed)),
        least_axes=least(derived),
        least_printed=both,
        mu=mu,
        mu_printed=mu_printed,
        false_certificate=mu_printed >= required > mu and rank < STATES,
        summary=verdict(mu, mu_printed, required=required, rank=rank),
    )


def verdict(mu: float, printed: float, *, required: float, rank: int) -> str:
    """What the two conditions say of a motion whose worst window has this rank, in one sentence."""
    numbers = f"printed μ = {printed:.3g}, derived μ = {mu:.3g}, required {required:g} m²/s⁷"
    if printed >= required > mu and rank < STATES:
        return (
            f"False certificate: as printed, the condition holds for a motion of rank {rank} of {STATES} ({numbers})."
        )
    if printed >= required > mu:
        return f"As printed, the condition holds where the derived one does not ({numbers}); the rank is {rank}."
    if mu >= required > printed:
        return f"As printed, the condition refuses what the derived one accepts ({numbers}); the rank is {rank}."
    if mu >= required and rank < STATES:
        return f"Both conditions hold, yet the rank is {rank} of {STATES} ({numbers}): they need a longer window."
    return f"Both conditions {'hold' if mu >= required else 'fail'} ({numbers}); the rank is {rank} of {STATES}."


def _rms(signal: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(signal**2, axis=-1))))
