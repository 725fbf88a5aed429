"""The gains in physical units: noise, prior and time constants in place of the paper's q, v, p0, k1, ρ1, ρ2.

At a typical distance d from the anchor and speed s, with range rate f_d, IMU rate f and g, m from the world:
    q    = f_d / (d²σ² + ½σ⁴)                           range noise σ: the variance of y = ½d²
    v_ξ  = σ_a² (d² + 4s² + 9|g|²) / 4f                  accel noise σ_a in ξ2, ξ3, ξ4; the mean over ξ1…ξ4
    v_v  = velocity_factor (σ_a² + ⅔ s² σ_ω²) / f        accel noise, and gyro noise η, of size σ_ω, as v × η
    v_p, v_g = position_factor ⅔ d² σ_ω² / f,  ⅔ |g|² σ_ω² / f       gyro noise as p × η and g × η
    p0   = b²/3 of a box of half-width b;  p0_ξ = xi_factor × the mean variance of ξ1…ξ4 in the boxes
    1/T  = k1 ρ1 |m|² 2w sin²θ / (1 + w + √((1−w)² + 4w cos²θ)),  w = ρ2|g|²/(ρ1|m|²),  θ between m and g

Twelve physical numbers replace twelve gains. A gain without a physical quantity of its own becomes a factor, which is 1
for the value that follows from the noise; so paper → physical → paper changes nothing. The second time constant is no
input: it follows from the first one and w. If both were inputs, k1ρ1 and k1ρ2 would be the roots of a quadratic, which
loses half of its digits where they are equal.
"""

import math
from collections.abc import Iterable
from typing import Literal, TypeVar

import msgspec
import numpy as np
from msgspec.structs import asdict

from rangenav.attitude import K1_RANGE, RHO_RANGE, AttitudeGains, Schedule
from rangenav.gains import Gains
from rangenav.inputs import Input, require, require_within
from rangenav.motion import World
from rangenav.riccati import P0_RANGE, Q_RANGE, V_RANGE, Blocks, RiccatiGains
from rangenav.sensors import Sensors
from rangenav.signals import Signal

NEAREST = 0.1
"""m; the least typical distance from the anchor: the variance of y = ½d² vanishes with the distance."""
MOMENTS = 500
"""Points of a path over which distance and speed are averaged."""
ROUNDING = 1e-12
"""A gain outside its range by at most this share, the rounding of a conversion, becomes the end of the range."""
SIZES = (1e-30, 1e30)
"""Limits of every physical quantity. Valid gains lie far inside, and no fourth power of a quantity overflows."""
T = TypeVar("T")


class Typical(Input, frozen=True, kw_only=True):
    """The state at which noise is converted to gains. In noise-matched mode the observer converts at its estimate."""

    distance: float
    """m, from the anchor."""
    speed: float
    """m/s"""

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("distance", self.distance, 1e-3, 1e5, "m")
        require_within("speed", self.speed, 0.0, 1e4, "m/s")


class PhysicalGains(Input, frozen=True, kw_only=True):
    """The gains of the cascade in physical units; noise is the standard deviation of one sample, as in `Noise`."""

    mode: Literal["constant", "noise-matched"] = "constant"
    range_sigma: float
    """m"""
    accel_sigma: float
    """m/s²"""
    gyro_sigma: float
    """rad/s"""
    position_factor: float
    """The process noise of the position, divided by the part that follows from the gyro's noise."""
    velocity_factor: float
    """The process noise of the velocity, divided by the part that follows from the noise of gyro and accelerometer."""
    position_box: float
    """m; half-width b: on each axis the truth is assumed uniform within ± b of the guess."""
    velocity_box: float
    """m/s"""
    gravity_box: float
    """m/s²"""
    xi_factor: float
    """The initial variance of ξ, divided by the variance that follows from the three boxes."""
    attitude_time: float
    """s, the slowest time constant of a small attitude error; with a schedule, at the upper end of k1."""
    gravity_weight: float
    """ρ2|g|²/(ρ1|m|²): the weight of the direction of gravity relative to that of the magnetic field."""
    rho1: float
    """The same number as the paper's ρ1: only the products k1ρ1 and k1ρ2 act on the estimate."""
    schedule: Schedule | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, value in asdict(self).items():
            if isinstance(value, float):
                require(value > 0, f"{name} must be positive, got {value:g}")
                require_within(name, value, *SIZES)


