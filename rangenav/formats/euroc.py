"""EuRoC folders: mav0/imu0, mav0/state_groundtruth_estimate0, and in addition mag0 and uwb0 for field and ranges.

    truth  #timestamp [ns], p (m), q wxyz, v (m/s), b_w, b_a: 17 columns, body to a z-up world
    imu0   #timestamp [ns], w (rad/s), a (m/s²)
mag0 and uwb0 are no part of EuRoC: `ns, m_x, m_y, m_z` (unit vector) and `ns, range [m]`. Stamps begin at one second.
Comments in uwb0 hold gravity, field and anchor.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy import ndarray as Array

from rangenav.formats import flight_columns, log, sampled_positions, sampled_rows, text, world_comments
from rangenav.formats.exported_run import nanoseconds, quaternions, upright_run
from rangenav.formats.import_result import ImportResult, increasing
from rangenav.formats.output_files import OutputFile, new_folder, write_text
from rangenav.formats.raw_flight import FlightColumns
from rangenav.formats.sampled_rows import FLIGHT, Part
from rangenav.formats.text import Table
from rangenav.inputs import require
from rangenav.preset import Preset

FIRST = 1.0
"""s: the stamp of t = 0."""
TRUTH, IMU, MAG, UWB = "state_groundtruth_estimate0", "imu0", "mag0", "uwb0"
POSITION = tuple(f"p_RS_R_{axis}" for axis in "xyz")
ATTITUDE = tuple(f"q_RS_{axis}" for axis in "wxyz")
VELOCITY = tuple(f"v_RS_R_{axis}" for axis in "xyz")
GYRO, ACCEL = tuple(f"w_RS_S_{axis}" for axis in "xyz"), tuple(f"a_RS_S_{axis}" for axis in "xyz")
BIASES = tuple(f"b_{kind}_RS_S_{axis}" for kind in "wa" for axis in "xyz")
HEADERS = {
    TRUTH: (
        *(f"{name} [m]" for name in POSITION),
        *(f"{name} []" for name in ATTITUDE),
        *(f"{name} [m s^-1]" for name in VELOCITY),
        *(f"{name} [rad s^-1]" for name in BIASES[:3]),
        *(f"{name} [m s^-2]" for name in BIASES[3:]),
    ),
    IMU: (*(f"{name} [rad s^-1]" for name in GYRO), *(f"{name} [m s^-2]" for name in ACCEL)),
    MAG: tuple(f"m_{axis} []" for axis in "xyz"),
    UWB: ("range [m]",),
}
HEAD = 4096
"""Bytes of a file in which its header is looked for."""
LEAST_ROWS = 8
LARGEST = 1e6


def parse_file(
    data: bytes, *, source: str, confirm: Mapping[str, str], knots: float | None = None, part: Part = FLIGHT
) -> ImportResult:
    """The path of one ground-truth file, or the flight of another CSV file. Raises ValueError naming the line."""
    if b"p_RS_R_x" in data[:HEAD]:
        return parse_truth(data, source=source, confirm=confirm, knots=knots, part=part)
    return log.parse(data, source=source, confirm=confirm)


def read_folder(path: Path, *, confirm: Mapping[str, str]) -> ImportResult:
    """The flight of a folder, whose files together are bounded as one file is. Raises ValueError naming file, line and
    column."""
    root = path / "mav0" if (path / "mav0").is_dir() else path
    names = {name: root / name / "data.csv" for name in (IMU, TRUTH, MAG, UWB)}
    require(names[IMU].is_file(), f"{path}: no {IMU}/data.csv in it")
    contents, left = {}, text.MAX_BYTES
    for name, file in names.items():
        if file.is_file():
            contents[name] = text.contents(file, limit=left)
            left -= len(contents[name])
    return parse(contents, source=path.name, confirm=confirm)


def parse(files: Mapping[str, bytes], *, source: str, confirm: Mapping[str, str]) -> ImportResult:
    """The flight of a folder; `files` holds the content of each file by the name of its sensor."""
    drop = "lines" in confirm
    imu = _table(files[IMU], f"{source}/{IMU}", drop=drop)
    time = _stamps(imu)
    sides = {name: _table(files[name], f"{source}/{name}", drop=drop) for name in (TRUTH, MAG, UWB) if name in files}
    rotation = position = None
    world = world_comments.vectors(sides[UWB]) if UWB in sides else {}
    if TRUTH in sides:
        position = _onto(time, sides[TRUTH], POSITION)
        rotation = log.attitude(_onto(time, sides[TRUTH], ATTITUDE), source)
    return flight_columns.flight(
        FlightColumns(
            table=imu,
            format="euroc",
            time=time,
            gyro=_columns(imu, GYRO),
            accel=_columns(imu, ACCEL),
            mag=_onto(time, sides[MAG], ("m_x", "m_y", "m_z")) if MAG in sides else None,
            ranges=_ranges(sides[UWB]) if UWB in sides else None,
            rotation=rotation,
            position=position,
            stated={"time": "ns", "gyro": "rad/s", "accel": "m/s2", "mag": "1"},
            of_format=("time",),
            frame="z-up",
            gravity=world.get("gravity"),
            magnetic=world.get("magnetic"),
            anchor=world.get("anchor"),
        ),
        confirm,
    )


def parse_truth(
    data: bytes, *, source: str, confirm: Mapping[str, str], knots: float | None = None, part: Part = FLIGHT
) -> ImportResult:
    """The path of a ground-truth file, as a curve through knots."""
    table = _table(data, source, drop="lines" in confirm)
    text.refuse_missing(np.column_stack([_stamps(table), _columns(table, POSITION)]), table, "a stamp or position")
    findings = list(table.remarks)
    rows = sampled_rows.sampled(
        table, _stamps(table), unit="ns", confirm=confirm, part=part, least=LEAST_ROWS, findings=findings
    )
    findings.insert(0, rows.summary("m, z-up"))
    return sampled_positions.imported(
        rows,
        _columns(rows.table, POSITION),
        format="euroc",
        largest=LARGEST,
        frame="z-up",
        knots=knots,
        findings=findings,
    )


def truth(data: bytes, source: str) -> tuple[Array, Array]:
    """Stamps (s) and positions (m) of a ground-truth file, unchanged. Raises ValueError."""
    table = _table(data, source)
    return _seconds(table), _columns(table, POSITION)


def write(preset: Preset, path: Path) -> OutputFile:
    """Write the folder of a run: truth, IMU, magnetometer and ranges."""
    new_folder(path)
    run = upright_run(preset)
    sampled = ~np.isnan(run.mag).any(axis=-1)
    zero = np.zeros_like(run.gyro)
    tables = {
        TRUTH: (run.time, np.column_stack([run.position, quaternions(run), run.velocity, zero, zero])),
        IMU: (run.time, np.column_stack([run.gyro, run.accel])),
        MAG: (run.time[sampled], run.mag[sampled]),
        UWB: (run.range_time, run.range[:, None]),
    }
    files = []
    for name, (time, table) in tables.items():
        folder = path / "mav0" / name
        folder.mkdir(parents=True)
        stamps = nanoseconds(time + FIRST)
        rows = [f"{stamp}," + ",".join(map(repr, row)) for stamp, row in zip(stamps, table.tolist(), strict=True)]
        header = [",".join(["#timestamp [ns]", *HEADERS[name]])]
        if name == UWB:
            header += world_comments.written(run)  # after the names of the columns, where readers of EuRoC look
        write_text(folder / "data.csv", "\n".join([*header, *rows, ""]))
        files.append(folder / "data.csv")
    notes = ("mag0, uwb0 and the world in its comments are no part of EuRoC", f"stamps begin at {FIRST:g} s")
    return OutputFile(files=tuple(files), frame="z-up", notes=notes, figures={"rows": len(run.time)})


def _table(data: bytes, source: str, *, drop: bool | None = None) -> Table:
    return text.table(data, source=source, marked=True, drop=drop)


def _stamps(table: Table) -> Array:
    rule = f"{table.source}: the first column must be #timestamp [ns]; {text.listed(table)}"
    require(table.names[0].startswith("timestamp"), rule)
    return table.values[:, 0]


def _seconds(table: Table) -> Array:
    """Stamps in s; nanoseconds since 1970 keep a quarter of a microsecond in double precision."""
    return _stamps(table) * 1e-9


def _columns(table: Table, names: tuple[str, ...]) -> Array:
    """Columns by their names without units."""
    plain = [name.split("[")[0].strip() for name in table.names]
    missing = [name for name in names if name not in plain]
    require(not missing, f"{table.source}: no column named {', '.join(missing)}; {text.listed(table)}")
    return table.values[:, [plain.index(name) for name in names]]


def _ranges(table: Table) -> tuple[Array, Array]:
    stamps, distance = _stamps(table), _columns(table, ("range",))[:, 0]
    text.refuse_missing(np.column_stack([stamps, distance]), table, "a stamp or range")
    increasing(stamps, table)
    return stamps, distance


def _onto(time: Array, table: Table, names: tuple[str, ...]) -> Array:
    """Rows of another sensor at the IMU's stamps; NaN where the sensor has no row within half an IMU step."""
    stamps, values = _stamps(table), _columns(table, names)
    aligned = np.full((len(time), len(names)), np.nan)
    steps = np.diff(time)
    if not np.isfinite(steps).any():
        return aligned
    half = max(float(np.nanmedian(steps)) / 2, 0.0)
    k = (
        np.clip(np.searchsorted(stamps, time), 1, len(stamps) - 1)
        if len(stamps) > 1
        else np.zeros(len(time), dtype=int)
    )
    if len(stamps) > 1:
        k = np.where(np.abs(stamps[k - 1] - time) <= np.abs(stamps[k] - time), k - 1, k)
    near = np.abs(stamps[k] - time) <= half
    aligned[near] = values[k[near]]
    return aligned
