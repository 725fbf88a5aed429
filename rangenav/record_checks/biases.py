"""Constants that the gyro and the accelerometer read besides the motion, by the truth in the file.

gyro            log((R(t)ᵀ R(t + lag))ᵀ ΔR') = ∫ R(t + lag)ᵀ R(s) b ds        ΔR': the turn by the gyro alone
accelerometer   p(t + h) − 2 p(t) + p(t − h) = ∫ (h − |s|) (R (a − b) + g)(t + s) ds
Positions are not differentiated. A constant is asked about if it explains most of what is wrong: scale, axes, lever
arm and noise are no constants in body axes.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from scipy.interpolate import CubicSpline

from rangenav import motion, so3
from rangenav.formats.recorded_flight import Flight
from rangenav.imu_motion import twice
from rangenav.number_format import significant, vector
from rangenav.record_checks.blocks import blocks, rms
from rangenav.record_checks.check import Evidence
from rangenav.record_checks.truth import upwards
from rangenav.results import result

LAG = 0.5
"""s, over which the turns of gyro and truth are compared."""
HALF = 1.0
"""s, h: positions with an error of 5 cm leave 0.1 m/s² in each window."""
MOST = 400
"""Windows that are looked at."""
FEWEST = 10
"""Windows, without which nothing is told."""
GYRO, ACCEL = 0.05, 0.3
"""rad/s and m/s² beyond which a constant is asked about; good sensors of a drone have a tenth of it."""
SURE, LEFT = 5.0, 0.5
"""Standard deviations of a constant, and the largest share of what is wrong that it may leave."""


@result
class Bias:
    """A constant in body axes that explains what a sensor reads besides the motion."""

    value: Float[Array, "3"]
    before: float
    """rms of what is wrong, in the sensor's unit."""
    after: float
    """rms without the constant."""
    windows: float
    """Number of independent ones."""

    def clear(self, least: float) -> bool:
        """Whether it is large, sure, and explains most of what is wrong."""
        size = float(np.linalg.norm(self.value))
        sigma = self.after / max(self.windows, 1.0) ** 0.5
        return size > least and size > SURE * sigma and self.after < LEFT * self.before


def gyro_bias(flight: Flight) -> Bias | None:
    """The constant of the gyro by the file's attitude; None without one."""
    if flight.rotation is None:
        return None
    b = blocks(flight)
    step = float(np.median(np.diff(b.time)))
    n = max(1, round(LAG / step))
    if len(b.time) <= n:
        return None
    k = np.unique(np.linspace(0, len(b.time) - n - 1, MOST).astype(int))
    truth, sensed = flight.rotation[b.start], b.turned()
    known = np.isfinite(truth[k]).all(axis=(1, 2)) & np.isfinite(truth[k + n]).all(axis=(1, 2))
    k = k[known]
    if len(k) < FEWEST:
        return None
    turns = [np.swapaxes(one[k], -1, -2) @ one[k + n] for one in (truth, sensed)]
    wrong = so3.log(np.swapaxes(turns[0], -1, -2) @ turns[1]) / (b.time[k + n] - b.time[k])[:, None]
    back = np.swapaxes(sensed[k + n], -1, -2)
    design = (np.eye(3) + 4 * (back @ sensed[k + n // 2]) + back @ sensed[k]) / 6  # the mean over the lag, by Simpson
    return _fit(wrong, design, float(b.time[-1] - b.time[0]) / LAG)


def _fit(wrong: Float[Array, "w 3"], design: Float[Array, "w 3 3"], independent: float) -> Bias:
    """The constant that, turned by the design, leaves least of what is wrong."""
    rows, values = design.reshape(-1, 3), wrong.reshape(-1)
    value, *_ = np.linalg.lstsq(rows, values, rcond=1e-6)
    left = (values - rows @ value).reshape(-1, 3)
    return Bias(value=value, before=rms(wrong), after=rms(left), windows=min(len(wrong), independent))


def accel_bias(flight: Flight) -> Bias | None:
    """The constant of the accelerometer by the file's attitude and positions; None without them."""
    if flight.rotation is None or flight.position is None:
        return None
    known = np.asarray(np.isfinite(flight.rotation).all(axis=(1, 2)) & np.isfinite(flight.position).all(axis=-1))
    time, span = flight.time, float(flight.time[-1] - flight.time[0])
    if known.sum() < FEWEST or span < 4 * HALF:
        return None
    middle = np.linspace(time[0] + HALF, time[-1] - HALF, min(MOST, int(4 * span)))
    lost = np.concatenate([[0], np.cumsum(~known)])
    first, last = np.searchsorted(time, middle - HALF, side="right") - 1, np.searchsorted(time, middle + HALF)
    middle = middle[lost[np.minimum(last + 1, len(known))] == lost[np.maximum(first, 0)]]
    if len(middle) < FEWEST:
        return None
    rotation = np.where(known[:, None, None], flight.rotation, 0.0)
    force = np.concatenate([motion.to_inertial(rotation, flight.accel)[:, :, None], rotation], axis=-1)
    forces = _bent(twice(time, force.reshape(-1, 12)), middle).reshape(-1, 3, 4)
    moved = _bent(CubicSpline(time[known], flight.position[known]), middle)
    wrong = forces[:, :, 0] - upwards(flight) - moved
    return _fit(wrong, forces[:, :, 1:], span / (2 * HALF))


def _bent(curve: Callable[[Array], Array], middle: Float[Array, "w"]) -> Array:
    """The second difference of a curve over HALF, divided by its square: a weighted mean of its second derivative."""
    return (curve(middle + HALF) - 2 * curve(middle) + curve(middle - HALF)) / HALF**2


def gyro_offset(flight: Flight) -> Evidence | None:
    """A constant that the gyro reads besides the turns of the file's attitude."""
    bias = gyro_bias(flight)
    if bias is None or not bias.clear(GYRO):
        return None
    text = (
        f"the gyro reads a constant of {vector(bias.value)} rad/s besides the turns of the file's attitude: it is off "
        f"by {significant(bias.before)} rad/s rms, and by {significant(bias.after)} without the constant"
    )
    return Evidence(text=text, suggestion=_typed(bias.value))


def accel_offset(flight: Flight) -> Evidence | None:
    """A constant that the accelerometer reads besides the acceleration of the file's positions, and gravity."""
    bias = accel_bias(flight)
    if bias is None or not bias.clear(ACCEL):
        return None
    text = (
        f"the accelerometer reads a constant of {vector(bias.value)} m/s² besides gravity and the acceleration of the "
        f"file's positions: it is off by {significant(bias.before)} m/s² rms, and by {significant(bias.after)} without "
        "the constant"
    )
    return Evidence(text=text, suggestion=_typed(bias.value))


def _typed(value: Float[Array, "3"]) -> str:
    return " ".join(f"{one:.4f}" for one in value.round(4) + 0.0)
