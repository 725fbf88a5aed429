"""The truth on a time grid (paper, eq. 1): ṗ = v, v̇ = g + R a, Ṙ = R [ω]x.

The path determines position to snap. The angular velocity is integrated on the group, so R stays a rotation. A `Flown`
body has no angular velocity of its own: its attitude follows from the path.
The apparent acceleration (specific force) is what an accelerometer feels: a = Rᵀ(p̈ − g).
"""

import math
import warnings
from functools import lru_cache

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import so3
from rangenav.inputs import Input, Vec3, require
from rangenav.results import result
from rangenav.signals import AngularVelocity, Flown, Signal, multirotor
from rangenav.signals.multirotor import Attitude

COLLINEAR_SINE = 1e-3
"""m and g count as collinear below this sine of their angle (0.06°): the attitude about them is then not observable."""
UNIT_TOLERANCE, NEARLY_UNIT = 1e-6, 1e-3
"""Of a length from one: a unit vector, and one as people write it (0.70711), which is divided by its length."""
SNAP = 4
"""The highest derivative of the path that a motion holds."""
GAUSS_OFFSET = np.sqrt(3) / 6
"""Gauss points of a step lie at (½ ± √3/6) h."""


class DirectionWarning(UserWarning):
    """A direction was nearly of unit length, and was divided by its length."""


class World(Input, frozen=True, kw_only=True):
    """What does not move: gravity, the magnetic direction and the anchor, all in the inertial frame."""

    gravity: Vec3 = (0.0, 0.0, 9.81)
    """m/s², as it enters v̇ = g + R a; the paper's z axis points down."""
    magnetic: Vec3 = (0.7071067811865476, 0.0, 0.7071067811865476)
    """Unit vector, not collinear with gravity."""
    anchor: Vec3 = (0.0, 0.0, 0.0)
    """m"""

    def __post_init__(self) -> None:
        super().__post_init__()
        length = math.hypot(*self.magnetic)  # unlike numpy's norm it does not overflow
        require(abs(length - 1) < NEARLY_UNIT, f"magnetic must be a unit vector, got length {length:g}")
        if abs(length - 1) >= UNIT_TOLERANCE:
            x, y, z = (value / length for value in self.magnetic)
            msgspec.structs.force_setattr(self, "magnetic", (x, y, z))
            text = f"magnetic has the length {length:.7g}: it is used as a unit vector"
            warnings.warn(text, DirectionWarning, stacklevel=2)
        gravity = math.hypot(*self.gravity)
        require(0 < gravity < 1e3, f"gravity must have a length between 0 and 1000 m/s², got {gravity:g}")
        sine = float(np.linalg.norm(np.cross(self.magnetic, self.gravity))) / gravity
        require(
            sine > COLLINEAR_SINE, "magnetic and gravity must not be collinear: attitude about them is unobservable"
        )
        require(math.hypot(*self.anchor) < 1e5, "anchor must lie within 100 km of the origin")


@result
class Motion:
    """The truth, time first; inertial frame unless it says body."""

    time: Float[Array, "n"]
    """s"""
    position: Float[Array, "n 3"]
    """m"""
    velocity: Float[Array, "n 3"]
    """m/s"""
    acceleration: Float[Array, "n 3"]
    """m/s²"""
    jerk: Float[Array, "n 3"]
    """m/s³"""
    snap: Float[Array, "n 3"]
    """m/s⁴"""
    rotation: Float[Array, "n 3 3"]
    """R, from body to inertial axes."""
    angular_velocity: Float[Array, "n 3"]
    """rad/s, body."""
    angular_acceleration: Float[Array, "n 3"]
    """rad/s², body."""
    apparent_acceleration: Float[Array, "n 3"]
    """m/s², body: Rᵀ(p̈ − g)."""


@result
class Limits:
    """The largest of each over a motion, and how near it comes to the anchor. SI; thrust_to_weight has no unit."""

    speed: float
    acceleration: float
    thrust_to_weight: float
    body_rate: float
    jerk: float
    snap: float
    anchor_distance_min: float


def time_grid(duration: float, rate: float) -> Float[Array, "n"]:
    """Sample times 0, 1/rate, … up to duration (s)."""
    return np.arange(math.floor(duration * rate + 1e-9) + 1) / rate