def typical(path: Signal, world: World, duration: float) -> Typical:
    """Root mean squares of distance (at least 0.1 m) and speed over a path."""
    time = np.linspace(0, duration, MOMENTS)
    distance, speed = (
        float(np.sqrt(np.mean(np.sum(vectors**2, axis=-1))))
        for vectors in (path(time) - np.asarray(world.anchor), path(time, 1))
    )
    return Typical(distance=max(distance, NEAREST), speed=speed)


def to_physical(gains: Gains, at: Typical, *, world: World, sensors: Sensors) -> PhysicalGains:
    """The paper's gains in physical units."""
    riccati, attitude = gains.riccati, gains.attitude
    v, p0 = riccati.v, riccati.p0
    accel2 = v.xi / _accel_into_xi(at, world)
    gyro2 = v.gravity / _gyro_into(_length(world.gravity))
    boxes = [math.sqrt(3 * variance) for variance in (p0.position, p0.velocity, p0.gravity)]
    weight = attitude.rho2 * _length(world.gravity) ** 2 / (attitude.rho1 * _length(world.magnetic) ** 2)
    return PhysicalGains(
        mode=gains.mode,
        range_sigma=_range_sigma(sensors.range_rate / riccati.q, at.distance),
        accel_sigma=math.sqrt(accel2 * sensors.imu_rate),
        gyro_sigma=math.sqrt(gyro2 * sensors.imu_rate),
        position_factor=v.position / (_gyro_into(at.distance) * gyro2),
        velocity_factor=v.velocity / (accel2 + _gyro_into(at.speed) * gyro2),
        position_box=boxes[0],
        velocity_box=boxes[1],
        gravity_box=boxes[2],
        xi_factor=p0.xi / _xi_variance(*boxes),
        attitude_time=1 / (attitude.k1 * attitude.rho1 * _slow_share(weight, world)),
        gravity_weight=weight,
        rho1=attitude.rho1,
        schedule=attitude.schedule,
    )


def to_paper(chosen: PhysicalGains, at: Typical, *, world: World, sensors: Sensors) -> Gains:
    """The paper's gains. Raises ValueError, naming the physical quantity, where a gain lies outside its range."""
    p = chosen
    accel2, gyro2 = p.accel_sigma**2 / sensors.imu_rate, p.gyro_sigma**2 / sensors.imu_rate
    variance = at.distance**2 * p.range_sigma**2 + p.range_sigma**4 / 2
    boxes = (p.position_box, p.velocity_box, p.gravity_box)
    velocity = p.velocity_factor * (accel2 + _gyro_into(at.speed) * gyro2)
    rho2 = p.gravity_weight * p.rho1 * _length(world.magnetic) ** 2 / _length(world.gravity) ** 2
    k1 = 1 / (p.attitude_time * p.rho1 * _slow_share(p.gravity_weight, world))
    return Gains(
        mode=p.mode,
        riccati=RiccatiGains(
            q=_within("range_sigma", "q", sensors.range_rate / variance, Q_RANGE),
            v=Blocks(
                xi=_within("accel_sigma", "v.xi", accel2 * _accel_into_xi(at, world), V_RANGE),
                position=_within(
                    "gyro_sigma with position_factor",
                    "v.position",
                    p.position_factor * _gyro_into(at.distance) * gyro2,
                    V_RANGE,
                ),
                velocity=_within("velocity_factor with both sigmas", "v.velocity", velocity, V_RANGE),
                gravity=_within("gyro_sigma", "v.gravity", _gyro_into(_length(world.gravity)) * gyro2, V_RANGE),
            ),
            p0=Blocks(
                xi=_within("xi_factor with the boxes", "p0.xi", p.xi_factor * _xi_variance(*boxes), P0_RANGE),
                position=_within("position_box", "p0.position", p.position_box**2 / 3, P0_RANGE),
                velocity=_within("velocity_box", "p0.velocity", p.velocity_box**2 / 3, P0_RANGE),
                gravity=_within("gravity_box", "p0.gravity", p.gravity_box**2 / 3, P0_RANGE),
            ),
        ),
        attitude=AttitudeGains(
            k1=_within("attitude_time", "k1", k1, K1_RANGE),
            rho1=_within("rho1", "rho1", p.rho1, RHO_RANGE),
            rho2=_within("gravity_weight", "rho2", rho2, RHO_RANGE),
            schedule=p.schedule,
        ),
    )


