"""Logs as CSV: t, gyro, accel, mag, range and, if there is one, the truth. Columns have names, units stand in brackets.

    t [s],gyro_x [rad/s],…,accel_x [m/s2],…,mag_x [1],…,range [m],p_x [m],…,q_w,…     empty: no sample
Names of other loggers are understood (`Gyroscope X (deg/s)`, `acc_x`, `w_RS_S_x [rad s^-1]`, `#timestamp [ns]`).
Written: a run's measurements and truth in its own frame, with gravity, field and anchor in comments, so nothing is
asked when it is read again.
"""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import flight_columns, frames, text, units
from rangenav.formats.exported_run import quaternions, run_of
from rangenav.formats.flight_columns import FlightColumns
from rangenav.formats.import_result import ImportResult
from rangenav.formats.output_files import OutputFile, write_text
from rangenav.formats.recorded_flight import Frame
from rangenav.formats.text import Table
from rangenav.inputs import Vec3, require
from rangenav.preset import Preset

NAMES = {
    "time": re.compile(r"(t|time|timestamp|stamp|sec|seconds)"),
    "gyro": re.compile(r"(?:imu_)?(?:gyro|gyr|gyroscope|angular_velocity|omega|w|g|w_rs_s)_?([xyz])"),
    "accel": re.compile(r"(?:imu_)?(?:accel|acc|accelerometer|acceleration|linear_acceleration|a|a_rs_s)_?([xyz])"),
    "mag": re.compile(r"(?:imu_)?(?:mag|magn|magnetometer|magnetic|magnetic_field|m)_?([xyz])"),
    "range": re.compile(r"(range|distance|dist|uwb|uwb_range|d)"),
    "position": re.compile(r"(?:opt_|truth_|gt_)?(?:p|pos|position|p_rs_r)_?([xyz])"),
    "quaternion": re.compile(r"(?:opt_|truth_|gt_)?(?:q|quat|quaternion|orientation|q_rs)_?([wxyz])"),
}
SUFFIXES = {
    "dps": "deg/s",
    "rads": "rad/s",
    "ms2": "m/s2",
    "mps2": "m/s2",
    "ut": "uT",
    "ns": "ns",
    "us": "us",
    "ms": "ms",
    "s": "s",
}
"""Units that some loggers append to a name: gyro_x_dps, t_ms."""
WORLD = re.compile(r"(gravity|magnetic|anchor)\s*=\s*(\S+)\s+(\S+)\s+(\S+)")
FRAME = re.compile(r"frame\s*=\s*(z-up|z-down)")
LARGEST = 1e9


def parse(data: bytes, *, source: str, confirm: Mapping[str, str]) -> ImportResult:
    """The flight of a file, or its questions. Raises ValueError naming line and column."""
    table = text.table(data, source=source)
    groups, stated, unknown = _grouped(table)
    for kind, axes in (("gyro", "xyz"), ("accel", "xyz")):
        missing = [axis for axis in axes if axis not in groups.get(kind, {})]
        require(not missing, f"{source}: no column for {kind} {', '.join(missing)}; {text.listed(table)}")
    require("time" in groups, f"{source}: no column for the time; {text.listed(table)}")
    findings = [*table.remarks, *([f"columns not understood and not used: {', '.join(unknown)}"] if unknown else [])]
    quaternion = _vector(table, groups, "quaternion", "wxyz")
    world = _world(table)
    raw = FlightColumns(
        table=table,
        format="log",
        time=table.values[:, next(iter(groups["time"].values()))],
        gyro=_needed(table, groups, "gyro"),
        accel=_needed(table, groups, "accel"),
        mag=_vector(table, groups, "mag", "xyz"),
        range=table.values[:, next(iter(groups["range"].values()))] if "range" in groups else None,
        rotation=None if quaternion is None else attitude(quaternion, source),
        position=_vector(table, groups, "position", "xyz"),
        stated=stated,
        frame=_stated_frame(table),
        gravity=world.get("gravity"),
        magnetic=world.get("magnetic"),
        anchor=world.get("anchor"),
        findings=tuple(findings),
    )
    return flight_columns.flight(raw, confirm)


