"""Reference CSV (Agilicious and RPG planners; GTSAM's DiscreteScenario reads it too): a trajectory by column name.

    t, p_*, q_wxyz, v_*, w_*, a_lin_*, a_rot_*, jerk_*, snap_*, and a_* for GTSAM
z-up, q body → world, w body, a without g.
Columns are found by their names, whatever their order. Read: pieces of degree 7 through position to jerk, on the knots
that agree best with the snap columns. Columns of nothing but zeros are taken as missing and said to be; without jerk
there is no excitation to be judged. Motor thrusts (u_*) need a mass that no preset has, and are not written.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import motion
from rangenav.axes import upright
from rangenav.formats import frames, hermite, hover_ramps, spline_fit, text
from rangenav.formats.import_result import ImportResult, in_order, spacing
from rangenav.formats.output_files import OutputFile, write_text
from rangenav.formats.text import Table
from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Flown, Polynomials
from rangenav.signals.polynomials import MAX_PIECES

RATE = 100.0
"""Hz: the rate at which the planners write."""
POSITION = ("p_x", "p_y", "p_z")
DERIVATIVES = tuple(tuple(f"{name}_{axis}" for axis in "xyz") for name in ("v", "a_lin", "jerk", "snap"))
WORDS = ("velocity", "acceleration", "jerk", "snap")
QUATERNION = ("q_w", "q_x", "q_y", "q_z")
AS_GOOD, CLOSE = 1.5, 1e-3
"""Pieces are good enough if their error is at most this multiple of the least error, or this share of the snap."""
STRIDES = (1, 2, 4, 8, 16, 32, 64, 128)
"""Samples per piece that are tried: close knots amplify rounding of printed digits, distant knots miss the motion."""
LEAST_ROWS = 3
SNAP_KEPT = 0.1
"""Largest share of the file's snap (rms) that the pieces may miss; with more, the snap comes from the fit."""
UNJUDGED = (
    "without acceleration and jerk the snap would be the fourth difference of sampled positions, which is mostly not "
    "the motion's: excitation cannot be judged from them, only from exact derivatives or from the IMU (rangenav log)"
)
IMPLIED = "the file holds jerk and no snap, and between its rows the pieces have the snap that joins them"
LARGEST = 1e6
"""SI: no trajectory has a larger position or derivative."""
Attitudes = Literal["flown", "preset"]


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
    data: bytes, *, source: str, confirm: Mapping[str, str] | None = None, knots: float | None = None
) -> ImportResult:
    """The path of a file. Raises ValueError naming line and column."""
    table = text.table(data, source=source)
    time, position = text.columns(table, ("t",))[:, 0], text.columns(table, POSITION)
    require(len(time) >= LEAST_ROWS, f"{source}: {len(time)} rows are no path")
    text.refuse_missing(np.column_stack([time, position]), table, "time or position")
    findings: list[str] = []
    table, questions = in_order(table, time, confirm or {}, findings)
    time, position = text.columns(table, ("t",))[:, 0], text.columns(table, POSITION)
    require(len(time) >= LEAST_ROWS, f"{source}: {len(time)} rows with increasing stamps are no path")
    findings = [
        f"{len(time)} rows, {time[-1] - time[0]:.4g} s; m, s, z-up, body → world as the format has it",
        *findings,
    ]
    rate = spacing(time, table, findings)
    derivatives = [_derivative(table, names, word, findings) for names, word in zip(DERIVATIVES, WORDS, strict=True)]
    columns = [position, *(one for one in derivatives if one is not None)]
    for values in columns:
        require(float(np.abs(values).max()) <= LARGEST, f"{source}: position or a derivative exceeds {LARGEST:g} (SI)")
    _check_quaternion(table, findings)
    path, fit_error, fitted, unjudged = path_through(time - time[0], position, derivatives, knots, source, findings)
    return ImportResult(
        source=source,
        format="reference",
        rows=len(time),
        rate=rate,
        duration=float(time[-1] - time[0]),
        frame="z-up",
        findings=tuple(findings),
        questions=questions,
        path=path,
        derivatives="file" if unjudged is None else "fit",
        fitted=fitted,
        fit_error=fit_error,
        unjudged=unjudged,
    )


