"""The limits of a vehicle, and where a motion exceeds them: each quantity over time against its limit.

Thrust is |p̈ − g|/|g|, in units of the weight. A vehicle needs some reserve to follow a path: a Crazyflie at 92% of its
thrust strays by a metre, at two thirds by centimetres. So a motion may use 1/1.35 of the vehicle's thrust.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.inputs import Input, require
from rangenav.motion import Motion, World
from rangenav.results import result

THRUST_MARGIN = 0.35
"""A vehicle's thrust must exceed the motion's by this share."""
MAX_NAME = 40


class Vehicle(Input, frozen=True, kw_only=True, omit_defaults=True):
    """A name and its limits; None, or left out of a file, is unlimited."""

    name: str
    thrust_to_weight: float | None = None
    """The largest thrust in units of the weight; the margin is subtracted from it."""
    speed: float | None = None
    """m/s"""
    acceleration: float | None = None
    """m/s²"""
    jerk: float | None = None
    """m/s³"""
    snap: float | None = None
    """m/s⁴"""
    tilt: float | None = None
    """rad, of the specific force from straight up: how far a multirotor must lean."""
    body_rate: float | None = None
    """rad/s"""
    height_min: float | None = None
    """m, above the origin of the inertial frame, against gravity: the floor."""
    height_max: float | None = None
    """m, above the origin of the inertial frame: the ceiling."""
    anchor_distance_min: float | None = None
    """m, to be kept from the anchor."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(0 < len(self.name) <= MAX_NAME, f"name must have 1 to {MAX_NAME} characters, got {len(self.name)}")
        for key in self.__struct_fields__:
            value = getattr(self, key)
            if isinstance(value, float) and key not in ("height_min", "height_max"):
                require(value > 0, f"{key} must be positive, got {value:g}")
        if self.height_min is not None and self.height_max is not None:
            require(self.height_min < self.height_max, "height_min must be below height_max")


FREE = Vehicle(name="free")
"""No limits: to study what a motion does before choosing a vehicle."""
CRAZYFLIE = Vehicle(
    name="Crazyflie 2.1",
    thrust_to_weight=1.95,  # ours: gym-pybullet-drones' model says 2.25 (cf2x.urdf), with a fresh battery
    speed=8.3,  # 30 km/h in the same model
    tilt=math.radians(45),  # ours, as all that follow
    body_rate=10.0,
    anchor_distance_min=0.1,
)
FIVE_INCH = Vehicle(
    name="5-inch quad",
    thrust_to_weight=5.0,  # ours: research racers of this size have 4 to 6
    speed=20.0,  # ours, as all that follow: half of what such a quad reaches on a straight
    tilt=math.radians(75),
    body_rate=15.0,
    anchor_distance_min=0.3,
)
HAND_HELD = Vehicle(
    name="hand-held",
    speed=3.0,  # ours, as all that follow: an arm's swing at a walk
    acceleration=20.0,
    jerk=400.0,
    body_rate=8.0,
    anchor_distance_min=0.05,
)
CATALOGUE = (FREE, HAND_HELD, CRAZYFLIE, FIVE_INCH)
"""The vehicles to choose from."""
BY_NAME = {one.name.lower().replace(" ", "-"): one for one in CATALOGUE}
"""The same by names without blanks, which are typed: crazyflie-2.1."""
WORDS = {
    "thrust_to_weight": ("thrust", "times the weight"),
    "speed": ("speed", "m/s"),
    "acceleration": ("acceleration", "m/s²"),
    "jerk": ("jerk", "m/s³"),
    "snap": ("snap", "m/s⁴"),
    "tilt": ("tilt", "°"),
    "body_rate": ("body rate", "rad/s"),
    "height_min": ("height", "m"),
    "height_max": ("height", "m"),
    "anchor_distance_min": ("distance to the anchor", "m"),
}
"""The name and the unit of each limit in texts; tilt is in degrees there."""


@result
class Demands:
    """What a motion demands over time."""

    thrust_to_weight: Float[Array, "n"]
    speed: Float[Array, "n"]
    acceleration: Float[Array, "n"]
    jerk: Float[Array, "n"]
    snap: Float[Array, "n"]
    tilt: Float[Array, "n"]
    """rad, of the specific force from straight up."""
    body_rate: Float[Array, "n"]
    height: Float[Array, "n"]
    """m above the origin, against gravity."""
    anchor_distance: Float[Array, "n"]


@result
class Break:
    """One limit that a motion breaks."""

    limit: str
    """The field of the vehicle."""
    allowed: float
    """In the quantity's SI unit; for thrust, the limit without the margin."""
    reached: float
    """The worst value."""
    at: float
    """s, when."""
    where: Bool[Array, "n"]
    """Samples on which it is broken."""
    summary: str


