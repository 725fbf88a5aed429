"""The unit of a parameter, from the documentation of the field that its path leads to."""

from typing import Any

from rangenav import fields, results
from rangenav.field_path import COMPONENTS
from rangenav.inputs import Input
from rangenav.preset import Preset
from rangenav.studies.parameters import DERIVED, Parameter


def of(parameter: Parameter, preset: Preset) -> str:
    """The unit that the file states, else the field's own; empty where none is documented."""
    if parameter.unit or parameter.path in DERIVED:
        return parameter.unit
    owner: Any = preset
    unit = ""
    for part in parameter.path.split("."):
        if isinstance(owner, Input):
            unit = _of_field(type(owner), part)
            owner = getattr(owner, part)
        else:  # an entry of a list has the unit of the list, unless it has fields of its own
            owner = owner[COMPONENTS.get(part, 0) if not part.isdecimal() else int(part) - 1]
    return unit


def _of_field(kind: type[Input], name: str) -> str:
    entry = fields.of(kind).get(name)
    if entry is not None and fields.SIGNAL_UNIT not in entry.unit:
        return entry.unit
    return results.units(kind).get(name, "").strip()
