"""Which rows of a recorded flight are used: those of the IMU, and those of sensors that have rows of their own.

A row without any reading of the IMU is no broken line if another sensor has a reading there: a logger that writes each
sensor as it comes leaves the cells of the others empty. Such a range keeps its own stamp. The field and the truth of
such a row belong to the nearest row of the IMU.
"""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.formats.import_result import Question, broken_lines, last_row_twice, lines, repeated
from rangenav.formats.text import Table
from rangenav.inputs import require
from rangenav.results import result

MOSTLY = 0.9
"""The share of steps back of rows that run backwards; of rows out of order it is about one half."""
ROUNDED = 0.2
"""Largest share of repeated stamps. With more of them, dropping lines would not repair the record."""


@result
class FlightRows:
    """Rows of a table, by what they are used for."""

    imu: Bool[Array, "n"]
    """Rows with a stamp, gyro and accelerometer."""
    ranged: Bool[Array, "n"]
    """Rows with a stamp and a range."""
    own: Bool[Array, "n"]
    """Rows without any reading of the IMU and with one of another sensor."""


def used_rows(
    table: Table,
    time: Float[Array, "n"],
    imu: Float[Array, "n 6"],
    distance: Float[Array, "n"] | None,
    others: tuple[Array, ...],
    confirm: Mapping[str, str],
    questions: list[Question],
    findings: list[str],
) -> FlightRows:
    """The rows that can be used. Broken rows are dropped only if that is confirmed.

    imu: gyro and accelerometer. others: what else the rows hold, each of n rows. Raises ValueError for no clock at all.
    """
    known, stamped = np.isfinite(imu), np.isfinite(time)
    ranged = stamped & np.isfinite(distance) if distance is not None else np.zeros_like(stamped)
    elsewhere = ranged | np.any([_known(values) for values in others], axis=0) if others else ranged
    own = stamped & ~known.any(axis=-1) & elsewhere
    twice = last_row_twice(np.column_stack([time, imu, table.values]))
    if twice.any():
        findings.append(f"the last row repeats the row before it: {lines(table.lines[-1:])} is not used")
    missing = ~(known.all(axis=-1) & stamped) & ~own & ~twice
    rule = f"{table.source}: no row has a stamp and every reading of gyro and accelerometer"
    require(not np.all(missing | own | twice), rule)
    again = np.zeros_like(missing)
    for rows in (~(missing | own | twice), own & ranged):
        again[rows] = repeated(time[rows])
    share = float(again.mean())
    require(share <= ROUNDED, f"{table.source}: {share:.0%} of the stamps {_disorder(time[~(missing | own | twice)])}")
    faults = []
    if missing.any():
        faults.append(f"numbers are missing on {lines(table.lines[missing])}")
    if again.any():
        faults.append(f"stamps repeat or go back on {lines(table.lines[again])}")
    if faults:
        questions += broken_lines(" and ".join(faults), confirm, findings)
    whole = ~(missing | again | twice)
    return FlightRows(imu=whole & ~own, ranged=whole & ranged, own=whole & own)


def with_own_rows(time: Float[Array, "n"], values: Array, rows: FlightRows) -> Array:
    """The readings with those of rows of their own put on the nearest row of the IMU, at most half its step away."""
    own, imu = np.flatnonzero(rows.own & _known(values)), np.flatnonzero(rows.imu)
    if len(own) == 0 or len(imu) < 2:
        return values
    stamps = time[imu]
    after = np.clip(np.searchsorted(stamps, time[own]), 1, len(stamps) - 1)
    nearest = np.where(time[own] - stamps[after - 1] <= stamps[after] - time[own], after - 1, after)
    near = np.abs(stamps[nearest] - time[own]) <= float(np.median(np.diff(stamps))) / 2
    filled, target = np.array(values, dtype=float), imu[nearest[near]]
    empty = ~_known(values)[target]
    filled[target[empty]] = values[own[near][empty]]
    return filled


def _known(values: Array) -> Bool[Array, "n"]:
    return np.asarray(np.isfinite(values).reshape(len(values), -1).all(axis=-1))


def _disorder(time: Array) -> str:
    """What is wrong with stamps most of which repeat or go back, as the end of a sentence."""
    steps = np.diff(time)
    back = float(np.mean(steps < 0)) if len(steps) else 0.0
    if back > MOSTLY:
        return "go back: the rows run backwards in time; sort them by their stamps"
    if back > MOSTLY / 4:
        return "repeat or go back: the rows are out of order; sort them by their stamps"
    return "repeat or go back: rounded, as spreadsheets do, or no clock"
