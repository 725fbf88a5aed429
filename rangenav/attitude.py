"""The complementary filter on SO(3) (paper, eq. 9): Ṙ̂ = R̂ [ω_y + k1 σ]x.

    σ = ρ1 (m_y × R̂ᵀm) + ρ2 (ĝ_B × R̂ᵀg)
R̃ = R R̂ᵀ decays near identity with the eigenvalues of k1 (tr(M) I − M), M = ρ1 mmᵀ + ρ2 ggᵀ (the printed error equation
has half that rate). Its other equilibria are R̃ = 2uuᵀ − I, u an eigenvector of M (printed as I − 2uuᵀ, no rotation).
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import so3
from rangenav.inputs import Input, require_within
from rangenav.model import Form
from rangenav.motion import World

K1_RANGE = (1e-3, 1e3)
RHO_RANGE = (1e-6, 1e3)


class AttitudeGains(Input, frozen=True, kw_only=True):
    """k1 scales the whole correction; rho1 weighs the magnetometer, rho2 the estimated gravity."""

    k1: float = 4.0
    """1/s for unit vectors."""
    rho1: float = 1.0
    rho2: float = 0.01
    """Multiplies |g|² ≈ 96: about 1/|g|² weighs gravity like the unit magnetic vector; 1 is stiff at low rates."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("k1", self.k1, *K1_RANGE)
        require_within("rho1", self.rho1, *RHO_RANGE)
        require_within("rho2", self.rho2, *RHO_RANGE)


def correction(
    rotation: Float[Array, "3 3"],
    mag: Float[Array, "3"],
    gravity_body: Float[Array, "3"],
    *,
    gains: AttitudeGains,
    world: World,
) -> Float[Array, "3"]:
    """k1 σ (rad/s, body axes)."""
    sigma = gains.rho1 * np.cross(mag, rotation.T @ np.asarray(world.magnetic))
    return gains.k1 * (sigma + gains.rho2 * np.cross(gravity_body, rotation.T @ np.asarray(world.gravity)))


def step(
    rotation: Float[Array, "3 3"],
    gyro: tuple[Array, Array],
    mag: tuple[Array, Array],
    gravity_body: tuple[Array, Array],
    h: float,
    *,
    gains: AttitudeGains,
    world: World,
) -> Float[Array, "3 3"]:
    """R̂ h seconds later from the signals at both ends of the step: Heun's method on the group, order 2."""
    start = gyro[0] + correction(rotation, mag[0], gravity_body[0], gains=gains, world=world)
    trial = rotation @ so3.exp(h * start)
    end = gyro[1] + correction(trial, mag[1], gravity_body[1], gains=gains, world=world)
    return rotation @ so3.exp(h / 2 * (start + end))


def decay_matrix(gains: AttitudeGains, world: World) -> Float[Array, "3 3"]:
    """M = ρ1 mmᵀ + ρ2 ggᵀ; its eigenvectors are the axes of the undesired equilibria."""
    m, g = np.asarray(world.magnetic), np.asarray(world.gravity)
    return gains.rho1 * np.outer(m, m) + gains.rho2 * np.outer(g, g)


def time_constants(gains: AttitudeGains, world: World, form: Form = "derived") -> Float[Array, "3"]:
    """The three time constants (s) of a small attitude error, slowest first; printed ones are twice as long."""
    M = decay_matrix(gains, world)
    rates = gains.k1 * np.linalg.eigvalsh(np.trace(M) * np.eye(3) - M)
    return (1.0 if form == "derived" else 2.0) / rates


def equilibria(gains: AttitudeGains, world: World, form: Form = "derived") -> Float[Array, "3 3 3"]:
    """The undesired equilibria R̃ = 2uuᵀ − I, u the eigenvectors of M. The printed I − 2uuᵀ have determinant −1."""
    _, axes = np.linalg.eigh(decay_matrix(gains, world))
    turns = 2 * np.einsum("ik,jk->kij", axes, axes) - np.eye(3)
    return turns if form == "derived" else -turns
