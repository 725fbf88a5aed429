"""The gains in two kinds of units: the paper's gains, which a preset stores, and physical ones (`physical_gains`).

The stored gains are never converted. Physical gains are computed from them to be shown, at the path's typical state;
the paper's gains are computed from the physical ones only when a visitor moves one of these.
"""

from collections.abc import Iterable
from dataclasses import dataclass
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


@dataclass(frozen=True)
class GainLabel:
    """How one physical gain is shown on the page."""

    label: str
    """13 to 16 characters: with its value it takes two lines of viser's narrow label, and no number is broken."""
    unit: str
    limits: tuple[float, float]
    """Of its slider; a value beyond them is checked by the model alone."""
    hint: str


GAIN_LABELS = {
    "range_sigma": GainLabel(
        "noise σ of range", "m", (1e-3, 10.0), "σ of one range for which q = rate/(d²σ² + ½σ⁴) is made."
    ),
    "accel_sigma": GainLabel("noise σ of accel", "m/s²", (1e-3, 10.0), "σ of one accelerometer sample; decides V(ξ)."),
    "gyro_sigma": GainLabel(
        "noise σ of gyro", "rad/s", (1e-4, 1.0), "σ of one gyro sample; decides V(g) = ⅔|g|²σ²/rate."
    ),
    "position_factor": GainLabel(
        "position factor", "", (1e-2, 1e3), "V(p) over what the gyro's noise alone makes of it; 1 adds nothing."
    ),
    "velocity_factor": GainLabel(
        "velocity factor", "", (1e-2, 1e3), "V(v) over what gyro and accelerometer noise make of it; 1 adds nothing."
    ),
    "position_box": GainLabel(
        "position box ±",
        "m",
        (0.1, 100.0),
        "The start may be wrong by this much on each axis; P₀(p) = b²/3 of that box.",
    ),
    "velocity_box": GainLabel("velocity box ±", "m/s", (0.1, 100.0), "The same of the velocity; P₀(v) = b²/3."),
    "gravity_box": GainLabel("gravity box ±", "m/s²", (0.1, 100.0), "The same of gravity in body axes; P₀(g) = b²/3."),
    "xi_factor": GainLabel(
        "factor on P₀(ξ)", "", (1e-3, 1e3), "P₀(ξ) over the mean variance of ξ₁…ξ₄ in the three boxes."
    ),
    "attitude_time": GainLabel(
        "slowest time T", "s", (0.02, 100.0), "Slowest time constant of a small attitude error; decides k1."
    ),
    "gravity_weight": GainLabel(
        "gravity weight",
        "",
        (1e-2, 1e2),
        "ρ2|g|²/(ρ1|m|²): what the direction of gravity counts beside that of the magnetic field; decides ρ2.",
    ),
}


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


def with_page_labels(sentence: str) -> str:
    """A sentence of the model with the names of the fields replaced by the labels of the page."""
    for name, row in GAIN_LABELS.items():
        sentence = sentence.replace(name, row.label)
    return sentence
