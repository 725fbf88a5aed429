"""The observers on a recorded flight: their estimates, and their errors where the file has the true motion."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import cascade, model, so3
from rangenav.attitude import AttitudeGains
from rangenav.cascade import Estimate, ObserverConfig, Start
from rangenav.formats import recorded_flight
from rangenav.formats.recorded_flight import Flight
from rangenav.gains import Gains
from rangenav.inputs import require
from rangenav.motion import World
from rangenav.results import result
from rangenav.sensors import Noise, Sensors

GYRO_DENSITY, ACCEL_DENSITY = 3e-4, 9e-2
"""(rad/s)²/Hz and (m/s²)²/Hz that the observer assumes for a real IMU. They stand for the errors of scale, misalignment
and lever arm in fast motion; the noise itself is a thousand times smaller. The position error on trial 21 of the BROAD
data set (three anchors) is 0.75 m rms with them, and 5 m with the noise at rest."""
K1 = 1.0
"""1/s. With 4, the default of simulations, the attitude follows the errors of the gravity estimate: on the same trial
5.8° rms instead of 4.3°."""


@result
class Observed:
    """The observers' estimates on a record, with their errors where the file has the true motion."""

    estimate: Estimate
    world: World
    range_time: Float[Array, "m"]
    """s"""
    range: Float[Array, "m"]
    """m, the ranges that the observers used."""
    range_sigma: float
    """m, the noise of the ranges that the observers assume."""
    position: Float[Array, "n 3"]
    """m, inertial: the anchor plus R̂ p̂_B."""
    position_error: Float[Array, "n"] | None
    """m; NaN at samples without a true position, None if the file has none."""
    attitude_error: Float[Array, "n"] | None
    """rad, likewise."""


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
        range_time=flight.range_time,
        range=flight.range,
        range_sigma=sensors.sigma.range,
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


def _angle_between(truth: Float[Array, "n 3 3"], estimate: Float[Array, "n 3 3"]) -> Float[Array, "n"]:
    """The angle (rad) of R R̂ᵀ; NaN at samples without a true attitude."""
    known = ~np.isnan(truth).any(axis=(1, 2))
    angle = np.full(len(truth), np.nan)
    angle[known] = so3.angle(truth[known] @ np.swapaxes(estimate[known], -1, -2))
    return angle
