"""What the program has to know of a number or vector that a person chooses: an entry for each field of an input.

The entry is in the field's annotation. The check of the field's limits and its control on the page follow from it:
    radius: Annotated[float, NumberField(label="radius", unit=SIGNAL_UNIT, limits=(0.0, 100.0), step=0.01, hint="…")]
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar, get_type_hints

from rangenav.inputs import Input, Vec3, require, require_within

E = TypeVar("E", bound="NumberField")
SIGNAL_UNIT = "{unit}"
"""In the unit or the hint of a signal's field: it stands for the signal's unit, m of a path, rad/s of a rotation."""


@dataclass(frozen=True, eq=False, kw_only=True)
class NumberField:
    """What the program has to know of one number, or of one vector of three."""

    label: str
    """What the page calls it, without its unit."""
    unit: str
    """SI unit of the value; empty for a share. It may contain SIGNAL_UNIT."""
    limits: tuple[float, float]
    """The least and the largest value. Of a vector: of its length."""
    excluded: bool = False
    """Whether the largest value itself is excluded."""
    step: float
    """Step of the page's control, in the unit that the page shows."""
    dial: tuple[float, float] | None = None
    """Ends of the page's slider, in the unit that the page shows; None: a box for a number."""
    percent: bool = False
    """Whether the page shows the value in per cent."""
    hint: str
    """What it does, for the page. It may contain SIGNAL_UNIT."""

    @property
    def shown_unit(self) -> str:
        """The unit that the page shows."""
        return "%" if self.percent else self.unit

    def check(self, name: str, value: float | Vec3) -> None:
        """Raise ValueError, with the field's name, for a value outside the limits."""
        low, high = self.limits
        unit = "" if SIGNAL_UNIT in self.unit else self.unit  # a signal does not know whether it is a path
        if isinstance(value, tuple):
            size = math.hypot(*value)
            require(size <= high, f"{name} must not be longer than {high:g} {unit}".rstrip() + f", got {size:g}")
        elif self.excluded:
            rule = f"{name} must lie between {low:g} and {high:g}, {high:g} excluded, got {value:g}"
            require(low <= value < high, rule)
        else:
            require_within(name, value, low, high, unit)


@cache
def of(kind: type[Input]) -> Mapping[str, NumberField]:
    """The entries of the fields that have one, by the fields' names, in the order of the fields."""
    return {
        name: entry
        for name, annotation in get_type_hints(kind, include_extras=True).items()
        for entry in getattr(annotation, "__metadata__", ())
        if isinstance(entry, NumberField)
    }


def of_all(kind: type[Input], entry_type: type[E]) -> Mapping[str, E]:
    """The entries of all fields of an input. Raises TypeError for a field without one: it would have no control."""
    entries = {name: entry for name, entry in of(kind).items() if isinstance(entry, entry_type)}
    without = [name for name in kind.__struct_fields__ if name not in entries]
    if without:
        raise TypeError(f"{kind.__name__}.{without[0]}: a field needs {entry_type.__name__}(…) in its annotation")
    return entries


def check(value: Input) -> None:
    """Raise ValueError if a field of an input is outside the limits of its entry."""
    for name, entry in of(type(value)).items():
        entry.check(name, getattr(value, name))


def types(kind: type[Input]) -> Mapping[str, Any]:
    """The type of every field, without its entry: float or Vec3 of a field that has one."""
    hints = get_type_hints(kind)
    return {name: hints[name] for name in kind.__struct_fields__}
