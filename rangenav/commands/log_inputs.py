"""What `rangenav log` takes from its options: the checked record, its part, the world, the noise, synthetic ranges."""

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path

from rangenav import formats, record_questions
from rangenav.commands.log_answers import Answers
from rangenav.commands.progress import working
from rangenav.formats import recorded_flight
from rangenav.formats.recorded_flight import Flight
from rangenav.inputs import Vec3, require
from rangenav.logs import USUAL_NOISE
from rangenav.number_format import vector

RANGE_SIGMA = (1e-3, 1e2)
"""m: limits of the noise of ranges, recorded or synthetic."""
Limits = tuple[float | None, float | None]
"""Begin and end (s) of what is used; None: there is no limit."""
MOST_NOISE = 100.0
"""rad/s or m/s², per sample."""
ROUNDED = 1e-5
"""Vectors that differ by less are the same: a direction is made a unit vector."""
SHORTEST_DIRECTION = 1e-3
"""A shorter vector is no direction."""


def checked(
    file: Path,
    format_name: str,
    answers: Answers,
    vectors: tuple[Vec3, Vec3] | None,
    anchor: Vec3 | None,
    limits: Limits,
    *,
    measured: bool,
) -> record_questions.Asked:
    """The file, with gravity and field (`vectors`) and anchor as a person states them, and the checks of its record.

    limits: begin and end (s) of the part that is used; only this part is checked. measured: whether the ranges in the
    file are used. Raises ValueError for a file that holds no flight.
    """

    def read(confirm: Mapping[str, str]) -> formats.ImportResult:
        return as_given(formats.read(file, format_name, confirm=confirm), vectors, measured=measured)

    with working(f"checking {file.name}"):
        return record_questions.read(
            read, answers.confirm(), anchor=anchor, part=lambda flight: part(flight, *limits, source=file.name)
        )


def part(flight: Flight, begin: float | None, end: float | None, *, source: str) -> Flight:
    """The record from `begin` to `end` (s), each None for its own end. source: the file's name, for messages."""
    if begin is None and end is None:
        return flight
    first, last = (begin if begin is not None else 0.0), (end if end is not None else math.inf)
    require(first < last, f"--begin must be before --end, got {first:g} s and {last:g} s")
    try:
        return recorded_flight.between(flight, first, last)
    except ValueError as error:
        raise ValueError(f"{source}: --begin, --end: {error}") from None


def noise(
    at_rest: tuple[float, float, float] | None, gyro: float | None, accel: float | None, bias: float | None
) -> tuple[float, float, float] | None:
    """The IMU's noise: what was typed, else that of the rest at the start; None if nothing is known."""
    typed = (gyro, accel, bias)
    for name, value in zip(("--gyro-noise", "--accel-noise", "--gyro-bias"), typed, strict=True):
        require(value is None or 0 <= value <= MOST_NOISE, f"{name} must lie between 0 and {MOST_NOISE:g}, got {value}")
    if typed == (None, None, None):
        return at_rest
    usual = at_rest or (*USUAL_NOISE, 0.0)
    first, second, third = (known if value is None else value for value, known in zip(typed, usual, strict=True))
    return first, second, third


def as_given(
    imported: formats.ImportResult, vectors: tuple[Vec3, Vec3] | None, *, measured: bool
) -> formats.ImportResult:
    """The file with gravity and field as a person gives them, and without its ranges where synthetic ones are wanted.

    Raises ValueError for a file that holds no flight.
    """
    flight = imported.flight
    if flight is None:
        rule = f"{imported.source}: holds a path and no recorded flight: see `rangenav import`"
        require(bool(imported.questions), rule)
        return imported
    findings = [*imported.findings]
    if vectors is not None:
        for name, given in zip(("gravity", "magnetic"), vectors, strict=True):
            stated = getattr(flight, name)
            if stated is not None and math.dist(stated, given) > ROUNDED:
                unit = " m/s²" if name == "gravity" else ""
                findings.append(f"{name} {vector(given)}{unit}, given instead of {vector(stated)}{unit} in the file")
        flight = dataclasses.replace(flight, gravity=vectors[0], magnetic=vectors[1])
    if not measured:
        flight = dataclasses.replace(flight, range_time=flight.range_time[:0], range=flight.range[:0], range_lines=None)
    return dataclasses.replace(imported, flight=flight, findings=tuple(findings))


def with_ranges(flight: Flight, anchor: Vec3 | None, sigma: float, seed: int) -> Flight:
    """The flight with synthetic ranges of its true positions to the anchor; sigma, their noise (m)."""
    anchor = anchor or flight.anchor
    if anchor is None:
        raise ValueError("--synthetic-ranges needs --anchor X Y Z: the file does not say where the anchor stands")
    return recorded_flight.with_ranges(flight, anchor, sigma=sigma, seed=seed)


def world_vectors(world: str | None, gravity: Vec3 | None, magnetic: Vec3 | None) -> tuple[Vec3, Vec3] | None:
    """Gravity (m/s²) and the direction of the field, if both are given; None where the still start tells them."""
    if world != "given":
        require(gravity is None and magnetic is None, "--gravity and --magnetic are used with --world given")
        return None
    if gravity is None or magnetic is None:
        raise ValueError("--world given needs --gravity X Y Z and --magnetic X Y Z")
    length = math.hypot(*magnetic)
    require(math.isfinite(length) and length > SHORTEST_DIRECTION, f"--magnetic must be a direction, got {magnetic}")
    x, y, z = (value / length for value in magnetic)
    return gravity, (x, y, z)
