"""Which columns of a log hold what, by their names. Where several would do, a person chooses.

A name is split into what it measures, its axis and its unit: `Linear Acceleration X (m/s^2)`, `gyro_x_dps`, `t_ms`.
Names of a pose say that it is the truth (`p_x` and `q_w` of our own logs, `truth_…`, `gt_…`, `opt_…`, EuRoC's
`p_RS_R_x`), or do not (`orientation_w`, `pos_x`): a pose of the latter kind may be an estimate, and is asked about.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy import ndarray as Array

from rangenav.formats import units
from rangenav.formats.import_result import Question, answer
from rangenav.formats.text import Table
from rangenav.inputs import require
from rangenav.results import result

TRUE = r"(?:opt_|truth_|true_|gt_|groundtruth_|ground_truth_)"
NAMES = {
    "time": re.compile(r"(t|time|timestamp|stamp|sec|seconds)"),
    "gyro": re.compile(r"(?:imu_)?(?:gyro|gyr|gyroscope|angular_velocity|omega|w|g|w_rs_s)_?([xyz])"),
    "accel": re.compile(r"(?:imu_)?(?:accel|acc|accelerometer|acceleration|linear_acceleration|a|a_rs_s)_?([xyz])"),
    "mag": re.compile(r"(?:imu_)?(?:mag|magn|magnetometer|magnetic|magnetic_field|m)_?([xyz])"),
    "range": re.compile(r"(range|distance|dist|uwb|uwb_range|d)"),
    "position": re.compile(rf"{TRUE}?(?:p|pos|position|p_rs_r)_?([xyz])"),
    "quaternion": re.compile(rf"{TRUE}?(?:q|quat|quaternion|orientation|q_rs)_?([wxyz])"),
}
XYZ = ("x", "y", "z")
AXES = {
    "time": ("",),
    "gyro": XYZ,
    "accel": XYZ,
    "mag": XYZ,
    "range": ("",),
    "position": XYZ,
    "quaternion": ("w", *XYZ),
}
"""The axes of each quantity; a nameless one for a single column."""
TRUTH = re.compile(rf"{TRUE}.*|p|p_rs_r|q|q_rs")
"""Names of poses that say that they are the truth."""
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
SHOWN = 40
"""Most characters of a name."""


@dataclass(frozen=True, kw_only=True)
class Group:
    """Columns of one name, one for each axis."""

    label: str
    columns: Mapping[str, int]
    unit: str | None


@result
class LogColumns:
    """The columns of a table by what they hold."""

    groups: Mapping[str, Group]
    """By quantity."""
    stated: Mapping[str, str]
    """The unit of each quantity that the names state."""
    uses: tuple[tuple[str, str], ...]
    """The name of every column, and the quantity that it is used for; empty if it is not used."""
    unconfirmed: tuple[str, ...]
    """Columns of poses whose names do not say that they are the truth."""
    questions: tuple[Question, ...]

    @property
    def unused(self) -> tuple[str, ...]:
        """The names of the columns that are not used."""
        return tuple(name for name, use in self.uses if not use)

    def values(self, table: Table, kind: str) -> Array | None:
        """The columns of a quantity, in the order of its axes; None without all of them."""
        group = self.groups.get(kind)
        if group is None or set(group.columns) != set(AXES[kind]):
            return None
        return table.values[:, [group.columns[axis] for axis in AXES[kind]]]


def columns(table: Table, confirm: Mapping[str, str]) -> LogColumns:
    """The columns by their names. Raises ValueError where names or their units contradict one another."""
    found: dict[str, dict[tuple[str, str | None], dict[str, int]]] = {}
    for column, name in enumerate(table.names):
        kind, axis, label, unit = _understood(name)
        if kind is None:
            continue
        group = found.setdefault(kind, {}).setdefault((label, unit), {})
        require(axis not in group, _second(table, kind, axis, column))
        group[axis] = column
    groups, questions = {}, []
    for kind, named in found.items():
        candidates = _candidates(table, kind, named)
        groups[kind] = _chosen(table, kind, candidates, confirm, questions)
    uses = {column: kind for kind, group in groups.items() for column in group.columns.values()}
    poses = [groups[kind] for kind in ("position", "quaternion") if kind in groups]
    doubtful = [column for group in poses if not TRUTH.fullmatch(group.label) for column in group.columns.values()]
    return LogColumns(
        groups=groups,
        stated={kind: group.unit for kind, group in groups.items() if group.unit is not None and kind in units.UNITS},
        uses=tuple((name, uses.get(column, "")) for column, name in enumerate(table.names)),
        unconfirmed=tuple(table.names[column] for column in sorted(doubtful)),
        questions=tuple(questions),
    )


def _understood(name: str) -> tuple[str | None, str, str, str | None]:
    """Quantity, axis, label and unit of a column's name."""
    base, unit = units.split(name.lstrip("#"))
    simple = re.sub(r"[^a-z0-9]+", "_", base.lower()).strip("_")
    ending = next((end for end in SUFFIXES if simple.endswith(f"_{end}")), None)
    if unit is None and ending is not None:
        simple, unit = simple.removesuffix(f"_{ending}"), SUFFIXES[ending]
    for kind, pattern in NAMES.items():
        if match := pattern.fullmatch(simple):
            if AXES[kind] == ("",):
                return kind, "", simple, unit
            return kind, match[1], simple[: match.start(1)].rstrip("_"), unit
    return None, "", simple, unit


