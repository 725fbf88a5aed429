"""The families of signals on the page: one row for each, from which menus, editors, hints and conversions follow.

To add a family, add it to the union in rangenav.signals.families, and a row here: `family_of_numbers(…)` for a family
of numbers and vectors, a FamilyRow with an editor and a conversion of its own for any other.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from explorer.model import conversion
from explorer.model.conversion import Conversion
from explorer.panels.motion.families.editor import SignalSlot
from explorer.panels.motion.families.formulas import FlownEditor, FormulaEditor
from explorer.panels.motion.families.numbers import NumbersEditor
from explorer.panels.motion.families.points import minimum_snap_editor, waypoints_editor
from explorer.panels.motion.families.polynomials import PolynomialsEditor
from explorer.panels.motion.families.sines import SinesEditor
from explorer.widgets.form import Form
from rangenav import fields
from rangenav.fields import SIGNAL_UNIT, NumberField
from rangenav.signals import (
    AngularVelocity,
    Family,
    Flown,
    Formula,
    MinimumSnap,
    Multisine,
    Polynomials,
    Sum,
    Waypoints,
)
from rangenav.signals.multisine import MAX_OFFSET


@dataclass(frozen=True, kw_only=True)
class FamilyRow:
    """What the page has to know of one family."""

    name: str
    """The family's `kind` in a file. A constant, which is a Multisine of nothing but an offset, has its own name."""
    type: type[AngularVelocity]
    description: str
    """What a signal of this family is called in a sentence."""
    editor: Callable[[Form, SignalSlot], Any]
    """Makes the family's editor."""
    convert: Conversion
    path_label: str = ""
    """How the menu of paths offers it; empty if no path is of this family."""
    path_hint: str = ""
    """What the family is, for the hint of that menu."""
    angular_velocity_label: str = ""
    """How the menu of angular velocities offers it; empty if that menu does not."""


VALUE = NumberField(
    label="value", unit=SIGNAL_UNIT, limits=(0.0, MAX_OFFSET), step=0.01, hint=f"{SIGNAL_UNIT}, at all times."
)
"""The value of a constant: the offset of a Multisine."""


def family_of_numbers(
    first: Family, *, description: str, path_label: str, path_hint: str, angular_velocity_label: str = ""
) -> FamilyRow:
    """The row of a family whose fields are numbers and vectors, each with its entry in the field's annotation.

    The editor follows from the entries, and a visitor who chooses the family starts from the signal `first`.
    Raises TypeError for a field without an entry, which would have no control.
    """
    kind = type(first)
    return FamilyRow(
        name=str(kind.__struct_config__.tag),
        type=kind,
        description=description,
        editor=partial(NumbersEditor, kind=kind, entries=fields.of_all(kind, NumberField)),
        convert=partial(conversion.replaced, first=first),
        path_label=path_label,
        path_hint=path_hint,
        angular_velocity_label=angular_velocity_label,
    )


ROWS = (
    FamilyRow(
        name="multisine",
        type=Multisine,
        description="sines",
        editor=SinesEditor,
        convert=conversion.sines,
        path_label="sines",
        path_hint="tones on each axis",
        angular_velocity_label="sines",
    ),
    FamilyRow(
        name="constant",
        type=Multisine,
        description="a constant",
        editor=partial(NumbersEditor, kind=Multisine, entries={"offset": VALUE}),
        convert=conversion.constant,
        angular_velocity_label="constant",
    ),
    FamilyRow(
        name="formula",
        type=Formula,
        description="formulas",
        editor=FormulaEditor,
        convert=conversion.formula,
        path_label="formulas",
        path_hint="an expression in t",
        angular_velocity_label="formulas",
    ),
    FamilyRow(
        name="waypoints",
        type=Waypoints,
        description="a curve through points",
        editor=waypoints_editor,
        convert=conversion.waypoints,
        path_label="waypoints",
        path_hint="a smooth curve through timed points",
        angular_velocity_label="keyframes",
    ),
    FamilyRow(
        name="minimum-snap",
        type=MinimumSnap,
        description="a minimum-snap curve",
        editor=minimum_snap_editor,
        convert=conversion.minimum_snap,
        path_label="minimum snap",
        path_hint="as flight planners make it, with little snap",
    ),
    FamilyRow(
        name="polynomials",
        type=Polynomials,
        description="polynomials",
        editor=PolynomialsEditor,
        convert=conversion.polynomials,
        path_label="polynomials",
        path_hint="pieces as in flight files",
    ),
    FamilyRow(
        name="flown",
        type=Flown,
        description="flown",
        editor=FlownEditor,
        convert=conversion.flown,
        angular_velocity_label="flown: as a multirotor must",
    ),
)
BY_NAME = {row.name: row for row in ROWS}
PATH_LABELS = {row.name: row.path_label for row in ROWS if row.path_label}
ANGULAR_VELOCITY_LABELS = {row.name: row.angular_velocity_label for row in ROWS if row.angular_velocity_label}
FROM_FILE, FROM_FILE_LABEL = "from-file", "as in the file"
"""Name and label of a signal that has no editor where it is, such as a sum as an angular velocity."""


def family_name(signal: AngularVelocity) -> str:
    """The name of the signal's family; that of a sum is FROM_FILE."""
    return FROM_FILE if isinstance(signal, Sum) else _row(signal).name


def description(signal: AngularVelocity) -> str:
    """What kind of signal it is, for a sentence."""
    if isinstance(signal, Sum):
        return f"{description(signal.base)} plus {description(signal.wiggle)}"
    return _row(signal).description


def _row(signal: AngularVelocity) -> FamilyRow:
    """The first row of the signal's type. Raises KeyError for a type without a row, which a test rules out."""
    for row in ROWS:
        if row.type is type(signal):
            return row
    raise KeyError(f"{type(signal).__name__} has no row in the table of families")