def write(preset: Preset, path: Path, *, attitude: Attitudes = "flown") -> OutputFile:
    """Write the path and its ramps at 100 Hz. By default the attitude is that of a multirotor which flies the path.

    Raises ValueError where that has no answer (a free fall); `attitude="preset"` writes the preset's own, unramped.
    """
    turned = upright(preset)
    window = turned.requirement.window
    if attitude == "preset":
        course = hover_ramps.HoverRamps(path=turned.path, duration=turned.duration, ramp=0.0)
    else:
        course = hover_ramps.with_ramps(turned.path, turned.duration, window=window)
    t = np.append(np.arange(0, course.end - 1e-9, 1 / RATE), course.end)
    rotation, rate, second = _attitude(turned, course, t, attitude)
    p, v, a, j, s = (course(t, order) for order in range(5))
    q = frames.continuous(frames.from_rotation(rotation))
    names = ["t", *POSITION, *QUATERNION, *DERIVATIVES[0], "w_x", "w_y", "w_z", *DERIVATIVES[1]]
    names += [*(f"a_rot_{axis}" for axis in "xyz"), *DERIVATIVES[2], *DERIVATIVES[3], "a_x", "a_y", "a_z"]
    table = np.column_stack([t, p, q, v, rate, a, second, j, s, a])
    rows = [",".join(repr(value) for value in row) for row in table.tolist()]
    write_text(path, "\n".join([",".join(names), *rows, ""]))
    notes = [f"{len(t)} rows at {RATE:g} Hz, attitude {'of the preset' if attitude == 'preset' else 'as flown'}"]
    if not isinstance(preset.angular_velocity, Flown) and attitude == "flown":
        notes.append("the preset's own angular velocity is not in the file: a multirotor cannot fly the path with it")
    return OutputFile(files=(path,), frame="z-up", steady=course.steady, notes=tuple(notes), figures={"rows": len(t)})


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


def _derivative(table: Table, names: tuple[str, ...], word: str, findings: list[str]) -> Float[Array, "n 3"] | None:
    """Three columns. None, with a remark in the findings, if they are absent, empty, or all zero."""
    if not all(name in table.names for name in names):
        findings.append(f"no {word} columns ({', '.join(names)})")
        return None
    values = text.columns(table, names)
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
    if velocity is None or acceleration is None or jerk is None:
        curve = spline_fit.fit(time, position, spacing=knots, source=source)
        findings.append(curve.summary)
        return curve.path, curve.largest, curve.summary, UNJUDGED
    fit = fitted(time, np.stack([position, velocity, acceleration, jerk], axis=1), snap, source=source)
    fit_text = (
        f"pieces of degree 7 every {fit.stride} rows, {1e3 * fit.distance:.2g} mm from the file's positions at most"
    )
    if fit.snap is None:
        findings += [fit_text, IMPLIED]
        return fit.path, fit.distance, fit_text, IMPLIED
    fit_text += f", snap within {fit.snap:.2%} of the file's"
    findings.append(fit_text)
    lost = f"of the snap in the file the pieces miss {fit.snap:.0%}: its rows are too far apart, or do not agree"
    return fit.path, fit.distance, fit_text, lost if fit.snap > SNAP_KEPT else None


def fitted(
    time: Float[Array, "n"], derivatives: Float[Array, "n 4 3"], snap: Float[Array, "n 3"] | None, *, source: str
) -> ReferenceFit:
    """Pieces through every k-th row, for the largest k whose error of the snap (else of the jerk) is near the least."""
    fits: list[tuple[float, ReferenceFit]] = []
    target, order = (derivatives[:, 3], 3) if snap is None else (snap, 4)
    size = float(np.sqrt(np.mean(target**2)))
    for stride in STRIDES:
        chosen = np.unique(np.append(np.arange(0, len(time), stride), len(time) - 1))
        if len(chosen) - 1 > MAX_PIECES or len(chosen) < 2 or np.diff(time[chosen]).min() < 1e-3:
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
