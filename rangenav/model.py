"""The lifted 13-state model (paper, eq. 5–7): ẋ = 𝒜(ω, a) x + b, y = ½d² = x[0].

x = (ξ1, ξ2, ξ3, ξ4, p_B, v_B, g_B) with ξ1 = ½|p|², ξ2 = p·v, ξ3 = |v|² + p·g, ξ4 = 3 v·g, p relative to the anchor:

    ξ̇1 = ξ2,  ξ̇2 = ξ3 + a·p,  ξ̇3 = ξ4 + 2a·v,  ξ̇4 = 3a·g + 3|g|²,
    ṗ_B = −ω×p_B + v_B,  v̇_B = −ω×v_B + g_B + a,  ġ_B = −ω×g_B.

The printed paper has |g|² for 3|g|² (C_5 = 0): an observer built on it never converges, even from the truth.
"""

from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import so3
from rangenav.motion import Motion, World, to_body

STATES = 13
XI, POSITION, VELOCITY, GRAVITY = slice(0, 4), slice(4, 7), slice(7, 10), slice(10, 13)
NILPOTENCY = 5
"""𝒜⁵ = 0 without turning: the longest chain is g → v → p → ξ2 → ξ1."""
ModelForm = Literal["derived", "printed"]


def lift(
    position: Float[Array, "*n 3"], velocity: Float[Array, "*n 3"], gravity: Float[Array, "*n 3"]
) -> Float[Array, "*n 13"]:
    """The 13-state of a position (relative to the anchor), velocity and gravity in one common frame."""

    def dot(u: Array, w: Array) -> Array:
        return np.einsum("...i,...i->...", u, w)[..., None]  # a third of the time of np.sum over three columns

    xi = (dot(position, position) / 2, dot(position, velocity))
    xi += (dot(velocity, velocity) + dot(position, gravity), 3 * dot(velocity, gravity))
    return np.concatenate([*xi, position, velocity, gravity], axis=-1)


def true_state(motion: Motion, *, world: World) -> Float[Array, "n 13"]:
    """The true 13-state in body axes at each sample of a motion."""
    gravity = np.broadcast_to(np.asarray(world.gravity), motion.position.shape)
    inertial = (motion.position - np.asarray(world.anchor), motion.velocity, gravity)
    return lift(*(to_body(motion.rotation, vector) for vector in inertial))


def input_4(gravity_norm: float, form: ModelForm = "derived") -> float:
    """The constant input into ξ4 (m²/s⁴): 3|g|²; the printed B_m gives |g|² (see docs/departures.md)."""
    return (3.0 if form == "derived" else 1.0) * gravity_norm**2


def dynamics(
    gyro: Float[Array, "3"], accel: Float[Array, "3"], *, gravity_norm: float, form: ModelForm = "derived"
) -> tuple[Float[Array, "13 13"], Float[Array, "13"]]:
    """𝒜(ω, a) and the input b in body axes (paper, eq. 7)."""
    A, b = np.zeros((STATES, STATES)), np.zeros(STATES)
    A[0, 1] = A[1, 2] = A[2, 3] = 1.0
    A[1, POSITION], A[2, VELOCITY], A[3, GRAVITY] = accel, 2 * accel, 3 * accel
    A[POSITION, VELOCITY] = A[VELOCITY, GRAVITY] = np.eye(3)
    for block in (POSITION, VELOCITY, GRAVITY):
        A[block, block] = -so3.hat(gyro)
    b[3], b[VELOCITY] = input_4(gravity_norm, form), accel
    return A, b


def transition(
    accel: Float[Array, "3"], h: float, *, gravity_norm: float, form: ModelForm = "derived"
) -> tuple[Float[Array, "13 13"], Float[Array, "13"]]:
    """Φ(h) and ∫Φ b over one step with constant a and ω = 0: polynomials in h, because 𝒜 is nilpotent there."""
    A, b = dynamics(np.zeros(3), accel, gravity_norm=gravity_norm, form=form)
    phi, integral, power = np.zeros((STATES, STATES)), np.zeros(STATES), np.eye(STATES)
    for order in range(1, NILPOTENCY + 1):
        phi += power
        integral += power @ b * (h / order)
        power = power @ A * (h / order)
    return phi, integral
