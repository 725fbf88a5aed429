"""The gains in two kinds of units: the paper's gains, which a preset stores, and physical ones (`physical_gains`).

The stored gains are never converted. Physical gains are computed from them to be shown, at the path's typical state;
the paper's gains are computed from the physical ones only when a visitor moves one of these.
"""

from collections.abc import Iterable
from functools import lru_cache

from msgspec.structs import replace

from explorer.model.settings import Settings, effective
from rangenav import physical_gains
from rangenav.gains import Gains
from rangenav.inputs import Input
from rangenav.motion import World
from rangenav.physical_gains import PhysicalGains, Typical
from rangenav.sensors import Sensors
from rangenav.signals import Signal

CACHED = 4


class GainContext(Input, frozen=True, kw_only=True):
    """What the conversion between paper units and physical units depends on."""

    at: Typical
    world: World
    sensors: Sensors


GAIN_LIMITS: dict[str, tuple[float, float]] = {
    "range_sigma": (1e-3, 10.0),
    "accel_sigma": (1e-3, 10.0),
    "gyro_sigma": (1e-4, 1.0),
    "position_factor": (1e-2, 1e3),
    "velocity_factor": (1e-2, 1e3),
    "position_box": (0.1, 100.0),
    "velocity_box": (0.1, 100.0),
    "gravity_box": (0.1, 100.0),
    "xi_factor": (1e-3, 1e3),
    "attitude_time": (0.02, 100.0),
    "gravity_weight": (1e-2, 1e2),
}
"""Ends of the slider of each physical gain, in SI units; a value beyond them is checked by the model alone."""


def context_of(settings: Settings) -> GainContext:
    """The context of some settings, with their time scale. Raises ValueError if the path has no typical state."""
    p = effective(settings)
    return GainContext(at=_typical(p.path, p.world, p.duration), world=p.world, sensors=p.sensors)


@lru_cache(maxsize=CACHED)
def _typical(path: Signal, world: World, duration: float) -> Typical:
    return physical_gains.typical(path, world, duration)


def in_physical_units(gains: Gains, context: GainContext) -> PhysicalGains:
    """The gains in physical units, without mode and schedule, which are the same in both. Raises ValueError where the
    conversion has no sensible result, as with next to no gravity."""
    unscheduled = replace(gains, mode="constant", attitude=replace(gains.attitude, schedule=None))
    try:
        return physical_gains.to_physical(unscheduled, context.at, world=context.world, sensors=context.sensors)
    except ArithmeticError:
        raise ValueError("they are beyond all numbers in this world") from None


def in_paper_units(physical: PhysicalGains, context: GainContext, known: Iterable[Gains]) -> Gains:
    """The paper's gains of physical ones.

    Where a set of `known` gains has the same physical value, the result has the gain of that set to the last bit.
    Raises ValueError if a gain is outside its range."""
    at, rest = context.at, {"world": context.world, "sensors": context.sensors}
    unscheduled = [replace(gains, mode="constant", attitude=replace(gains.attitude, schedule=None)) for gains in known]
    return physical_gains.keep_known(physical_gains.to_paper(physical, at, **rest), unscheduled, at, **rest)
