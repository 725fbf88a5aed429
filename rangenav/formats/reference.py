"""Reference CSV (Agilicious and RPG planners; GTSAM's DiscreteScenario reads it too): a trajectory by column name.

    t, p_*, q_wxyz, v_*, w_*, a_lin_*, a_rot_*, jerk_*, snap_*, and a_* for GTSAM
z-up, q body → world, w body, a without g.
Columns are found by their names, whatever their order. A path is read as pieces: see `reference_fit`. Columns of
nothing but zeros are taken as missing, with a remark; without jerk no excitation is judged. Motor thrusts (u_*) need a
mass that no preset has, and are not written.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import motion
from rangenav.axes import upright
from rangenav.formats import frames, hover_ramps, reference_fit, sampled_rows, text
from rangenav.formats.import_result import ImportResult, Question
from rangenav.formats.output_files import Attitudes, Draft, ExportOptions, OutputFile, write_text
from rangenav.formats.recorded_flight import Frame
from rangenav.formats.sampled_rows import FLIGHT, Part, SampledRows
from rangenav.formats.text import Table
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.signals import Flown

RATE = 100.0
"""Hz: the rate at which the planners write."""
POSITION = ("p_x", "p_y", "p_z")
HEADER = "t,p_x,p_y,p_z"
"""An example of the first line: the columns that a path has at least."""
COLUMNS = {name: tuple(f"{name}_{axis}" for axis in "xyz") for name in ("v", "a_lin", "a", "jerk", "snap")}
DERIVATIVES = {"velocity": ("v",), "acceleration": ("a_lin", "a"), "jerk": ("jerk",), "snap": ("snap",)}
"""The columns of each derivative; of several the first that is there. GTSAM calls the acceleration a."""
QUATERNION = ("q_w", "q_x", "q_y", "q_z")
LEAST_ROWS = 3
LARGEST = 1e6
"""SI: no trajectory has a larger position or derivative."""


def parse(
    data: bytes,
    *,
    source: str,
    confirm: Mapping[str, str] | None = None,
    knots: float | None = None,
    part: Part = FLIGHT,
) -> ImportResult:
    """The path of a file. Raises ValueError naming line and column."""
    drop = None if confirm is None else "lines" in confirm
    table = text.with_si_names(text.table(data, source=source, header=HEADER, drop=drop))
    stamps = text.columns(table, ("t",))[:, 0]
    text.refuse_missing(np.column_stack([stamps, text.columns(table, POSITION)]), table, "time or position")
    findings = list(table.remarks)
    rows = sampled_rows.sampled(
        table, stamps, unit="s", confirm=confirm or {}, part=part, least=LEAST_ROWS, findings=findings
    )
    findings.insert(0, rows.summary("m, z-up, body → world"))
    _check_quaternion(rows.table, findings)
    found = imported(rows, format="reference", frame="z-up", knots=knots, findings=findings)
    if part != FLIGHT or found.path is None or not hover_ramps.recognised(found.path, found.duration):
        return found
    steady = (hover_ramps.RAMP, found.duration - hover_ramps.RAMP)
    found = parse(data, source=source, confirm=confirm, knots=knots, part=steady)
    return replace(found, findings=(found.findings[0], hover_ramps.left_out(hover_ramps.RAMP), *found.findings[1:]))


def imported(
    rows: SampledRows,
    *,
    format: str,
    frame: Frame,
    knots: float | None,
    findings: list[str],
    questions: tuple[Question, ...] = (),
) -> ImportResult:
    """What was read from rows with derivatives: the path, or the questions without whose answers there is none."""
    source, position = rows.table.source, text.columns(rows.table, POSITION)
    derivatives = [_derivative(rows.table, names, word, findings) for word, names in DERIVATIVES.items()]
    for values in (position, *(one for one in derivatives if one is not None)):
        require(float(np.abs(values).max()) <= LARGEST, f"{source}: position or a derivative exceeds {LARGEST:g} (SI)")
    path, fit_error, fit_text, unjudged = None, None, "", reference_fit.UNJUDGED
    if rows.fits:
        path, fit_error, fit_text, unjudged = reference_fit.path_through(
            rows.time, position, derivatives, knots, source, findings
        )
    return ImportResult(
        source=source,
        format=format,
        rows=len(rows.time),
        rate=rows.rate,
        duration=float(rows.time[-1]),
        frame=frame,
        findings=tuple(findings),
        questions=(*rows.questions, *questions),
        path=path,
        derivatives="file" if unjudged is None else "fit",
        fitted=fit_text,
        fit_error=fit_error,
        unjudged=unjudged,
    )


def drafts(preset: Preset, options: ExportOptions) -> Iterator[Draft]:
    """The one way to write a path: its whole flight."""
    yield lambda path: write(preset, path, attitude=options.attitude, ramp=options.ramp)


def write(preset: Preset, path: Path, *, attitude: Attitudes = "flown", ramp: float = hover_ramps.RAMP) -> OutputFile:
    """Write the path and its ramps at 100 Hz. By default the attitude is that of a multirotor which flies the path.

    Raises ValueError where that has no answer (a free fall); `attitude="preset"` writes the preset's own, unramped.
    """
    turned = upright(preset)
    window = turned.requirement.window
    if attitude == "preset":
        course = hover_ramps.HoverRamps(path=turned.path, duration=turned.duration, ramp=0.0)
    else:
        course = hover_ramps.with_ramps(turned.path, turned.duration, window=window, ramp=ramp)
    t = np.append(np.arange(0, course.end - 1e-9, 1 / RATE), course.end)
    rotation, rate, second = _attitude(turned, course, t, attitude)
    p, v, a, j, s = (course(t, order) for order in range(5))
    q = frames.continuous(frames.from_rotation(rotation))
    names = ["t", *POSITION, *QUATERNION, *COLUMNS["v"], "w_x", "w_y", "w_z", *COLUMNS["a_lin"]]
    names += [*(f"a_rot_{axis}" for axis in "xyz"), *COLUMNS["jerk"], *COLUMNS["snap"], *COLUMNS["a"]]
    table = np.column_stack([t, p, q, v, rate, a, second, j, s, a])
    rows = [",".join(repr(value) for value in row) for row in table.tolist()]
    write_text(path, "\n".join([",".join(names), *rows, ""]))
    notes = [f"{len(t)} rows at {RATE:g} Hz, attitude {'of the preset' if attitude == 'preset' else 'as flown'}"]
    place = course.place(turned.world.anchor)
    notes.append(place.summary)
    if not isinstance(preset.angular_velocity, Flown) and attitude == "flown":
        notes.append("the preset's own angular velocity is not in the file: a multirotor cannot fly the path with it")
    return OutputFile(
        files=(path,), frame="z-up", steady=course.steady, place=place, notes=tuple(notes), figures={"rows": len(t)}
    )


def _attitude(preset: Preset, course: hover_ramps.HoverRamps, t: Array, kind: Attitudes) -> tuple[Array, Array, Array]:
    if kind == "flown":
        body = hover_ramps.attitude(course, preset.angular_velocity, preset.world.gravity, t)
        return body.rotation, body.angular_velocity, body.angular_acceleration
    moved = motion.simulate(
        preset.path,
        preset.angular_velocity,
        world=preset.world,
        initial_rotation=preset.initial_rotation,
        duration=preset.duration,
        rate=RATE,
    )
    rule = f"with the preset's own attitude the duration must be a multiple of {1 / RATE:g} s"
    require(len(moved.time) == len(t) and bool(np.allclose(moved.time, t, atol=1e-9)), rule)
    return moved.rotation, moved.angular_velocity, moved.angular_acceleration


def _derivative(
    table: Table, alternatives: tuple[str, ...], word: str, findings: list[str]
) -> Float[Array, "n 3"] | None:
    """Three columns. None, with a remark in the findings, if they are absent, empty, or all zero."""
    there = [name for name in alternatives if all(column in table.names for column in COLUMNS[name])]
    if not there:
        findings.append(f"no {word} columns ({', '.join(COLUMNS[alternatives[0]])})")
        return None
    values = text.columns(table, COLUMNS[there[0]])
    if not np.any(np.nan_to_num(values)):
        findings.append(f"the {word} columns are all zero: taken as missing")
        return None
    text.refuse_missing(values, table, word)
    return values


def _check_quaternion(table: Table, findings: list[str]) -> None:
    if all(name in table.names for name in QUATERNION):
        size = np.linalg.norm(text.columns(table, QUATERNION), axis=-1)
        off = np.abs(size - 1) > 1e-2
        if off.any():
            findings.append(f"{int(off.sum())} quaternions are not of unit length; the path does not need them")
