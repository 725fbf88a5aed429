"""uav_trajectories polynomials (Crazyflie, Crazyswarm): `duration,x^0..x^7,y^0..,z^0..,yaw^0..7`, m, s, rad, z-up.

Read: exactly, with the jumps at knots named, from position to snap. Written: pieces of degree 7 through position to
jerk of the ramped path, at most 31 (the firmware's memory): one loop of a path that closes, or as much of a flight as
the pieces hold. The distance from the path and what the excitation has changed by are measured on the printed numbers.
"""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import continuity
from rangenav.axes import upright
from rangenav.formats import crazyflie, hover_ramps, piece_layouts, text
from rangenav.formats.import_result import ImportResult
from rangenav.formats.output_files import Draft, ExportOptions, OutputFile, write_text
from rangenav.formats.piece_layouts import MAX_SEGMENTS, Layout
from rangenav.formats.sampled_rows import FLIGHT, WHOLE, Part
from rangenav.inputs import require
from rangenav.observability import excitation
from rangenav.preset import Preset
from rangenav.results import result
from rangenav.signals import Piece, Polynomials, Signal, polynomials

NAMES = ("duration", *(f"{axis}^{power}" for axis in ("x", "y", "z", "yaw") for power in range(8)))
WORST_FIT = 0.01
"""m: the largest distance of a file from its path."""
MOST_COMPLAINTS = 10
"""Knots at which a path cannot be flown that are named one by one."""
SAME_KNOT = 1e-6
"""s"""
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
    ramp = _own_ramp(path, length) if part == FLIGHT else None
    if ramp is not None:
        part = ramp, length - ramp
        findings.append(hover_ramps.left_out(ramp))
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


def _own_ramp(path: Polynomials, length: float) -> float | None:
    """s: the ramps of an own export, which end and begin at knots; None if there are none."""
    ends = np.cumsum([piece.duration for piece in path.pieces])
    for ramp in ends[(ends >= hover_ramps.SHORTEST) & (ends <= hover_ramps.LONGEST) & (2 * ends < length)]:
        mirrored = float(np.abs(ends - (length - ramp)).min()) < SAME_KNOT
        if mirrored and hover_ramps.recognised(path, length, ramp=float(ramp)):
            return float(ramp)
    return None


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


def drafts(preset: Preset, options: ExportOptions) -> Iterator[Draft]:
    """The ways to write a path, from long pieces to short ones. Raises ValueError if there is none, and why."""
    turned = upright(preset)
    for layout in piece_layouts.layouts(turned, ramp=options.ramp, once=options.once):
        yield partial(_write, preset, turned, layout)


def _write(preset: Preset, turned: Preset, layout: Layout, path: Path) -> OutputFile:
    course, length = layout.course, preset.duration
    table = np.array([[p.duration, *p.x, *p.y, *p.z, *p.yaw] for p in layout.pieces.pieces])
    rows = [",".join(f"{value:.10g}" for value in row) for row in table]
    data = "\n".join([",".join(NAMES), *rows, ""])
    read = parse(data.encode(), source=path.name, part=WHOLE).path
    assert isinstance(read, Polynomials)
    fit = fitness(read, layout, turned)
    write_text(path, data)
    change = f"{fit.mu / fit.mu_path - 1:+z.2%}" if fit.mu_path > 0 else "none"
    notes = [f"{len(rows)} pieces, {1e3 * fit.distance:.2g} mm from the path at most, μ changed by {change}"]
    figures: dict[str, Any] = {"pieces": len(rows), "fit_error": fit.distance, "mu": fit.mu, "mu_path": fit.mu_path}
    place = course.place(turned.world.anchor)
    notes.append(place.summary)
    if layout.loop:
        first, count = layout.middle
        loop = crazyflie.loop_of(layout.course, first, count, preset.requirement.window)
        notes.append(crazyflie.looping(loop))
        figures |= {"loop_first": first, "loop_pieces": count}
    elif course.duration < length:
        notes.append(f"the first {course.duration:.4g} s of {length:.4g} s: {MAX_SEGMENTS} pieces hold no more")
    stray = f"{MAX_SEGMENTS} pieces stray {fit.distance:.2g} m from this path: it turns too fast for the format"
    return OutputFile(
        files=(path,),
        frame="z-up",
        steady=course.steady,
        loop=layout.loop,
        unfit=None if fit.distance <= WORST_FIT else stray,
        place=place,
        notes=tuple(notes),
        figures=figures,
    )


def fitness(pieces: Polynomials, layout: Layout, preset: Preset) -> PolynomialFit:
    """Distance and excitation of the written pieces, compared with the path (z-up)."""
    course, window = layout.course, preset.requirement.window
    t = np.linspace(0, course.end, SAMPLES)
    distance = float(np.linalg.norm(pieces(t) - course(t), axis=-1).max())
    begin, end = course.steady
    if layout.loop:
        start, again = np.linspace(0, end - begin, WINDOWS), polynomials.loop(pieces, *layout.middle)
        own = _least(course.path, start + course.ramp / 2, window)
        return PolynomialFit(distance=distance, mu=_least(again, start, window), mu_path=own)
    window = min(window, end - begin)
    start = np.linspace(begin, end - window, WINDOWS)
    mu, own = _least(pieces, start, window), _least(course.path, start - course.ramp / 2, window)
    return PolynomialFit(distance=distance, mu=mu, mu_path=own)


def _least(path: Signal, start: Array, window: float) -> float:
    """μ over the windows, 0 where it is rounding."""
    values = excitation.eigenvalues(path, start, window)
    least = float(values[:, 0].min())
    return least if least > excitation.floor(values) else 0.0


def _piece(row: Float[Array, "33"]) -> Piece:
    x, y, z, yaw = (tuple(row[first : first + 8].tolist()) for first in (1, 9, 17, 25))
    return Piece(duration=float(row[0]), x=x, y=y, z=z, yaw=yaw)
