"""uav_trajectories polynomials (Crazyflie, Crazyswarm): `duration,x^0..x^7,y^0..,z^0..,yaw^0..7`, m, s, rad, z-up.

Read: exactly, with the jumps at knots named, from position to snap. Written: pieces of degree 7 through position to
jerk of the ramped path, at most 31 (the firmware's memory), cut short after one window if there are too few for all of
it; the distance from the path and what the excitation has changed by are measured on the printed numbers.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import continuity
from rangenav.axes import upright
from rangenav.formats import hermite, hover_ramps, text
from rangenav.formats.hover_ramps import HoverRamps
from rangenav.formats.import_result import ImportResult
from rangenav.formats.output_files import OutputFile, write_text
from rangenav.formats.sampled_rows import FLIGHT, WHOLE, Part
from rangenav.inputs import require
from rangenav.observability import excitation
from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Piece, Polynomials, Signal, polynomials
from rangenav.signals.waypoints import MinimumSnap

MAX_SEGMENTS = 31
"""Pieces of 132 bytes that fit the Crazyflie's trajectory memory of 4 kB."""
PER_TURN = 3
"""Pieces for one period of the path's highest frequency."""
RAMP_PIECES = 4
"""Least number of pieces for each ramp."""
NAMES = ("duration", *(f"{axis}^{power}" for axis in ("x", "y", "z", "yaw") for power in range(8)))
WORST_FIT = 0.01
"""m: the largest distance of a file from its path."""
MOST_COMPLAINTS = 10
"""Knots at which a path cannot be flown that are named one by one."""
SAMPLES = 2001
WINDOWS = 101


def parse(data: bytes, *, source: str, part: Part = FLIGHT) -> ImportResult:
    """The path of a file, or of a part of it. Raises ValueError naming line and column."""
    table = text.table(data, source=source, header=",".join(NAMES))
    names = tuple(name.lower() for name in table.names)
    wanted = "a polynomial file has the columns duration, x^0 to x^7, y^0, z^0 and yaw^0 to yaw^7"
    rule = f"{source}: {wanted}; {text.listed(table)}"
    require(set(names) == set(NAMES) and len(names) == len(NAMES), rule)
    values = table.values[:, [names.index(name) for name in NAMES]]
    text.refuse_missing(values, table, "a coefficient or duration")
    try:
        path = Polynomials(pieces=tuple(_piece(row) for row in values))
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from None
    length = float(values[:, 0].sum())
    findings = [f"{len(values)} pieces, {length:.4g} s, m, s and rad, z-up as the format has it", *table.remarks]
    if len(values) > MAX_SEGMENTS:
        findings.append(f"{len(values)} pieces are more than the {MAX_SEGMENTS} a Crazyflie holds")
    if part == FLIGHT and hover_ramps.recognised(path, length):
        part = hover_ramps.between(length)
        findings.append(hover_ramps.LEFT_OUT)
    path = _part(path, length, part, source, findings)
    length = sum(piece.duration for piece in path.pieces)
    complaints = polynomials.complaints(path)
    findings += complaints[:MOST_COMPLAINTS]
    findings += continuity.jump_sentences(path, length)
    alone, jump = continuity.pieces_alone(path, length), continuity.discontinuity(path, length)
    findings += [] if alone is None else [alone]
    if np.any(values[:, 25:]):
        findings.append("yaw is not zero and is kept with the pieces, but the path does not use it")
    return ImportResult(
        source=source,
        format="polynomial",
        rows=len(values),
        rate=None,
        duration=length,
        frame="z-up",
        findings=tuple(findings),
        path=path,
        unjudged=None if jump is None else f"{jump}, so its snap is not what a flight would excite",
    )


def _part(path: Polynomials, length: float, part: Part, source: str, findings: list[str]) -> Polynomials:
    """The pieces between two times (s)."""
    begin, end = max(part[0] or 0.0, 0.0), length if part[1] is None else min(part[1], length)
    if (begin, end) == (0.0, length):
        return path
    rule = f"{source}: the part from {begin:g} s to {end:g} s is none of the {length:.6g} s of the file"
    require(end - begin > polynomials.MIN_DURATION, rule)
    findings.append(f"used: {begin:.6g} s to {end:.6g} s of the file's {length:.6g} s")
    return polynomials.cut(path, begin, end - begin)


@result
class PolynomialFit:
    """The distance of the pieces from the path, and their excitation."""

    distance: float
    """m: the largest distance."""
    mu: float
    """m²/s⁷: μ on the worst steady window of the file."""
    mu_path: float
    """m²/s⁷: μ on the same windows of the path itself."""


