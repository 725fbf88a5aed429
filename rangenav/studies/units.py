"""The unit of a parameter, from the documentation of the field that its path leads to.

What a field alone does not tell is in tables: a signal's unit is that of its owner, m of a path and rad/s of a
rotation; the blocks of v and p0 have the squares of the units of the state; noise is per sample, or a density.
"""

from typing import Any

from rangenav import fields, results
from rangenav.field_path import COMPONENTS
from rangenav.inputs import Input
from rangenav.preset import Preset
from rangenav.studies.parameters import DERIVED, Parameter

SIGNALS = {"path": ("m", "m/s"), "angular_velocity": ("rad/s", "rad/s²")}
"""The unit of a signal, and that of its derivative."""
SIGNAL_FIELDS = {"amplitude": 0, "offset": 0, "value": 0, "drift": 1}
"""Fields in the unit of a signal, or of its derivative."""
BLOCKS = {
    "p0": {"position": "m²", "velocity": "m²/s²", "gravity": "m²/s⁴"},
    "v": {"position": "m²/s", "velocity": "m²/s³", "gravity": "m²/s⁵"},
}
"""Covariance, and its growth in a second. The four numbers ξ share a block and have four units."""
PLAIN = ("rho1", "halfway", "mag", "thrust_to_weight", "attitude_axis", "magnetic")
"""Fields without a dimension: ratios, weights and unit vectors."""
DENSITY = "/√Hz"


def of(parameter: Parameter, preset: Preset) -> str | None:
    """The unit that the file states, else the field's own: empty of a number without dimension, None if none is known.

    Of a preset whose IMU noise is a density, that of the density.
    """
    if parameter.unit or parameter.path in DERIVED:
        return parameter.unit
    parts = parameter.path.split(".")
    owner: Any = preset
    unit: str | None = None
    for k, part in enumerate(parts):
        if isinstance(owner, Input):
            unit = _of_field(type(owner), part, parts[:k])
            owner = getattr(owner, part)
        else:  # an entry of a list has the unit of the list, unless it has fields of its own
            owner = owner[COMPONENTS.get(part, 0) if not part.isdecimal() else int(part) - 1]
    dense = parts[:2] == ["sensors", "noise"] and parts[-1] in ("gyro", "accel")
    return f"{unit}{DENSITY}" if dense and preset.sensors.noise.imu_unit == "density" else unit


def _of_field(kind: type[Input], name: str, above: list[str]) -> str | None:
    """Of a field of an input that stands below these parts of the path."""
    entry = fields.of(kind).get(name)
    if entry is not None and fields.SIGNAL_UNIT not in entry.unit:
        return entry.unit
    if above and above[0] in SIGNALS and name in SIGNAL_FIELDS:
        return SIGNALS[above[0]][SIGNAL_FIELDS[name]]
    if above and above[-1] in BLOCKS:
        return BLOCKS[above[-1]].get(name)
    owners = (base for base in kind.__mro__ if issubclass(base, Input) and name in base.__annotations__)
    documented = "".join(results.units(owner).get(name, "").strip() for owner in list(owners)[:1])
    return documented or ("" if name in PLAIN else None)