def _candidates(table: Table, kind: str, named: Mapping[tuple[str, str | None], Mapping[str, int]]) -> list[Group]:
    """Every name that has a column for each axis; if there is none, the columns of all names together."""
    complete = {key: group for key, group in named.items() if set(group) == set(AXES[kind])}
    if complete:
        labels = [label for label, _ in complete]
        return [
            Group(label=label if labels.count(label) == 1 else f"{label}[{unit}]", columns=group, unit=unit)
            for (label, unit), group in complete.items()
        ]
    joined: dict[str, int] = {}
    for group in named.values():
        for axis, column in group.items():
            require(axis not in joined, _second(table, kind, axis, column))
            joined[axis] = column
    stated = list(dict.fromkeys(unit for _, unit in named if unit is not None))
    rule = f"{table.source}: {units.WORDS.get(kind, kind)} has columns in {' and '.join(stated)}"
    require(len(stated) <= 1, rule)
    return [Group(label=next(iter(named))[0], columns=joined, unit=stated[0] if stated else None)]


def _chosen(
    table: Table, kind: str, candidates: list[Group], confirm: Mapping[str, str], questions: list[Question]
) -> Group:
    options = tuple(f"{kind}={group.label}" for group in candidates)
    answered = answer(confirm, columns_key(kind), options)
    if answered is not None:
        return candidates[options.index(answered)]
    if len(candidates) > 1:
        evidence = "; ".join(f"{group.label}: {_reading(table, kind, group)}" for group in candidates)
        asks = f"which columns are {units.WORDS.get(kind, f'the {kind}')}"
        questions.append(
            Question(
                key=columns_key(kind), flag="--columns", asks=asks, options=options, suggestion=None, evidence=evidence
            )
        )
    return candidates[0]


def columns_key(kind: str) -> str:
    """The key of the question which columns hold a quantity."""
    return f"{kind}-columns"


def _second(table: Table, kind: str, axis: str, column: int) -> str:
    name = table.names[column][:SHOWN]
    return f"{table.source}: two columns could be {f'{kind} {axis}'.strip()}: {name!r} is the second"


def _reading(table: Table, kind: str, group: Group) -> str:
    values = table.values[:, list(group.columns.values())]
    if kind == "time":
        steps = np.diff(values[np.isfinite(values[:, 0]), 0])
        return f"usual step {np.median(steps):.3g}" if len(steps) else "no stamps"
    lengths = np.linalg.norm(values, axis=-1)
    lengths = lengths[np.isfinite(lengths)]
    return f"median {'length ' if len(group.columns) > 1 else ''}{np.median(lengths):.3g}" if len(lengths) else "empty"
