"""A recorded flight from raw columns. Where the file leaves units, frame or faulty rows open, there is a question."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy import ndarray as Array

from rangenav.formats import flight_conventions, stamps, units
from rangenav.formats.flight_rows import FlightRows, used_rows, with_own_rows
from rangenav.formats.import_result import (
    ImportResult,
    Question,
    answer,
    kept_rows,
    lines,
    spacing,
)
from rangenav.formats.raw_flight import FlightColumns
from rangenav.formats.recorded_flight import Flight, Frame
from rangenav.inputs import require

LEAST_ROWS = 8
LARGEST = 1e9
"""Largest value, in any unit; stamps may be larger."""


def flight(raw: FlightColumns, confirm: Mapping[str, str]) -> ImportResult:
    """The flight, or the questions that are open. Raises ValueError for faults that no answer can correct."""
    table, questions, findings = raw.table, list(raw.questions), list(raw.findings)
    _require_rows(len(raw.time), "", table.source)
    for name in ("gyro", "accel", "mag", "range"):
        values = getattr(raw, name)
        if values is not None:
            size = float(np.max(np.abs(np.nan_to_num(values)), initial=0.0))
            require(size <= LARGEST, f"{table.source}: {name} must not exceed {LARGEST:g}, got {size:.3g}")
    raw = _unwrapped(raw, confirm, questions, findings)
    others = tuple(values for values in (raw.mag, raw.rotation, raw.position) if values is not None)
    imu = np.column_stack([raw.gyro, raw.accel])
    rows = used_rows(table, raw.time, imu, raw.range, others, confirm, questions, findings)
    kept = rows.imu
    _require_rows(int(kept.sum()), " with a stamp, gyro and accelerometer", table.source)
    raw = _with_own_rows(raw, rows)
    chosen = flight_conventions.units_of(raw, kept, confirm, questions, findings)
    frame = flight_conventions.frame_of(raw, kept, confirm, questions)
    if raw.frame not in (None, frame):
        findings.append(f"frame: {frame} instead of {raw.frame} in the file, as confirmed")
    if raw.mag is None:
        findings.append("no magnetometer: the attitude about the vertical cannot be observed")
    elif np.isnan(raw.mag).all():
        findings.append("the magnetometer's columns are empty")
    time = (raw.time[kept] - raw.time[kept][0]) * units.UNITS["time"][chosen["time"]]
    rate = spacing(time, kept_rows(table, kept), findings)
    recorded = None if questions else _flight(raw, rows, time, chosen, frame, findings)
    return ImportResult(
        source=table.source,
        format=raw.format,
        rows=len(raw.time),
        rate=rate,
        duration=float(time[-1] - time[0]),
        frame=frame,
        findings=tuple(findings),
        questions=tuple(questions),
        flight=recorded,
    )


def _require_rows(count: int, kind: str, source: str) -> None:
    there = f"1 row{kind} is" if count == 1 else f"{count} rows{kind} are"
    require(count >= LEAST_ROWS, f"{source}: {there} no record, which has {LEAST_ROWS} rows at least")


def _unwrapped(
    raw: FlightColumns, confirm: Mapping[str, str], questions: list[Question], findings: list[str]
) -> FlightColumns:
    """The columns with stamps that go on where the clock began again, which has to be confirmed."""
    wraps = stamps.wraps(raw.time)
    if wraps is None:
        return raw
    times = "once" if len(wraps.rows) == 1 else f"{len(wraps.rows)} times"
    before = lines(raw.table.lines[wraps.rows])
    evidence = f"the clock goes back {times} by its period of {wraps.period:.10g} ({wraps.name}), before {before}"
    answered = answer(confirm, "stamps", stamps.UNWRAP)
    if answered is None:
        asks = "may the stamps go on where the clock began again"
        options = stamps.UNWRAP
        questions.append(
            Question(
                key="stamps", flag="--stamps", asks=asks, options=options, suggestion=options[0], evidence=evidence
            )
        )
    else:
        findings.append(f"{evidence}: unwrapped, as asked")
    return replace(raw, time=wraps.unwrapped(raw.time))


def _with_own_rows(raw: FlightColumns, rows: FlightRows) -> FlightColumns:
    """The columns with field and truth of rows of their own on the nearest row of the IMU."""
    filled = {
        name: None if values is None else with_own_rows(raw.time, values, rows)
        for name, values in (("mag", raw.mag), ("rotation", raw.rotation), ("position", raw.position))
    }
    return replace(raw, **filled)


def _flight(
    raw: FlightColumns,
    rows: FlightRows,
    time: Array,
    chosen: Mapping[str, str],
    frame: Frame,
    findings: list[str],
) -> Flight:
    kept, ranged = rows.imu, rows.ranged
    factors = {kind: units.UNITS[kind][unit] for kind, unit in chosen.items()}
    range_time, distance, range_lines = np.empty(0), np.empty(0), None
    first = raw.time[kept][0]
    if raw.range is not None:
        range_time, distance = (raw.time[ranged] - first) * factors["time"], raw.range[ranged] * factors["range"]
        range_lines = raw.table.lines[ranged]
    elif raw.ranges is not None:
        range_time, distance = (raw.ranges[0] - first) * factors["time"], raw.ranges[1]
    inside = (range_time >= time[0]) & (range_time <= time[-1])
    order = np.flatnonzero(inside)[np.argsort(range_time[inside], kind="stable")]
    range_time, distance = range_time[order], distance[order]
    if len(distance) == 0:
        findings.append("no ranges")
    mag, strength = None, 1.0
    if raw.mag is not None and np.isfinite(raw.mag[kept]).all(axis=-1).any():
        strength = float(np.nanmedian(np.linalg.norm(raw.mag[kept], axis=-1)))
        require(strength > 0, f"{raw.table.source}: the magnetometer reads nothing but zero")
        mag = raw.mag[kept] / strength
    return Flight(
        time=time,
        gyro=raw.gyro[kept] * factors["gyro"],
        accel=raw.accel[kept] * factors["accel"],
        mag=mag,
        range_time=range_time,
        range=distance,
        rotation=None if raw.rotation is None else raw.rotation[kept],
        position=None if raw.position is None else raw.position[kept],
        moving=None if raw.moving is None else raw.moving[kept],
        frame=frame,
        gravity=raw.gravity,
        magnetic=raw.magnetic,
        anchor=raw.anchor,
        unconfirmed=raw.unconfirmed,
        units=chosen,
        field_length=strength,
        lines=raw.table.lines[kept],
        range_lines=None if range_lines is None else range_lines[order],
    )
