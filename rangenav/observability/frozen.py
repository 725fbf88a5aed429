"""The frozen-time test, and why it misleads: the rank of (𝒜(t₀), 𝒞) as if ω and a were constant (python-control).

The ranks, of 13, are: in body axes 11, 10 if a ⟂ ω, 5 if a ∥ ω or ω = 0, 4 if a = 0; in axes turned by the gyro, where
ω does not appear, 5, and 4 if a = 0. The rank is never 13, because only variation makes the pair observable. Nor is it
the rank of the window. A body that hovers and turns has rank 5 on a window and the frozen rank 11: in the frozen pair a
force that is constant in body axes turns for ever.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model
from rangenav.arguments import finite_array
from rangenav.motion import Motion, to_inertial
from rangenav.results import result

RANK_TOLERANCE = 1e-9
"""Relative to the first singular value of the observability matrix, in units of the motion. The last one that counts is
above 1e-5 if the angle between ω and a is more than 0.1° from 0° and 90°."""
SLOWEST, WEAKEST = 1e-9, 1e-9
"""rad/s and m/s²: a smaller angular velocity or specific force counts as zero."""


@result
class Frozen:
    """Ranks at one moment."""

    time: float
    body: int
    """Of 13, in body axes."""
    turned: int
    """Of 13, in axes turned by the gyro, fixed in inertia."""
    summary: str
    """Both ranks, the rank of the window, and why the frozen ones mislead."""


def rank(gyro: Float[Array, "3"], accel: Float[Array, "3"]) -> int:
    """The rank (of 13) of python-control's observability matrix of the frozen pair.

    In units of time 1/|ω| and length |a|/|ω|², so that the powers of 𝒜 neither overflow nor fade.
    """
    import control

    gyro, accel = finite_array("gyro", gyro, (3,)), finite_array("accel", accel, (3,))
    turning, force = float(np.linalg.norm(gyro)), float(np.linalg.norm(accel))
    gyro = gyro / turning if turning > SLOWEST else np.zeros(3)
    accel = accel / force if force > WEAKEST else np.zeros(3)
    A, _ = model.dynamics(gyro, accel, gravity_norm=0.0)  # gravity is an input there, not a part of 𝒜
    output = np.eye(1, model.STATES)
    frozen = control.ss(A, np.zeros((model.STATES, 1)), output, 0)
    assert isinstance(frozen, control.StateSpace)
    singular = np.linalg.svd(control.obsv(frozen.A, frozen.C), compute_uv=False)
    return int(np.sum(singular > RANK_TOLERANCE * singular[0]))


def frozen(motion: Motion, time: float, *, windowed: int) -> Frozen:
    """The frozen ranks at the sample nearest to a time (s), and the rank of the window that starts there."""
    k = int(np.argmin(np.abs(motion.time - time)))
    gyro, accel = motion.angular_velocity[k], motion.apparent_acceleration[k]
    body, at = rank(gyro, accel), float(motion.time[k])
    turned = rank(np.zeros(3), to_inertial(motion.rotation[k], accel))
    return Frozen(time=at, body=body, turned=turned, summary=_summary(at, body, turned, windowed))


def _summary(time: float, body: int, turned: int, windowed: int) -> str:
    ranks = f"Frozen at {time:.3g} s: rank {body} of {model.STATES} in body axes, {turned} in turned axes"
    if windowed == model.STATES:
        return (
            f"{ranks}, so the frozen test calls the motion unobservable. The window from there has rank {windowed}, "
            "because ω and a change in it: the frozen test takes them for constants."
        )
    if body > windowed:
        return (
            f"{ranks}. The window from there has rank {windowed} alone: the frozen test lets a force that is constant "
            "in body axes turn for ever with a constant ω, and the true force does not turn like that."
        )
    return (
        f"{ranks}. The window from there has rank {windowed}. They need not agree: the frozen test takes ω and a for "
        "constants, and knows nothing of their change."
    )