def simulate(
    path: Signal,
    angular_velocity: AngularVelocity,
    *,
    world: World,
    initial_rotation: Vec3,
    duration: float,
    rate: float,
) -> Motion:
    """The truth at `rate` (Hz) for `duration` (s); initial_rotation is a rotation vector (rad): R(0) = exp([r]x).

    For `Flown` the path alone determines the attitude, and initial_rotation is not used. Raises ValueError if such an
    attitude does not exist.
    """
    time = time_grid(duration, rate)
    if isinstance(angular_velocity, Flown):
        body = multirotor.attitude(angular_velocity, path, world.gravity, time)
    else:
        body = _turning(angular_velocity, initial_rotation, duration, rate)
    return carried(path.jet(time, SNAP), body, time, world.gravity)


def carried(jet: Float[Array, "5 n 3"], body: Attitude, time: Float[Array, "n"], gravity: Vec3) -> Motion:
    """The motion of a body with this attitude at each time (s); jet: position to snap, inertial axes."""
    position, velocity, acceleration, jerk, snap = jet
    return Motion(
        time=time,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        jerk=jerk,
        snap=snap,
        rotation=body.rotation,
        angular_velocity=body.angular_velocity,
        angular_acceleration=body.angular_acceleration,
        apparent_acceleration=apparent(body.rotation, acceleration, gravity=np.asarray(gravity)),
    )


@lru_cache(maxsize=8)
def _turning(angular_velocity: Signal, initial_rotation: Vec3, duration: float, rate: float) -> Attitude:
    """Cached by its own inputs: the attitude does not depend on the path, which changes while somebody drags it."""
    time, start = time_grid(duration, rate), so3.exp(np.asarray(initial_rotation, dtype=float))
    body = Attitude(
        rotation=integrate(angular_velocity, start, time),
        angular_velocity=angular_velocity(time, 0),
        angular_acceleration=angular_velocity(time, 1),
    )
    for array in (body.rotation, body.angular_velocity, body.angular_acceleration):
        array.flags.writeable = False
    return body


def apparent(
    rotation: Float[Array, "*n 3 3"], acceleration: Float[Array, "*n 3"], *, gravity: Float[Array, "3"]
) -> Float[Array, "*n 3"]:
    """Apparent acceleration in the body frame (m/s²): Rᵀ(p̈ − g). Paper, eq. (2)."""
    return to_body(rotation, acceleration - gravity)


def to_body(rotation: Float[Array, "*n 3 3"], vector: Float[Array, "*n 3"]) -> Float[Array, "*n 3"]:
    """Rᵀ u: an inertial vector in body axes."""
    return np.einsum("...ij,...i->...j", rotation, vector)


def to_inertial(rotation: Float[Array, "*n 3 3"], vector: Float[Array, "*n 3"]) -> Float[Array, "*n 3"]:
    """R u: a body vector in inertial axes."""
    return np.einsum("...ij,...j->...i", rotation, vector)


def integrate(angular_velocity: Signal, start: Float[Array, "3 3"], time: Float[Array, "n"]) -> Float[Array, "n 3 3"]:
    """Ṙ = R [ω]x by the Magnus method of order 4 on two Gauss points: R⁺ = R exp(h(ω₁+ω₂)/2 + √3h²/12 ω₁×ω₂)."""
    h = np.diff(time)[:, None]
    first = angular_velocity(time[:-1] + (0.5 - GAUSS_OFFSET) * h[:, 0])
    second = angular_velocity(time[:-1] + (0.5 + GAUSS_OFFSET) * h[:, 0])
    increments = so3.exp(h / 2 * (first + second) + np.sqrt(3) / 12 * h**2 * np.cross(first, second))
    return cumulative_product(np.concatenate([start[None], increments]))


def cumulative_product(factors: Float[Array, "n 3 3"]) -> Float[Array, "n 3 3"]:
    """Products F₀, F₀F₁, F₀F₁F₂, … by doubling: log₂ n batched products instead of n small ones."""
    products = factors.copy()
    stride = 1
    while stride < len(products):
        products[stride:] = products[:-stride] @ products[stride:]
        stride *= 2
    return products


def limits(motion: Motion, *, world: World) -> Limits:
    """The extremes of a motion on its samples."""

    def largest(vectors: Array) -> float:
        return float(np.sqrt(np.einsum("ni,ni->n", vectors, vectors).max()))

    return Limits(
        speed=largest(motion.velocity),
        acceleration=largest(motion.acceleration),
        thrust_to_weight=largest(motion.apparent_acceleration) / float(np.linalg.norm(world.gravity)),
        body_rate=largest(motion.angular_velocity),
        jerk=largest(motion.jerk),
        snap=largest(motion.snap),
        anchor_distance_min=float(np.linalg.norm(motion.position - np.asarray(world.anchor), axis=-1).min()),
    )