@dataclass(frozen=True, kw_only=True)
class Use:
    """How much of one limit a motion uses, in the units of texts."""

    name: str
    unit: str
    reached: float
    """The worst value."""
    at: float
    """s, when."""
    allowed: float | None
    """None if the vehicle has no such limit; for thrust, the limit without the margin."""
    least: bool
    """Whether the limit is a least value."""

    @property
    def broken(self) -> bool:
        """Whether the limit is exceeded."""
        return self.allowed is not None and (self.reached < self.allowed if self.least else self.reached > self.allowed)

    @property
    def share(self) -> float:
        """reached/allowed, or allowed/reached for a least value; 0 without a limit."""
        if self.allowed is None:
            return 0.0
        if self.least:
            return self.allowed / self.reached if self.reached > 0 else math.inf
        return self.reached / self.allowed if self.allowed > 0 else math.inf


def demands(motion: Motion, *, world: World) -> Demands:
    """Every limited quantity of a motion, over time."""
    gravity = np.asarray(world.gravity)
    weight = float(np.linalg.norm(gravity))
    up = -gravity / weight
    force = motion.acceleration - gravity
    size = np.linalg.norm(force, axis=-1)
    along = force @ up
    aside = np.linalg.norm(force - along[:, None] * up, axis=-1)
    return Demands(
        thrust_to_weight=size / weight,
        speed=np.linalg.norm(motion.velocity, axis=-1),
        acceleration=np.linalg.norm(motion.acceleration, axis=-1),
        jerk=np.linalg.norm(motion.jerk, axis=-1),
        snap=np.linalg.norm(motion.snap, axis=-1),
        tilt=np.arctan2(aside, along),
        body_rate=np.linalg.norm(motion.angular_velocity, axis=-1),
        height=motion.position @ up,
        anchor_distance=np.linalg.norm(motion.position - np.asarray(world.anchor), axis=-1),
    )


def broken(motion: Motion, vehicle: Vehicle, *, world: World) -> tuple[Break, ...]:
    """The limits of a vehicle that a motion breaks, the most broken one first."""
    limits = {limit: allowed for limit in WORDS if (allowed := bound(vehicle, limit)) is not None}
    if not limits:
        return ()
    demanded, breaks = demands(motion, world=world), []
    for limit, allowed in limits.items():
        quantity = getattr(demanded, limit.removesuffix("_min").removesuffix("_max"))
        least = limit.endswith("_min")
        where = quantity < allowed if least else quantity > allowed
        if where.any():
            worst = int(np.argmin(quantity) if least else np.argmax(quantity))
            breaks.append(_break(limit, allowed, float(quantity[worst]), float(motion.time[worst]), where))
    return tuple(sorted(breaks, key=lambda one: -float(np.mean(one.where))))


def uses(motion: Motion, vehicle: Vehicle, *, world: World) -> tuple[Use, ...]:
    """A motion's use of every limit; quantities without a limit are included, except the height."""
    demanded = demands(motion, world=world)
    every_use = []
    for limit, (name, unit) in WORDS.items():
        allowed = bound(vehicle, limit)
        if allowed is not None or not limit.startswith("height"):
            quantity = getattr(demanded, limit.removesuffix("_min").removesuffix("_max"))
            least = limit.endswith("_min")
            worst = int(np.argmin(quantity) if least else np.argmax(quantity))
            factor = math.degrees(1) if limit == "tilt" else 1.0
            every_use.append(
                Use(
                    name=f"{'least ' if least else ''}{name}",
                    unit=unit,
                    reached=factor * float(quantity[worst]),
                    at=float(motion.time[worst]),
                    allowed=None if allowed is None else factor * allowed,
                    least=least,
                )
            )
    return tuple(every_use)


def bound(vehicle: Vehicle, limit: str) -> float | None:
    """The value that the vehicle allows, in SI units; None is unlimited. For thrust, the limit without the margin."""
    value = getattr(vehicle, limit)
    return value / (1 + THRUST_MARGIN) if limit == "thrust_to_weight" and value is not None else value


def _break(limit: str, allowed: float, reached: float, at: float, where: Array) -> Break:
    name, unit = WORDS[limit]
    factor = math.degrees(1) if limit == "tilt" else 1.0
    relation = "below the least" if limit.endswith("_min") else "above the most"
    kept = f" ({THRUST_MARGIN:.0%} kept in hand)" if limit == "thrust_to_weight" else ""
    text = f"{name} {factor * reached:.3g} {unit} at t = {at:.2f} s, {relation} allowed, {factor * allowed:.3g}{kept}"
    return Break(limit=limit, allowed=allowed, reached=reached, at=at, where=where, summary=text)
