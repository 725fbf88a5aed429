"""The motion that the IMU alone tells: its acceleration, twice integrated in axes turned by the gyro.

    Ẍ = a_I,  D(s, t) = X(s) − X(t) − (s − t) Ẋ(t),  ½d²(s) = ½|D|² + 𝒞Φ(s, t) x(t)
In these axes gravity, the place and the velocity at a time t are unknown and constant, so a range is linear in them.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from scipy.interpolate import CubicHermiteSpline

from rangenav import motion, so3
from rangenav.formats.recorded_flight import Flight


def twice_integrated(flight: Flight) -> CubicHermiteSpline:
    """X with Ẍ = a_I in axes turned by the gyro alone, by the trapezoidal rule; stamps may be uneven."""
    h = np.diff(flight.time)[:, None]
    turns = so3.exp(h * (flight.gyro[1:] + flight.gyro[:-1]) / 2)
    rotation = motion.cumulative_product(np.concatenate([np.eye(3)[None], turns]))
    return twice(flight.time, motion.to_inertial(rotation, flight.accel))


def twice(time: Float[Array, "n"], values: Float[Array, "n k"]) -> CubicHermiteSpline:
    """The second integral of values that are linear between the stamps; it begins with zero, and so does its rate."""
    h = np.diff(time)[:, None]
    none = np.zeros((1, values.shape[1]))
    velocity = np.concatenate([none, np.cumsum(h * (values[1:] + values[:-1]) / 2, axis=0)])
    steps = h * velocity[:-1] + h**2 * (2 * values[:-1] + values[1:]) / 6
    return CubicHermiteSpline(time, np.concatenate([none, np.cumsum(steps, axis=0)]), velocity)


def displacement(
    curve: CubicHermiteSpline, reference: Float[Array, "w"], tau: Float[Array, "k"]
) -> Float[Array, "w k 3"]:
    """D at the times reference + τ, from each reference time; τ may be negative."""
    s = tau[:, None]
    return curve(reference[:, None] + tau) - curve(reference)[:, None] - s * curve(reference, 1)[:, None]


def lifted_rows(
    curve: CubicHermiteSpline, reference: Float[Array, "w"], tau: Float[Array, "k"]
) -> Float[Array, "w k 13"]:
    """𝒞Φ = [1, τ, τ²/2, τ³/6, Dᵀ, τDᵀ, ½τ²Dᵀ] at each reference time; τ may be negative."""
    s, D = tau[:, None], displacement(curve, reference, tau)
    powers = np.broadcast_to(np.stack([tau**0, tau, tau**2 / 2, tau**3 / 6], axis=-1), (len(reference), len(tau), 4))
    return np.concatenate([powers, D, s * D, s**2 / 2 * D], axis=-1)
