"""TUM trajectories: `t x y z qx qy qz qw`, seconds, blanks between, # for comments. Which way z points is not said.

Read: positions only, as a curve through knots (see `spline_fit`). Written: the true poses of a run, z-up, in seconds
from its beginning.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from rangenav.formats import sampled_positions, sampled_rows, text
from rangenav.formats.exported_run import quaternions, upright_run
from rangenav.formats.import_result import ImportResult, asked_frame
from rangenav.formats.output_files import OutputFile, write_text
from rangenav.formats.sampled_rows import FLIGHT, Part
from rangenav.preset import Preset

NAMES = ("t", "x", "y", "z", "qx", "qy", "qz", "qw")
UNJUDGED = "poses hold no snap: a path that is read from this file again is not judged"
LEAST_ROWS = 8
LARGEST = 1e5
"""m"""


def parse(
    data: bytes, *, source: str, confirm: Mapping[str, str], knots: float | None = None, part: Part = FLIGHT
) -> ImportResult:
    """The path of a file. Raises ValueError naming line and column."""
    table = text.table(data, source=source, separator=" ", names=NAMES, drop="lines" in confirm)
    text.refuse_missing(table.values, table, "a number")
    findings = list(table.remarks)
    rows = sampled_rows.sampled(
        table, table.values[:, 0], unit="s", confirm=confirm, part=part, least=LEAST_ROWS, findings=findings
    )
    findings.insert(0, rows.summary("m"))
    off = np.abs(np.linalg.norm(rows.table.values[:, 4:], axis=-1) - 1) > 1e-2
    if off.any():
        findings.append(f"{int(off.sum())} quaternions are not of unit length; the path does not need them")
    frame, questions = asked_frame(confirm, "poses do not say, ROS and motion capture are z-up")
    return sampled_positions.imported(
        rows,
        rows.table.values[:, 1:4],
        format="tum",
        largest=LARGEST,
        frame=frame,
        knots=knots,
        findings=findings,
        questions=questions,
    )


def write(preset: Preset, path: Path) -> OutputFile:
    """Write the true poses of the preset's run at the IMU's rate."""
    run = upright_run(preset)
    q = np.roll(quaternions(run), -1, axis=-1)
    table = np.column_stack([run.time, run.position, q])
    rows = [" ".join(f"{value:.9f}" for value in row) for row in table]
    write_text(path, "\n".join(["# t x y z qx qy qz qw (s, m, z-up, body to world)", *rows, ""]))
    return OutputFile(files=(path,), frame="z-up", notes=(UNJUDGED,), figures={"rows": len(rows)})
