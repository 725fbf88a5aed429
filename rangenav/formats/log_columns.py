"""Which columns of a log hold what, by their names. Where several would do, a person chooses.

A name is split into what it measures, its axis and its unit: `Linear Acceleration X (m/s^2)`, `gyro_x_dps`, `t_ms`.
Names of a pose say that it is the truth (`p_x` and `q_w` of our own logs, `truth_…`, `gt_…`, `opt_…`, EuRoC's
`p_RS_R_x`), or do not (`orientation_w`, `pos_x`): a pose of the latter kind may be an estimate, and is asked about.
"""

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy import ndarray as Array

from rangenav.formats import chosen_columns, dates, text, units
from rangenav.formats.chosen_columns import Group
from rangenav.formats.import_result import Question
from rangenav.formats.text import Table
from rangenav.inputs import require
from rangenav.results import result

TOPIC = "field_"
"""Before the names of a ROS topic that is written as a table."""
TRUE = r"(?:opt_|truth_|true_|gt_|groundtruth_|ground_truth_)"
NAMES = {
    "time": re.compile(r"(t|time|timestamp|stamp|sec|seconds|utc|datetime|date_time)"),
    "gyro": re.compile(r"(?:imu_)?(?:gyro|gyr|gyroscope|angular_velocity|omega|w|g|w_rs_s)_?([xyz])"),
    "accel": re.compile(r"(?:imu_)?(?:accel|acc|accelerometer|acceleration|linear_acceleration|a|a_rs_s)_?([xyz])"),
    "mag": re.compile(r"(?:imu_)?(?:mag|magn|magnetometer|magnetic|magnetic_field|m)_?([xyz])"),
    "range": re.compile(r"((?:uwb_)?(?:range|distance|dist)(?:_?\d+)?|uwb|d)"),
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
NEEDED = ("time", "gyro", "accel")
"""What a flight has at least."""
OPTIONAL = ("range", "mag")
"""Optional quantities of a flight, which a person may find in columns of other names."""
SHOWN = 40
"""Most characters of a name."""


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
    applied: tuple[Question, ...]
    """Questions about columns of optional quantities; a quantity is left out unless a person names its columns."""
    findings: tuple[str, ...]
    """The columns that a person has chosen."""

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
    """The columns by their names. Raises ValueError where names or their units contradict one another.

    A person's choice of a quantity's columns overrules the names, also those of other quantities.
    """
    answered = {kind: confirm[columns_key(kind)] for kind in NAMES if columns_key(kind) in confirm}
    found = _by_names(table, lenient=tuple(answered))
    chosen = {kind: chosen_columns.chosen(table, kind, AXES[kind], text) for kind, text in answered.items()}
    taken = {column for group in chosen.values() if group is not None for column in group.columns.values()}
    groups, questions = {}, []
    for kind in NAMES:
        if kind in chosen:
            group = chosen[kind]
        else:
            named = {key: one for key, one in found.get(kind, {}).items() if not taken.intersection(one.values())}
            group = _chosen(table, kind, _candidates(table, kind, named), questions) if named else None
        if group is not None:
            groups[kind] = group
    uses = {column: kind for kind, group in groups.items() for column in group.columns.values()}
    poses = [groups[kind] for kind in ("position", "quaternion") if kind in groups]
    doubtful = [column for group in poses if not TRUTH.fullmatch(group.label) for column in group.columns.values()]
    free = [column for column in range(len(table.names)) if column not in uses]
    return LogColumns(
        groups=groups,
        stated={kind: group.unit for kind, group in groups.items() if group.unit is not None and kind in units.UNITS},
        uses=tuple((name, uses.get(column, "")) for column, name in enumerate(table.names)),
        unconfirmed=tuple(table.names[column] for column in sorted(doubtful)),
        questions=(*questions, *_missing(table, groups, free)),
        applied=_absent(table, groups, free, answered),
        findings=tuple(_confirmed(table, kind, group) for kind, group in chosen.items()),
    )


def _by_names(table: Table, *, lenient: tuple[str, ...]) -> dict[str, dict[tuple[str, str | None], dict[str, int]]]:
    """The columns by what their names say: by quantity, by label and unit, by axis. lenient: quantities that a person
    chooses.

    Raises ValueError for two columns of one name.
    """
    found: dict[str, dict[tuple[str, str | None], dict[str, int]]] = {}
    for column, name in enumerate(table.names):
        kind, axis, label, unit = _understood(name)
        if kind is None:
            continue
        if name in table.dated:
            unit = dates.UNIT
        group = found.setdefault(kind, {}).setdefault((label, unit), {})
        require(axis not in group or kind in lenient, _second(table, kind, axis, column))
        group[axis] = column
    return found


def _understood(name: str) -> tuple[str | None, str, str, str | None]:
    """Quantity, axis, label and unit of a column's name."""
    simple, unit = chosen_columns.simplified(name)
    simple = simple.removeprefix(TOPIC)
    for kind, pattern in NAMES.items():
        if match := pattern.fullmatch(simple):
            if AXES[kind] == ("",):
                return kind, "", simple, unit
            return kind, match[1], simple[: match.start(1)].rstrip("_"), unit
    return None, "", simple, unit


def _missing(table: Table, groups: Mapping[str, Group], free: list[int]) -> list[Question]:
    """The questions which columns hold what a flight needs, where other quantities show that the table is a flight."""
    lacking = [kind for kind in NEEDED if kind not in groups or set(groups[kind].columns) != set(AXES[kind])]
    if len(lacking) == len(NEEDED) or len(free) < sum(len(AXES[kind]) for kind in lacking):
        return []
    questions = []
    for kind in lacking:
        options = chosen_columns.options(table, kind, AXES[kind], free)
        if options:
            listed = "" if questions else f"; {text.listed(table)}"
            evidence = f"no column for {lacking_text(kind, groups.get(kind))}{listed}"
            questions.append(_question(kind, options, evidence))
    return questions


def lacking_text(kind: str, group: Group | None) -> str:
    """What is missing of a quantity that has not all its columns."""
    there = {} if group is None else group.columns
    missing = [axis for axis in AXES[kind] if axis not in there]
    return "the time" if kind == "time" else f"{kind} {', '.join(missing)}"


def _absent(
    table: Table, groups: Mapping[str, Group], free: list[int], answered: Mapping[str, str]
) -> tuple[Question, ...]:
    """The questions about columns of optional quantities; by default no column holds them."""
    questions = []
    for kind in OPTIONAL:
        if kind in groups and kind not in answered:
            continue
        own = tuple(groups[kind].columns.values()) if kind in groups else ()
        options = chosen_columns.options(table, kind, AXES[kind], sorted({*free, *own}))
        if options:
            none = f"{kind}={chosen_columns.NONE}"
            evidence = "no column has a name that says so"
            questions.append(replace(_question(kind, (none, *options), evidence), suggestion=none))
    return tuple(questions)


def _confirmed(table: Table, kind: str, group: Group | None) -> str:
    """That a person has chosen the columns of a quantity."""
    names = [] if group is None else [table.names[column][:SHOWN] for column in group.columns.values()]
    return f"columns of {units.WORDS.get(kind, kind)}: {', '.join(names) or 'none'}, as confirmed"


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


def _chosen(table: Table, kind: str, candidates: list[Group], questions: list[Question]) -> Group:
    """The first of the candidates; where there are several, there is a question."""
    if len(candidates) > 1:
        evidence = "; ".join(f"{group.label}: {_reading(table, kind, group)}" for group in candidates)
        questions.append(_question(kind, tuple(f"{kind}={group.label}" for group in candidates), evidence))
    return candidates[0]


def _question(kind: str, options: tuple[str, ...], evidence: str) -> Question:
    return Question(
        key=columns_key(kind),
        flag="--columns",
        asks=f"which columns are {units.WORDS.get(kind, f'the {kind}')}",
        options=options,
        suggestion=None,
        evidence=evidence,
    )


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