def keep_known(converted: Gains, known: Iterable[Gains], at: Typical, *, world: World, sensors: Sensors) -> Gains:
    """The gains from `to_paper`, with the known value of each gain that differs from it by rounding only.

    A round trip through physical units changes last bits. Where a user has changed some physical quantities, the gains
    that do not depend on them are exactly the known ones; where nothing was changed, all of them are.
    """
    kept = converted
    for one in known:
        round_trip = to_paper(to_physical(one, at, world=world, sensors=sensors), at, world=world, sensors=sensors)
        kept = _kept(kept, converted, one, round_trip)
    return kept


def _kept(kept: T, converted: T, known: T, round_trip: T) -> T:
    if converted == round_trip:
        return known
    if not (isinstance(kept, msgspec.Struct) and isinstance(converted, msgspec.Struct)):
        return kept
    if type(converted) is not type(round_trip):
        return kept
    names = converted.__struct_fields__
    parts = {name: _kept(*(getattr(value, name) for value in (kept, converted, known, round_trip))) for name in names}
    return msgspec.structs.replace(kept, **parts)


def _range_sigma(variance: float, distance: float) -> float:
    """The σ with d²σ² + ½σ⁴ = variance; the root is written without a difference, which would lose digits."""
    return math.sqrt(2 * variance / (distance**2 + math.sqrt(distance**4 + 2 * variance)))


def _accel_into_xi(at: Typical, world: World) -> float:
    """The mean over ξ1…ξ4 of |∂ξ̇/∂a|²: accel noise enters ξ2, ξ3, ξ4 along p, 2v, 3g, and ξ1 not at all."""
    return (at.distance**2 + 4 * at.speed**2 + 9 * _length(world.gravity) ** 2) / 4


def _gyro_into(length: float) -> float:
    """The mean square per axis of u × η, |u| = length, for a gyro noise η of unit size: u × η ⟂ u leaves ⅔|u|²."""
    return 2 / 3 * length**2


def _xi_variance(p: float, v: float, g: float) -> float:
    """Mean variance of ½|p|², p·v, |v|² + p·g and 3 v·g for vectors anywhere in boxes of half-width p, v, g."""
    return (p**4 / 15 + (p * v) ** 2 / 3 + 4 * v**4 / 15 + (p * g) ** 2 / 3 + 3 * (v * g) ** 2) / 4


def _slow_share(weight: float, world: World) -> float:
    """The slowest rate over k1ρ1: the smaller nonzero eigenvalue of M over ρ1, from a root without a difference."""
    m, g = np.asarray(world.magnetic), np.asarray(world.gravity)
    sizes = _length(world.magnetic) * _length(world.gravity)
    sine2, cosine2 = float(np.sum(np.cross(m, g) ** 2)) / sizes**2, float(m @ g) ** 2 / sizes**2
    root = math.sqrt((1 - weight) ** 2 + 4 * weight * cosine2)
    return _length(world.magnetic) ** 2 * 2 * weight * sine2 / (1 + weight + root)


def _length(vector: tuple[float, float, float]) -> float:
    return math.hypot(*vector)


def _within(quantity: str, name: str, value: float, limits: tuple[float, float]) -> float:
    """The value, or the end of the range where the value is outside by rounding only."""
    low, high = limits
    close = low * (1 - ROUNDING) <= value <= high * (1 + ROUNDING)
    require(close, f"{quantity} asks for {name} = {value:g}, which must lie between {low:g} and {high:g}")
    return min(max(value, low), high)
