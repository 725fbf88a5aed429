"""TUM trajectories: `t x y z qx qy qz qw`, seconds, blanks between, # for comments. Which way z points is not said.

Read: positions only, as a curve through knots (see `spline_fit`). Written: the true poses of a run, z-up, in seconds
from its beginning.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from rangenav.formats import spline_fit, text
from rangenav.formats.exported_run import quaternions, upright_run
from rangenav.formats.import_result import ImportResult, Question, answer, in_order, spacing
from rangenav.formats.output_files import OutputFile, write_text
from rangenav.inputs import require
from rangenav.preset import Preset

NAMES = ("t", "x", "y", "z", "qx", "qy", "qz", "qw")
FRAMES = ("z-up", "z-down")
LEAST_ROWS = 8
LARGEST = 1e5
"""m"""


def parse(data: bytes, *, source: str, confirm: Mapping[str, str], knots: float | None = None) -> ImportResult:
    """The path of a file. Raises ValueError naming line and column."""
    table = text.table(data, source=source, separator=" ", names=NAMES)
    text.refuse_missing(table.values, table, "a number")
    time, position = table.values[:, 0], table.values[:, 1:4]
    require(len(time) >= LEAST_ROWS, f"{source}: {len(time)} poses are no path")
    dropped: list[str] = []
    table, broken = in_order(table, time, confirm, dropped)
    time, position = table.values[:, 0], table.values[:, 1:4]
    require(len(time) >= LEAST_ROWS, f"{source}: {len(time)} poses with increasing stamps are no path")
    require(float(np.abs(position).max()) <= LARGEST, f"{source}: positions must lie within {LARGEST:g} m")
    findings = [f"{len(time)} poses, {time[-1] - time[0]:.4g} s; m and s as the format has it", *dropped]
    rate = spacing(time, table, findings)
    off = np.abs(np.linalg.norm(table.values[:, 4:], axis=-1) - 1) > 1e-2
    if off.any():
        findings.append(f"{int(off.sum())} quaternions are not of unit length; the path does not need them")
    curve = spline_fit.fit(time, position, spacing=knots, source=source)
    findings.append(curve.summary)
    frame = answer(confirm, "frame", FRAMES)
    question = Question(
        key="frame",
        flag="--frame",
        asks="which way does z point",
        options=FRAMES,
        suggestion="z-up",
        evidence="poses do not say, ROS and motion capture are z-up",
    )
    return ImportResult(
        source=source,
        format="tum",
        rows=len(time),
        rate=rate,
        duration=float(time[-1] - time[0]),
        frame="z-down" if frame == "z-down" else "z-up",
        findings=tuple(findings),
        questions=(*broken, *(() if frame else (question,))),
        path=curve.path,
        derivatives="fit",
        fitted=curve.summary,
        fit_error=curve.largest,
        unjudged=spline_fit.unjudged(time, position),
    )


def write(preset: Preset, path: Path) -> OutputFile:
    """Write the true poses of the preset's run at the IMU's rate."""
    run = upright_run(preset)
    q = np.roll(quaternions(run), -1, axis=-1)
    table = np.column_stack([run.time, run.position, q])
    rows = [" ".join(f"{value:.9f}" for value in row) for row in table]
    write_text(path, "\n".join(["# t x y z qx qy qz qw (s, m, z-up, body to world)", *rows, ""]))
    return OutputFile(files=(path,), frame="z-up", figures={"rows": len(rows)})
