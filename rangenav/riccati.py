"""The Riccati observer (paper, eq. 8): ẋ̂ = 𝒜x̂ + b + K(y − 𝒞x̂), K = P𝒞ᵀQ, Ṗ = 𝒜P + P𝒜ᵀ − P𝒞ᵀQ𝒞P + V.

Here Q is the inverse density of the measurement noise, V the density of the process noise. The functions below are the
reference implementation, which is meant to be read and tests the compiled one in `kernels`. Both split each step: the
correction is a rank-one update in closed form, the prediction an exact polynomial in the step. An explicit Runge–Kutta
method on the Riccati equation diverges for ordinary gains (q = 100, p0 = 100 at 1 kHz).
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model, so3
from rangenav.inputs import Input, require_within
from rangenav.kernels.layout import CONSISTENCY_TIME, ROUNDING

Q_RANGE = (1e-3, 1e5)
V_RANGE = (1e-6, 1e2)
P0_RANGE = (1e-3, 1e4)
"""The ranges of the gains. In them P stays positive definite over 10⁶ steps; v = 0 lies outside."""


class Blocks(Input, frozen=True, kw_only=True):
    """One number for each block of the state: ξ, position, velocity, gravity."""

    xi: float
    """The number for ξ1 = ½|p|², ξ2 = p·v, ξ3 = |v|² + p·g, ξ4 = 3 v·g."""
    position: float
    velocity: float
    gravity: float

    def diagonal(self) -> Float[Array, "13"]:
        """The 13 diagonal entries: ξ four times, each of the others three times."""
        return np.repeat([self.xi, self.position, self.velocity, self.gravity], [4, 3, 3, 3])


class RiccatiGains(Input, frozen=True, kw_only=True):
    """q (inverse range-noise density), v (process noise density) and p0 (initial covariance) of the Riccati observer.

    The paper states no gains. The defaults come from a search on the paper's path (200 Hz) and on its slowed form (50
    and 200 Hz) with the default noise. The steady position error is 0.035 m on the paper's path, 0.13 m and 0.085 m on
    the slowed form, and without noise 1 mm at 10 s.
    """

    q: float = 5e3
    """1/(m⁴ s): a measurement of y = ½d² has the variance 1/(q T), T the interval between ranges."""
    v: Blocks = Blocks(xi=1e-3, position=1e-5, velocity=1e-5, gravity=1e-4)
    """In the square of each block's unit, per second."""
    p0: Blocks = Blocks(xi=1e4, position=100.0, velocity=100.0, gravity=100.0)
    """In the square of each block's unit."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("q", self.q, *Q_RANGE)
        for name, limits in (("v", V_RANGE), ("p0", P0_RANGE)):
            blocks = getattr(self, name)
            for block in blocks.__struct_fields__:
                require_within(f"{name}.{block}", getattr(blocks, block), *limits)


def predict(
    x: Float[Array, "13"],
    P: Float[Array, "13 13"],
    gyro: Float[Array, "3"],
    accel: Float[Array, "3"],
    h: float,
    *,
    gravity_norm: float,
    form: model.ModelForm = "derived",
) -> tuple[Float[Array, "13"], Float[Array, "13 13"]]:
    """State and covariance (body axes) h seconds later by the exact transition; the caller adds the process noise.

    gyro is the mean angular velocity over the step (rad/s). accel is the mean apparent acceleration over the step
    (m/s²), in the body axes at the start of the step.
    """
    phi, integral = model.transition(accel, h, gravity_norm=gravity_norm, form=form)
    turn = np.eye(model.STATES)
    for block in (model.POSITION, model.VELOCITY, model.GRAVITY):
        turn[block, block] = so3.exp(gyro * h).T
    transition = turn @ phi
    P = transition @ P @ transition.T
    return turn @ (phi @ x + integral), (P + P.T) / 2 + ROUNDING * np.diag(np.diag(P))


def correct(
    x: Float[Array, "13"], P: Float[Array, "13 13"], y: float, variance: float
) -> tuple[Float[Array, "13"], Float[Array, "13 13"]]:
    """State and covariance after a measurement of y = ½d² with a variance (m⁴): a rank-one update."""
    gain = P[:, 0] / (P[0, 0] + variance)
    return x + gain * (y - x[0]), P - np.outer(gain, P[0])


def remind(
    x: Float[Array, "13"], P: Float[Array, "13 13"], h: float
) -> tuple[Float[Array, "13"], Float[Array, "13 13"]]:
    """State and covariance after a correction with the constraint ξ1 = ½|p|², where it is applied every h seconds.

    Only noise-matched gains use it; see CONSISTENCY_TIME.
    """
    position, spread = x[model.POSITION], float(np.trace(P[model.POSITION, model.POSITION]))
    row = np.zeros(model.STATES)
    row[0], row[model.POSITION] = 1.0, -position
    variance = spread**2 / 2 * (CONSISTENCY_TIME / h)
    gain = P @ row / (row @ P @ row + variance)
    residual = (position @ position + spread) / 2 - x[0]
    return x + gain * residual, P - np.outer(gain, row @ P)
