"""Flown: the attitude a multirotor must have, thrust along the specific force, and its angular velocity, exact in time.

With f = p̈ − g (m/s²) the thrust axis is b₃ = ± f/|f| (the sign that makes a hover upright), and
    R = R_tilt(b₃) Rz(ψ),   R_tilt the shortest turn from e₃ to b₃,   ω = vee(RᵀṘ)
in power series of order two, so ω uses the path's jerk and ω̇ its snap and nothing is differenced. Two cases have no
answer: a free fall (f = 0: no thrust, no axis) and thrust straight down (yaw about it is a pole of every such rule).
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Input, Vec3
from rangenav.results import result
from rangenav.signals import expressions, formula, series
from rangenav.signals.families import Signal
from rangenav.signals.series import Series

FREE_FALL = 0.05
"""m/s²; with less specific force than this, half a percent of the weight, the direction of thrust means nothing."""
UPSIDE_DOWN = 1e-3
"""1 + b₃·e₃; at this value the thrust axis is 2.6° from straight down and turns the body 45 times as fast as itself."""
ORDER = 2


class Flown(Input, frozen=True, kw_only=True, tag="flown", tag_field="kind"):
    """The attitude with which a multirotor flies the path; only the yaw angle is free."""

    yaw: str = "0"
    """rad, a formula in t (s): the turn about the thrust axis."""

    def __post_init__(self) -> None:
        super().__post_init__()
        try:
            expressions.parse(self.yaw)
        except ValueError as error:
            raise ValueError(f"yaw: {error}") from None


@result
class Attitude:
    """Attitude and its derivatives, time first."""

    rotation: Float[Array, "n 3 3"]
    angular_velocity: Float[Array, "n 3"]
    """rad/s, body."""
    angular_acceleration: Float[Array, "n 3"]
    """rad/s², body."""


def attitude(flown: Flown, path: Signal, gravity: Vec3, time: Float[Array, "n"]) -> Attitude:
    """Rotation, angular velocity and angular acceleration at times (s). Raises ValueError where there is no answer."""
    axis = _thrust_axis(path, gravity, time)
    yaw = formula.derivatives(flown.yaw, time, ORDER)
    turned = _turned(_tilt(axis, time), (yaw[0], yaw[1], yaw[2] / 2))
    rotation = np.stack([np.stack([entry[0] for entry in row], axis=-1) for row in turned], axis=-2)
    rates = [_rate(turned, 2, 1), _rate(turned, 0, 2), _rate(turned, 1, 0)]
    return Attitude(
        rotation=rotation,
        angular_velocity=np.stack([rate[0] for rate in rates], axis=-1),
        angular_acceleration=np.stack([rate[1] for rate in rates], axis=-1),
    )


def refuse_undefined(flown: Flown, path: Signal, gravity: Vec3, time: Float[Array, "n"]) -> None:
    """Raise ValueError as `attitude` does at times (s), for a path whose derivatives are finite there."""
    axis = _thrust_axis(path, gravity, time, order=0)
    formula.derivatives(flown.yaw, time, ORDER)
    _turn_from_straight_down(axis, time)


def _thrust_axis(path: Signal, gravity: Vec3, time: Array, order: int = ORDER) -> list[Series]:
    """b₃ as three series: up in a z-up world, down where z points down, so that a hover is the identity."""
    force = (path(time, 2) - np.asarray(gravity), *(path(time, 2 + k) / k for k in range(1, order + 1)))
    size = np.linalg.norm(force[0], axis=-1)
    least = int(np.argmin(size))
    if size[least] < FREE_FALL:
        raise ValueError(
            f"flown: at t = {time[least]:.3g} s the path falls freely (specific force {size[least]:.2g} m/s²), "
            "so no thrust tells the attitude"
        )
    sign = -1.0 if gravity[2] > 0 else 1.0
    parts = [tuple(sign * part[:, k] for part in force) for k in range(3)]
    x, y, z = (series.multiply(part, part, order) for part in parts)
    inverse = series.real_power(series.add(series.add(x, y), z), -0.5, order)
    return [series.multiply(part, inverse, order) for part in parts]


def _tilt(axis: list[Series], time: Array) -> list[list[Series]]:
    """R_tilt = [[1 − x²/(1+z), −xy/(1+z), x], [−xy/(1+z), 1 − y²/(1+z), y], [−x, −y, z]]."""
    x, y, z = axis
    one, below = series.constant(1.0), _turn_from_straight_down(axis, time)

    def over(a: Series, b: Series) -> Series:
        return series.negative(series.divide(series.multiply(a, b, ORDER), below, ORDER))

    mixed = over(x, y)
    return [
        [series.add(one, over(x, x)), mixed, x],
        [mixed, series.add(one, over(y, y)), y],
        [series.negative(x), series.negative(y), z],
    ]


def _turn_from_straight_down(axis: list[Series], time: Array) -> Series:
    """1 + z, by which R_tilt divides. Raises ValueError where it vanishes."""
    above = series.add(series.constant(1.0), axis[2])
    lowest = int(np.argmin(above[0]))
    if above[0][lowest] < UPSIDE_DOWN:
        raise ValueError(
            f"flown: at t = {time[lowest]:.3g} s the thrust points straight down, where the yaw about it has no meaning"
        )
    return above


def _turned(tilt: list[list[Series]], yaw: Series) -> list[list[Series]]:
    """R_tilt Rz(ψ): columns c₁ cos ψ + c₂ sin ψ and c₂ cos ψ − c₁ sin ψ."""
    c, s = series.cos(yaw, ORDER), series.sin(yaw, ORDER)
    rows = []
    for first, second, third in tilt:
        forward = series.add(series.multiply(first, c, ORDER), series.multiply(second, s, ORDER))
        side = series.add(series.multiply(second, c, ORDER), series.negative(series.multiply(first, s, ORDER)))
        rows.append([forward, side, third])
    return rows


def _rate(rotation: list[list[Series]], i: int, j: int) -> Series:
    """Entry (i, j) of RᵀṘ with its derivative: column i times the derivative of column j."""
    total: Series = ()
    for row in rotation:
        moving = tuple((k + 1) * row[j][k + 1] for k in range(ORDER))
        total = series.add(total, series.multiply(row[i], moving, ORDER - 1))
    return total
