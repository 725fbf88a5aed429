"""Lossless arrays of a run, in the preset's own frame: NPZ, MATLAB .mat (v5, a struct), and plain CSV of t, p, v, a.

The plain CSV is read as well, as a path.
"""

import io
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from rangenav import __version__, preset, record
from rangenav.formats import reference, sampled_rows, text
from rangenav.formats.exported_run import ExportedRun, quaternions, run_of
from rangenav.formats.import_result import ImportResult, asked_frame
from rangenav.formats.output_files import OutputFile, write_bytes, write_text
from rangenav.formats.sampled_rows import FLIGHT, Part
from rangenav.preset import Preset

FIELDS = ("time", "position", "velocity", "acceleration", "jerk", "snap", "rotation", "angular_velocity")
MEASURED = ("gyro", "accel", "mag", "range_time", "range")
UNITS = (
    "s, m, rad, m/s², unit magnetic vector; gyro, accel, mag, angular_velocity in body axes; rotation body to inertial"
)
UNJUDGED = "the columns hold no jerk and no snap: a path that is read from this file again is not judged"
NAME = "rangenav"
"""Of the struct in a .mat file."""


def write_npz(chosen: Preset, path: Path) -> OutputFile:
    """Every array of the run, estimate included, named as by `rangenav simulate --save`."""
    with tempfile.TemporaryDirectory() as folder:
        archive = Path(folder) / "run.npz"
        record.save(record.run(chosen), archive)
        write_bytes(path, archive.read_bytes())
    return OutputFile(files=(path,), frame=_frame(run_of(chosen)))


def write_mat(chosen: Preset, path: Path) -> OutputFile:
    """One struct: meta, truth and measurements; quaternions wxyz, body to inertial."""
    from scipy.io import savemat

    run = run_of(chosen)
    content: dict[str, Any] = {name: getattr(run, name) for name in (*FIELDS, *MEASURED)}
    for name in ("time", "range_time", "range"):
        content[name] = content[name][:, None]
    content["quaternion_wxyz"] = quaternions(run)
    content["meta"] = {
        "format": f"rangenav {__version__}",
        "units": UNITS,
        "frame": _frame(run),
        "gravity": np.array(run.gravity),
        "magnetic": np.array(run.magnetic),
        "anchor": np.array(run.anchor),
        "seed": float(chosen.seed),
        "preset": preset.dumps(chosen),
    }
    data = io.BytesIO()
    savemat(data, {NAME: content}, do_compression=True, oned_as="column")
    write_bytes(path, data.getvalue())
    return OutputFile(files=(path,), frame=_frame(run), figures={"rows": len(run.time)})


def write_csv(chosen: Preset, path: Path) -> OutputFile:
    """A CSV file that every program can open: t, p, v, a."""
    run = run_of(chosen)
    names = ["t", *(f"{name}_{axis}" for name in "pva" for axis in "xyz")]
    table = np.column_stack([run.time, run.position, run.velocity, run.acceleration])
    rows = [",".join(repr(value) for value in row) for row in table.tolist()]
    write_text(path, "\n".join([",".join(names), *rows, ""]))
    return OutputFile(files=(path,), frame=_frame(run), notes=(UNJUDGED,), figures={"rows": len(rows)})


def parse_csv(
    data: bytes, *, source: str, confirm: Mapping[str, str], knots: float | None = None, part: Part = FLIGHT
) -> ImportResult:
    """The path of a plain CSV file: pieces of degree 5 through position, velocity and acceleration.

    Which way z points is asked: a run is written in the frame of its preset. Raises ValueError naming line and column.
    """
    table = text.with_si_names(text.table(data, source=source, header=reference.HEADER, drop="lines" in confirm))
    stamps = text.columns(table, ("t",))[:, 0]
    text.refuse_missing(np.column_stack([stamps, text.columns(table, reference.POSITION)]), table, "time or position")
    findings = list(table.remarks)
    rows = sampled_rows.sampled(
        table, stamps, unit="s", confirm=confirm, part=part, least=reference.LEAST_ROWS, findings=findings
    )
    findings.insert(0, rows.summary("m"))
    frame, questions = asked_frame(confirm, "the columns do not say, and a run is written in the frame of its preset")
    return reference.imported(rows, format="csv", frame=frame, knots=knots, findings=findings, questions=questions)


def _frame(run: ExportedRun) -> str:
    return run.frame or "gravity ({:g}, {:g}, {:g})".format(*run.gravity)