def write(preset: Preset, path: Path) -> OutputFile:
    """Write the path and its ramps as at most 31 pieces. Raises ValueError if these cannot follow one window of it."""
    turned = upright(preset)
    course, pieces = fitted(turned)
    table = np.array([[p.duration, *p.x, *p.y, *p.z, *p.yaw] for p in pieces.pieces])
    rows = [",".join(f"{value:.10g}" for value in row) for row in table]
    data = "\n".join([",".join(NAMES), *rows, ""])
    read = parse(data.encode(), source=path.name, part=WHOLE).path
    assert isinstance(read, Polynomials)
    fit = fitness(read, course, turned)
    rule = f"{MAX_SEGMENTS} pieces stray {fit.distance:.2g} m from this path: it turns too fast for the format"
    require(fit.distance <= WORST_FIT, rule)
    write_text(path, data)
    change = f"{fit.mu / fit.mu_path - 1:+.2%}" if fit.mu_path > 0 else "none"
    notes = [f"{len(rows)} pieces, {1e3 * fit.distance:.2g} mm from the path at most, μ changed by {change}"]
    if course.duration < preset.duration:
        notes.append(
            f"the first {course.duration:.4g} s of {preset.duration:.4g} s: {MAX_SEGMENTS} pieces hold no more"
        )
    figures = {"pieces": len(rows), "fit_error": fit.distance, "mu": fit.mu, "mu_path": fit.mu_path}
    return OutputFile(files=(path,), frame="z-up", steady=course.steady, notes=tuple(notes), figures=figures)


def fitness(pieces: Polynomials, course: HoverRamps, preset: Preset) -> PolynomialFit:
    """Distance and excitation of the written pieces, compared with the path (z-up)."""
    t = np.linspace(0, course.end, SAMPLES)
    distance = float(np.linalg.norm(pieces(t) - course(t), axis=-1).max())
    begin, end = course.steady
    window = min(preset.requirement.window, end - begin)
    start = np.linspace(begin, end - window, WINDOWS)
    mu, own = _least(pieces, start, window), _least(course.path, start - course.ramp / 2, window)
    return PolynomialFit(distance=distance, mu=mu, mu_path=own)


def _least(path: Signal, start: Array, window: float) -> float:
    """μ over the windows, 0 where it is rounding."""
    values = excitation.eigenvalues(path, start, window)
    least = float(values[:, 0].min())
    return least if least > excitation.floor(values) else 0.0


def fitted(preset: Preset) -> tuple[HoverRamps, Polynomials]:
    """The path with ramps, and its pieces. A path of such pieces that rests at its ends is written unchanged."""
    window, path = preset.requirement.window, preset.path
    own = _own_pieces(path)
    if own is not None and len(own.pieces) <= MAX_SEGMENTS:
        length = sum(piece.duration for piece in own.pieces)
        if length <= preset.duration * (1 + 1e-9):
            course = hover_ramps.with_ramps(own, length, window=0.0)
            if course.ramp == 0:
                return course, own
    step = 2 * np.pi / path.bandwidth_until(preset.duration) / PER_TURN if path.period != 0 else np.inf
    course = hover_ramps.with_ramps(path, preset.duration, window=window)
    ramp_pieces = max(RAMP_PIECES, int(np.ceil(course.ramp / step))) if course.ramp else 0
    left = MAX_SEGMENTS - 2 * ramp_pieces
    longest, sampled = max(left, 0) * step, isinstance(path, Polynomials)  # cut as finely as its samples
    require(longest >= window * (1 - 1e-9), _too_short(step, longest, window, sampled=sampled))
    if longest < preset.duration - course.ramp:
        course = HoverRamps(path=path, duration=longest + course.ramp, ramp=course.ramp)
    return course, _hermite(course, preset, ramp_pieces, left, step)


def _too_short(step: float, longest: float, window: float, *, sampled: bool) -> str:
    """That the pieces the format holds are too short for one window, and the ways out."""
    between = f"make {longest:.3g} s between the ramps" if longest > 0 else "leave none between the ramps"
    ways = ["export it as reference"]
    ways += ["export the preset itself whose samples were read"] if sampled else []
    ways += [f"give it a window of {longest:.3g} s or less"] if longest > 0 else []
    pieces = f"{MAX_SEGMENTS} pieces of at most {step:.2g} s, as this path needs them, {between}"
    return f"{pieces}, and its window has {window:g} s: it turns too fast for the format; {', or '.join(ways)}"


def _hermite(course: HoverRamps, preset: Preset, ramp_pieces: int, left: int, step: float) -> Polynomials:
    begin, end = course.steady
    middle = max(1, min(left, int(np.ceil((end - begin) / step - 1e-9)) if np.isfinite(step) else 1))
    parts = [np.linspace(begin, end, middle + 1)]
    if course.ramp:
        parts = [
            np.linspace(0, begin, ramp_pieces + 1)[:-1],
            parts[0],
            np.linspace(end, course.end, ramp_pieces + 1)[1:],
        ]
    knots = np.concatenate(parts)
    derivatives = np.stack([course(knots, order) for order in range(4)], axis=1)
    turn = np.stack(hover_ramps.yaw(preset.angular_velocity, course, knots), axis=1)
    return hermite.polynomials(knots, derivatives, yaw=turn)


def _own_pieces(path: Signal) -> Polynomials | None:
    if isinstance(path, MinimumSnap) and path.period is None:
        return polynomials.from_minimum_snap(path)
    return path if isinstance(path, Polynomials) and path.ends == "hold" else None


def _piece(row: Float[Array, "33"]) -> Piece:
    x, y, z, yaw = (tuple(row[first : first + 8].tolist()) for first in (1, 9, 17, 25))
    return Piece(duration=float(row[0]), x=x, y=y, z=z, yaw=yaw)
