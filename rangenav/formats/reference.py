"""Reference CSV (Agilicious and RPG planners; GTSAM's DiscreteScenario reads it too): a trajectory by column name.

    t, p_*, q_wxyz, v_*, w_*, a_lin_*, a_rot_*, jerk_*, snap_*, and a_* for GTSAM
z-up, q body → world, w body, a without g.
Columns are found by their names, whatever their order. Read: pieces of degree 7 through position to jerk, on the knots
that agree best with the snap columns, or of degree 5 through position to acceleration. Columns of nothing but zeros are
taken as missing and said to be; without jerk there is no excitation to be judged. Motor thrusts (u_*) need a mass that
no preset has, and are not written.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import motion
from rangenav.axes import upright
from rangenav.formats import frames, hermite, hover_ramps, sampled_rows, spline_fit, text
from rangenav.formats.import_result import ImportResult, Question
from rangenav.formats.output_files import Attitudes, Draft, ExportOptions, OutputFile, write_text
from rangenav.formats.recorded_flight import Frame
from rangenav.formats.sampled_rows import FLIGHT, Part, SampledRows
from rangenav.formats.text import Table
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Flown, Polynomials
from rangenav.signals.polynomials import MAX_PIECES

RATE = 100.0
"""Hz: the rate at which the planners write."""
POSITION = ("p_x", "p_y", "p_z")
HEADER = "t,p_x,p_y,p_z"
"""An example of the first line: the columns that a path has at least."""
COLUMNS = {name: tuple(f"{name}_{axis}" for axis in "xyz") for name in ("v", "a_lin", "a", "jerk", "snap")}
DERIVATIVES = {"velocity": ("v",), "acceleration": ("a_lin", "a"), "jerk": ("jerk",), "snap": ("snap",)}
"""The columns of each derivative; of several the first that is there. GTSAM calls the acceleration a."""
QUATERNION = ("q_w", "q_x", "q_y", "q_z")
AS_GOOD, CLOSE = 1.5, 1e-3
"""Pieces are good enough if their error is at most this multiple of the least error, or this share of the snap."""
STRIDES = (1, 2, 4, 8, 16, 32, 64, 128)
"""Samples per piece that are tried: close knots amplify rounding of printed digits, distant knots miss the motion."""
LEAST_ROWS = 3
SNAP = 4
"""The order of the derivative."""
SNAP_KEPT = 0.1
"""Largest share of the file's snap (rms) that the pieces may miss; with more, the snap comes from the fit."""
AGREES = 0.2
"""Largest difference (rms, relative) between a derivative and the differences of what it is the derivative of."""
UNJUDGED = (
    "without acceleration and jerk the snap would be the fourth difference of sampled positions, which is mostly not "
    "the motion's: excitation cannot be judged from them, only from exact derivatives or from the IMU (rangenav log)"
)
IMPLIED = "the file holds jerk and no snap, and between its rows the pieces have the snap that joins them"
ACCELERATED = (
    "the file holds acceleration and no jerk, and between its rows the pieces have the jerk and snap that join them: "
    "excitation cannot be judged from it"
)
LARGEST = 1e6
"""SI: no trajectory has a larger position or derivative."""


@result
class ReferenceFit:
    """Pieces, and their distance from the file's data."""

    path: Polynomials
    distance: float
    """m, the largest over all rows."""
    snap: float | None
    """Root mean square of the snap's error, relative; None where the file has no snap."""
    stride: int


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
    path, fit_error, fit_text, unjudged = None, None, "", UNJUDGED
    if rows.fits:
        path, fit_error, fit_text, unjudged = path_through(rows.time, position, derivatives, knots, source, findings)
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


