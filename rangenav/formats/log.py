"""Logs as CSV: t, gyro, accel, mag, range and, if there is one, the truth. Columns have names, units stand in brackets.

    t [s],gyro_x [rad/s],…,accel_x [m/s2],…,mag_x [1],…,range [m],p_x [m],…,q_w,…     empty: no sample
Names of other loggers are understood (`Gyroscope X (deg/s)`, `acc_x`, `w_RS_S_x [rad s^-1]`, `#timestamp [ns]`).
Written: a run's measurements and truth in its own frame, with gravity, field and anchor in comments, so nothing is
asked when it is read again.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import flight_columns, frames, log_columns, text, world_comments
from rangenav.formats.exported_run import quaternions, run_of
from rangenav.formats.import_result import ImportResult, unread
from rangenav.formats.output_files import OutputFile, write_text
from rangenav.formats.raw_flight import FlightColumns
from rangenav.inputs import require
from rangenav.preset import Preset

HEADER = "t [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s2],accel_y [m/s2],accel_z [m/s2]"
"""An example of the first line: the columns that a flight has at least."""
NAMED, SHOWN = 10, 40
"""Most names that a finding lists, and most characters of each."""


def parse(data: bytes, *, source: str, confirm: Mapping[str, str]) -> ImportResult:
    """The flight of a file, or its questions. Raises ValueError naming line and column."""
    table = text.table(data, source=source, header=HEADER, drop="lines" in confirm)
    columns = log_columns.columns(table, confirm)
    values = {kind: columns.values(table, kind) for kind in log_columns.NAMES}
    lacking = [kind for kind in log_columns.NEEDED if values[kind] is None]
    asked = {question.key for question in columns.questions}
    for kind in lacking:
        missing = log_columns.lacking_text(kind, columns.groups.get(kind))
        known = log_columns.columns_key(kind) in asked
        require(known, f"{source}: no column for {missing}; {text.listed(table)}")
    if lacking:
        rows = len(table.values)
        return replace(unread(source, "log", questions=columns.questions, rows=rows), columns=columns.uses)
    findings = [*table.remarks, *_unused(columns.unused), *columns.findings]
    time, gyro, accel = values["time"], values["gyro"], values["accel"]
    assert time is not None
    assert gyro is not None
    assert accel is not None
    quaternion, distance = values["quaternion"], values["range"]
    world = world_comments.vectors(table)
    raw = FlightColumns(
        table=table,
        format="log",
        time=time[:, 0],
        gyro=gyro,
        accel=accel,
        mag=values["mag"],
        range=None if distance is None else distance[:, 0],
        rotation=None if quaternion is None else attitude(quaternion, source),
        position=values["position"],
        stated=columns.stated,
        frame=world_comments.frame(table),
        gravity=world.get("gravity"),
        magnetic=world.get("magnetic"),
        anchor=world.get("anchor"),
        findings=tuple(findings),
        unconfirmed=columns.unconfirmed,
        questions=columns.questions,
    )
    return replace(flight_columns.flight(raw, confirm), columns=columns.uses, applied=columns.applied)


def uses(data: bytes, *, source: str, confirm: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """Every column of a table, and the quantity that it is used for; empty if it is not used."""
    return log_columns.columns(text.table(data, source=source, header=HEADER, drop=True), confirm).uses


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
    rows = [",".join("" if value != value else repr(value) for value in row) for row in table.tolist()]
    write_text(path, "\n".join([*world_comments.written(run), ",".join(names), *rows, ""]))
    notes = ("truth is in the columns p and q (wxyz, body to inertial)",)
    return OutputFile(files=(path,), frame=run.frame or "as gravity says", notes=notes, figures={"rows": len(rows)})


_MEASURED = (("gyro", "rad/s"), ("accel", "m/s2"), ("mag", "1"))


def attitude(quaternion: Float[Array, "n 4"], source: str) -> Float[Array, "n 3 3"]:
    """Rotations of quaternions (wxyz), NaN where one is missing or all zero. Raises ValueError for other lengths."""
    size = np.linalg.norm(quaternion, axis=-1)
    lost = size == 0  # trackers write zeros where they have lost the body
    off = (np.abs(size - 1) > 0.1) & ~lost
    rule = f"{source}: quaternions must be of unit length, row {int(np.argmax(off)) + 1} has {size[np.argmax(off)]:.3g}"
    require(not off.any(), rule)
    return frames.to_rotation(np.where(lost[:, None], np.nan, quaternion))


def _unused(names: tuple[str, ...]) -> list[str]:
    """The first columns that are not used; the whole list is in the result."""
    if not names:
        return []
    more = f" … ({len(names)} in all)" if len(names) > NAMED else ""
    return [f"columns not understood and not used: {', '.join(name[:SHOWN] for name in names[:NAMED])}{more}"]
