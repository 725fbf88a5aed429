"""Columns of a log that a person names, whatever their names are, and the choices that a table offers.

    gyro=rate                      the columns rate.x, rate.y and rate.z: a name without its axis
    gyro=roll rate,pitch rate,yaw  a name for each axis, in the order of the axes
    range=UWB distance (m)         one column; its unit may be left out
    range=none                     no column
Capitals, and what stands between letters and digits, make no difference where a name is that of one column only.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rangenav.formats import dates, text, units
from rangenav.formats.text import Table
from rangenav.inputs import require

NONE = "none"
SUFFIXES = {
    "dps": "deg/s",
    "deg_s": "deg/s",
    "rads": "rad/s",
    "rad_s": "rad/s",
    "m_s2": "m/s2",
    "ms2": "m/s2",
    "mps2": "m/s2",
    "ut": "uT",
    "ns": "ns",
    "us": "us",
    "ms": "ms",
    "s": "s",
    "mm": "mm",
    "cm": "cm",
    "m": "m",
}
"""Units that some loggers append to a name: gyro_x_dps, t_ms, range_m. Of two that fit, the first is meant."""


@dataclass(frozen=True, kw_only=True)
class Group:
    """Columns of one name, one for each axis."""

    label: str
    columns: Mapping[str, int]
    unit: str | None


def simplified(name: str) -> tuple[str, str | None]:
    """A column's name in small letters, digits and underscores, without its unit; and its unit, if the name has one."""
    base, unit = units.split(name.lstrip("#"))
    simple = re.sub(r"[^a-z0-9]+", "_", base.lower()).strip("_")
    ending = next((end for end in SUFFIXES if simple.endswith(f"_{end}")), None)
    if unit is None and ending is not None:
        simple, unit = simple.removesuffix(f"_{ending}"), SUFFIXES[ending]
    return simple, unit


def chosen(table: Table, kind: str, axes: tuple[str, ...], choice: str) -> Group | None:
    """The columns of a quantity that a person has chosen, as `gyro=angular_velocity`; None for none.

    Raises ValueError, with the names of the table, for a name that is none of them.
    """
    name = choice.partition("=")[2].strip()
    if name == NONE:
        return None
    columns = _columns(table, axes, name)
    each = f" with {', '.join(axes)}" if len(axes) > 1 else ""
    rule = f"{table.source}: {kind}={name}: no column{'s' if each else ''} of that name{each}; {text.listed(table)}"
    require(columns is not None, rule)
    assert columns is not None
    return _group(table, axes, columns)


def options(table: Table, kind: str, axes: tuple[str, ...], free: Sequence[int]) -> tuple[str, ...]:
    """The choices among columns that are not used yet: each of them, or each name that has a column for every axis.

    If no name has, as many columns as there are axes that stand side by side.
    """
    if len(axes) == 1:
        return tuple(f"{kind}={table.names[column]}" for column in free)
    names = {column: simplified(table.names[column])[0] for column in free}
    prefixes = dict.fromkeys(name[:-1].rstrip("_") for name in names.values() if name[-1:] == axes[0])
    complete = [prefix for prefix in prefixes if prefix and _with_axes(names, axes, prefix) is not None]
    if complete:
        return tuple(f"{kind}={prefix}" for prefix in complete)
    runs = [[table.names[column + k] for k in range(len(axes)) if column + k in names] for column in free]
    return tuple(f"{kind}={','.join(run)}" for run in runs if len(run) == len(axes) and not any("," in n for n in run))


def _columns(table: Table, axes: tuple[str, ...], name: str) -> list[int] | None:
    """The columns of a name, one for each axis; None if there are none."""
    if len(axes) == 1:
        column = _column(table, name)
        return None if column is None else [column]
    parts = name.split(",")
    if len(parts) == len(axes):
        columns = [_column(table, part.strip()) for part in parts]
        return None if None in columns else [column for column in columns if column is not None]
    bare, unit = units.split(name)
    wanted = re.sub(r"[^a-z0-9]+", "_", bare.lower()).strip("_")
    split = [simplified(one) for one in table.names]
    names = {column: simple for column, (simple, own) in enumerate(split) if unit is None or own == unit}
    return _with_axes(names, axes, wanted)


def _column(table: Table, name: str) -> int | None:
    """The column of a name: exactly, or the only one that differs by its unit, by capitals or by marks."""
    if name in table.names:
        return table.names.index(name)
    wanted = {simplified(name)[0], re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")}
    split = [simplified(one) for one in table.names]
    near = [column for column, (simple, _) in enumerate(split) if simple in wanted]
    same = [column for column in near if split[column][1] == simplified(name)[1]]
    return next((of[0] for of in (near, same) if len(of) == 1), None)


def _with_axes(names: Mapping[int, str], axes: tuple[str, ...], prefix: str) -> list[int] | None:
    """The columns whose simplified name is a prefix and an axis, one for each axis; None if one is missing."""
    by_name = {name: column for column, name in reversed(list(names.items()))}
    both = [[by_name.get(f"{prefix}_{axis}", by_name.get(f"{prefix}{axis}")) for axis in axes]]
    return next(([c for c in columns if c is not None] for columns in both if None not in columns), None)


def _group(table: Table, axes: tuple[str, ...], columns: Sequence[int]) -> Group:
    split = [simplified(table.names[column]) for column in columns]
    stated = {unit for _, unit in split}
    if table.names[columns[0]] in table.dated:
        stated = {dates.UNIT}
    label = split[0][0] if len(axes) == 1 else split[0][0].removesuffix(axes[0]).rstrip("_")
    unit = stated.pop() if len(stated) == 1 else None
    return Group(label=label, columns=dict(zip(axes, columns, strict=True)), unit=unit)