def write(preset: Preset, path: Path) -> OutputFile:
    """Write the measurements of the preset's run, and the truth."""
    run = run_of(preset)
    every = np.union1d(run.time, run.range_time)
    table = np.full((len(every), 18), np.nan)
    at, ranged = np.searchsorted(every, run.time), np.searchsorted(every, run.range_time)
    table[:, 0] = every
    table[at, 1:10] = np.column_stack([run.gyro, run.accel, run.mag])
    table[ranged, 10] = run.range
    table[at, 11:18] = np.column_stack([run.position, quaternions(run)])
    names = ["t [s]", *(f"{name}_{a} [{unit}]" for name, unit in _MEASURED for a in "xyz"), "range [m]"]
    names += [*(f"p_{a} [m]" for a in "xyz"), *(f"q_{a} [1]" for a in "wxyz")]
    comments = [f"# frame = {run.frame}"] if run.frame else []
    for name in ("gravity", "magnetic", "anchor"):
        comments.append(f"# {name} = " + " ".join(repr(value) for value in getattr(run, name)))
    rows = [",".join("" if value != value else repr(value) for value in row) for row in table.tolist()]
    write_text(path, "\n".join([*comments, ",".join(names), *rows, ""]))
    notes = ("truth is in the columns p and q (wxyz, body to inertial)",)
    return OutputFile(files=(path,), frame=run.frame or "as gravity says", notes=notes, figures={"rows": len(rows)})


_MEASURED = (("gyro", "rad/s"), ("accel", "m/s2"), ("mag", "1"))


def attitude(quaternion: Float[Array, "n 4"], source: str) -> Float[Array, "n 3 3"]:
    """Rotations of quaternions (wxyz), NaN where one is missing. Raises ValueError for lengths far from one."""
    size = np.linalg.norm(quaternion, axis=-1)
    off = np.abs(size - 1) > 0.1
    rule = f"{source}: quaternions must be of unit length, row {int(np.argmax(off)) + 1} has {size[np.argmax(off)]:.3g}"
    require(not off.any(), rule)
    return frames.to_rotation(quaternion)


def _grouped(table: Table) -> tuple[dict[str, dict[str, int]], dict[str, str], list[str]]:
    """The column of each quantity, the units that the names state, and the names that are not understood."""
    groups: dict[str, dict[str, int]] = {}
    stated: dict[str, str] = {}
    unknown = []
    for column, name in enumerate(table.names):
        base, unit = units.split(name.lstrip("#"))
        plain = re.sub(r"[^a-z0-9]+", "_", base.lower()).strip("_")
        head, _, tail = plain.rpartition("_")
        if unit is None and tail in SUFFIXES:
            plain, unit = head, SUFFIXES[tail]
        for kind, pattern in NAMES.items():
            match = pattern.fullmatch(plain)
            if match:
                axis = match[1] if kind not in ("time", "range") else kind
                rule = f"{table.source}: two columns could be {kind} {axis}: {name[:40]!r} is the second"
                require(axis not in groups.setdefault(kind, {}), rule)
                groups[kind][axis] = column
                _state(stated, kind, unit, table.source)
                break
        else:
            unknown.append(name[:40])
    return groups, stated, unknown[:10]


def _state(stated: dict[str, str], kind: str, unit: str | None, source: str) -> None:
    if unit is None or kind not in units.UNITS:
        return
    require(
        stated.get(kind, unit) == unit, f"{source}: {units.WORDS[kind]} has columns in {stated.get(kind)} and {unit}"
    )
    stated[kind] = unit


def _vector(table: Table, groups: dict[str, dict[str, int]], kind: str, axes: str) -> Array | None:
    if not all(axis in groups.get(kind, {}) for axis in axes):
        return None
    return table.values[:, [groups[kind][axis] for axis in axes]]


def _needed(table: Table, groups: dict[str, dict[str, int]], kind: str) -> Float[Array, "n 3"]:
    return table.values[:, [groups[kind][axis] for axis in "xyz"]]


def _stated_frame(table: Table) -> Frame | None:
    for comment in table.comments:
        if match := FRAME.fullmatch(comment):
            return "z-up" if match[1] == "z-up" else "z-down"
    return None


def _world(table: Table) -> dict[str, Vec3]:
    """Gravity, field and anchor from the comments in front."""
    world: dict[str, Vec3] = {}
    for comment in table.comments:
        if match := WORLD.fullmatch(comment):
            try:
                x, y, z = (float(part) for part in match.groups()[1:])
            except ValueError:
                raise ValueError(f"{table.source}: {match[1]} must be three numbers, got {comment[:60]!r}") from None
            fine = all(abs(value) <= LARGEST for value in (x, y, z))
            require(fine, f"{table.source}: {match[1]} must be three finite numbers, got {comment[:60]!r}")
            world[match[1]] = (x, y, z)
    return world