def path_through(
    time: Array, position: Array, derivatives: list[Array | None], knots: float | None, source: str, findings: list[str]
) -> tuple[Polynomials | spline_fit.Waypoints, float, str, str | None]:
    """The path, its largest distance from the file's positions (m), the kind of fit, and why it is not judged."""
    velocity, acceleration, jerk, snap = derivatives
    if (
        velocity is None
        or acceleration is None
        or (jerk is None and not _agree(time, [position, velocity, acceleration]))
    ):
        findings += _doubts(time, position, velocity, acceleration)
        curve = spline_fit.fit(time, position, spacing=knots, source=source)
        findings.append(curve.summary)
        return curve.path, curve.largest, curve.summary, UNJUDGED
    through = [position, velocity, acceleration, *(() if jerk is None else (jerk,))]
    fit = fitted(time, np.stack(through, axis=1), snap if jerk is not None else None, source=source)
    degree, near = 2 * len(through) - 1, f"{1e3 * fit.distance:.2g} mm from the file's positions at most"
    fit_text = f"pieces of degree {degree} every {fit.stride} rows, {near}"
    if fit.snap is None:
        why = ACCELERATED if jerk is None else IMPLIED
        findings += [fit_text, why]
        return fit.path, fit.distance, fit_text, why
    fit_text += f", snap within {fit.snap:.2%} of the file's"
    findings.append(fit_text)
    lost = f"of the snap in the file the pieces miss {fit.snap:.0%}: its rows are too far apart, or do not agree"
    return fit.path, fit.distance, fit_text, lost if fit.snap > SNAP_KEPT else None


def _doubts(time: Array, position: Array, velocity: Array | None, acceleration: Array | None) -> list[str]:
    """What becomes of velocity and acceleration columns that are no part of the path."""
    if velocity is None:
        return []
    if not _agree(time, [position, velocity]):
        return [_differs("velocity", "position", time, position, velocity)]
    if acceleration is None:
        return ["the velocity columns agree with the differences of the position; the path is made of the position"]
    return [_differs("acceleration", "velocity", time, velocity, acceleration)]


def _differs(word: str, lower: str, time: Array, below: Array, values: Array) -> str:
    share = _difference(time, below, values)
    return f"the {word} columns differ by {share:.0%} from the differences of the {lower}: neither is used but position"


def _agree(time: Array, orders: list[Array]) -> bool:
    """Whether each of the values is the derivative of the one before."""
    return all(_difference(time, low, high) <= AGREES for low, high in pairwise(orders))


def _difference(time: Array, below: Array, values: Array) -> float:
    """Root mean square of values less the differences of what is below, over that of the values."""
    size = float(np.sqrt(np.mean(values**2)))
    slope = np.diff(below, axis=0) / np.diff(time)[:, None]
    return float(np.sqrt(np.mean((slope - (values[1:] + values[:-1]) / 2) ** 2))) / size


def fitted(
    time: Float[Array, "n"], derivatives: Float[Array, "n g 3"], snap: Float[Array, "n 3"] | None, *, source: str
) -> ReferenceFit:
    """Pieces through every k-th row, for the largest k whose error is near the least one.

    derivatives: 0 to g − 1 = 2 or 3. The error is that of the snap, or else of the highest derivative. Pieces are
    equally long but for one row, whatever the number of rows: no short piece is left over at the end.
    """
    fits: list[tuple[float, ReferenceFit]] = []
    order = derivatives.shape[1] - 1 if snap is None else SNAP
    target = derivatives[:, -1] if snap is None else snap
    size = float(np.sqrt(np.mean(target**2)))
    for stride in STRIDES:
        count = max(1, round((len(time) - 1) / stride))
        chosen = np.rint(np.linspace(0, len(time) - 1, count + 1)).astype(int)
        if count > MAX_PIECES or len(time) < 2 or np.diff(time[chosen]).min() < 1e-3:
            continue
        try:
            path = hermite.polynomials(time[chosen], derivatives[chosen])
        except ValueError:  # rounding in knots this close exceeds what pieces may hold
            continue
        error = float(np.sqrt(np.mean((path(time, order) - target)[1:-1] ** 2)))
        distance = float(np.linalg.norm(path(time) - derivatives[:, 0], axis=-1).max())
        relative = error / size if snap is not None and size > 0 else None
        fits.append((error, ReferenceFit(path=path, distance=distance, snap=relative, stride=stride)))
    if not fits:
        raise ValueError(f"{source}: no pieces can be put through these rows: their stamps are too close or too uneven")
    allowed = max(AS_GOOD * min(error for error, _ in fits), CLOSE * size)
    return next(fit for error, fit in reversed(fits) if error <= allowed)
