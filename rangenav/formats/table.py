"""The table of exchange formats: one row each, and every list of formats follows from it.

To add a format, write a module with its writer (and its reader) and a row here. Command line, page, certificates and
documentation need no change.
"""

from rangenav.formats import arrays, euroc, log, mat, polynomial, preset_toml, readback, reference, ros, tum
from rangenav.formats.format import Content, Format
from rangenav.inputs import require

MAX_MAT = 128_000_000
"""Bytes of a .mat file that is read."""


def _is_plain(head: str) -> bool:
    """Whether the header is that of the plain CSV: position, velocity and acceleration, and nothing else."""
    names = head.partition("\n")[0].strip().split(",")
    return set(names) == {"t", *(f"{name}_{axis}" for name in "pva" for axis in "xyz")}


FORMATS: tuple[Format, ...] = (
    Format(
        name="preset",
        label="preset TOML",
        hint="Every input of the run, to be opened again here.",
        keeps="every input of the run, without loss",
        suffix=".toml",
        writer=preset_toml.write,
        reads=("preset",),
        certified_as="preset",
        gate="claim",
    ),
    Format(
        name="reference",
        label="reference CSV",
        hint="Agilicious, RPG, GTSAM: position, attitude and derivatives up to snap, by name.",
        keeps="position to snap, attitude, body rates and their derivative, at 100 Hz",
        suffix=".reference.csv",
        upright=True,
        drafts=reference.drafts,
        own_attitude=True,
        reads=("path",),
        reader=lambda data, asked: reference.parse(
            data, source=asked.source, confirm=asked.confirm, knots=asked.knots, part=asked.part
        ),
        read_label="reference CSV (Agilicious, RPG)",
        recognises=lambda head: "p_x" in head and "gyr" not in head and "acc" not in head and not _is_plain(head),
        certified_as="motion",
    ),
    Format(
        name="polynomial",
        label="polynomials",
        hint="uav_trajectories pieces for a Crazyflie, at most 31: one loop of a path that repeats, between two ramps.",
        keeps="position and yaw as at most 31 pieces of degree 7; the distance from the path is reported",
        suffix=".polynomial.csv",
        upright=True,
        drafts=polynomial.drafts,
        reads=("path",),
        reader=lambda data, asked: polynomial.parse(data, source=asked.source, part=asked.part),
        read_label="polynomial CSV (Crazyflie)",
        recognises=lambda head: "x^0" in head,
        certified_as="motion",
    ),
    Format(
        name="bag",
        label="ROS 2 bag",
        hint="IMU, magnetic field, ranges and poses as messages, in a folder.",
        keeps="measurements and true poses, with stamps in nanoseconds and ranges in single precision",
        suffix=".bag",
        folder=True,
        upright=True,
        writer=ros.write_bag,
        certified_as="run",
        gate="claim",
        positions=readback.ros_poses,
    ),
    Format(
        name="mcap",
        label="MCAP",
        hint="The same messages in one MCAP file.",
        keeps="measurements and true poses, with stamps in nanoseconds and ranges in single precision",
        suffix=".mcap",
        upright=True,
        writer=ros.write_mcap,
        certified_as="run",
        gate="claim",
        positions=readback.ros_poses,
    ),
    Format(
        name="tum",
        label="TUM",
        hint="Positions and attitudes, for evo.",
        keeps="true positions and attitudes, to nine decimals",
        suffix=".tum.txt",
        upright=True,
        writer=tum.write,
        reads=("path",),
        reader=lambda data, asked: tum.parse(
            data, source=asked.source, confirm=asked.confirm, knots=asked.knots, part=asked.part
        ),
        read_label="TUM trajectory",
        read_suffixes=(".txt", ".tum"),
        certified_as="run",
        gate="claim",
        positions=readback.tum_poses,
    ),
    Format(
        name="euroc",
        label="EuRoC",
        hint="Ground truth, IMU and ranges, in a folder as EuRoC has them.",
        keeps="measurements, true poses and velocities, with stamps in nanoseconds",
        suffix=".euroc",
        folder=True,
        upright=True,
        writer=euroc.write,
        reads=("path", "flight"),
        reader=lambda data, asked: euroc.parse_file(
            data, source=asked.source, confirm=asked.confirm, knots=asked.knots, part=asked.part
        ),
        folder_reader=lambda path, asked: euroc.read_folder(path, confirm=asked.confirm),
        read_label="EuRoC ground truth CSV",
        recognises=lambda head: "p_rs_r" in head,
        certified_as="run",
        gate="claim",
        positions=readback.euroc_truth,
    ),
    Format(
        name="mat",
        label="MATLAB",
        hint="The whole run as one struct, version 5.",
        keeps="measurements, the true motion up to snap and the preset, without loss",
        suffix=".mat",
        writer=arrays.write_mat,
        reads=("flight",),
        reader=lambda data, asked: mat.parse(data, source=asked.source, confirm=asked.confirm),
        read_label="flight log .mat",
        read_suffixes=(".mat",),
        max_bytes=MAX_MAT,
        certified_as="run",
        gate="claim",
        positions=readback.mat_struct,
    ),
    Format(
        name="npz",
        label="NumPy",
        hint="The whole run as arrays, without loss.",
        keeps="measurements, the true motion up to snap and the estimate, without loss",
        suffix=".npz",
        writer=arrays.write_npz,
        certified_as="run",
        gate="claim",
        positions=readback.npz_arrays,
    ),
    Format(
        name="csv",
        label="plain CSV",
        hint="Time, position, velocity, acceleration: for anything.",
        keeps="time and true position, velocity and acceleration, without loss",
        suffix=".csv",
        writer=arrays.write_csv,
        reads=("path",),
        reader=lambda data, asked: arrays.parse_csv(
            data, source=asked.source, confirm=asked.confirm, knots=asked.knots, part=asked.part
        ),
        read_label="plain CSV (t, p, v, a)",
        recognises=_is_plain,
        certified_as="run",
        gate="claim",
        positions=readback.columns("t", "p_x", "p_y", "p_z"),
    ),
    Format(
        name="log",
        label="log CSV",
        hint="What the sensors read, and the truth.",
        keeps="measurements, true poses, gravity, field and anchor, without loss",
        suffix=".log.csv",
        writer=log.write,
        reads=("flight",),
        reader=lambda data, asked: log.parse(data, source=asked.source, confirm=asked.confirm),
        read_label="flight log CSV",
        recognises=lambda head: True,  # a table of any other logger may be one, and this row is asked last
        certified_as="run",
        gate="claim",
        positions=readback.columns("t [s]", "p_x [m]", "p_y [m]", "p_z [m]"),
    ),
    Format(
        name="bezier",
        label="compressed Bézier",
        keeps="control points to a millimetre: the snap is rounding",
        unsupported="compressed Bézier curves round control points to a millimetre, which replaces the path's snap by "
        "rounding (an excitation of 804 became 15 649): nothing about it can be certified; export it as polynomial "
        "instead",
    ),
    Format(
        name="qgc",
        label="QGroundControl plan",
        keeps="waypoints and speeds, and no times",
        unsupported="a QGroundControl plan keeps waypoints but not when to pass them, and excitation is a matter of "
        "time: nothing about it can be certified; export it as reference or polynomial instead",
    ),
)
"""A Bézier curve and a plan are rows too, so that whoever asks for them is answered with the reason.

A Crazyflie's compressed Bézier curve rounds every control point to a millimetre and each length to a millisecond: on
one gentle path λ_min of the excitation went from 804 to 15 649, all of it rounding. In a ground-control plan the
autopilot decides when to be where.
"""


def rows() -> tuple[Format, ...]:
    """Every format, in the order of help texts and menus."""
    return FORMATS


def row(name: str) -> Format:
    """The format of a name. Raises ValueError naming those there are."""
    chosen = next((row for row in rows() if row.name == name), None)
    require(chosen is not None, f"{name}: no such format; there are {names(rows())}")
    assert chosen is not None
    return chosen


def writable() -> tuple[Format, ...]:
    """Formats that `export` writes."""
    return tuple(row for row in rows() if row.written)


def readable() -> tuple[Format, ...]:
    """Formats that `read` reads."""
    return tuple(row for row in rows() if row.reader is not None)


def unsupported() -> tuple[Format, ...]:
    """Formats that are neither written nor read, and say why."""
    return tuple(row for row in rows() if row.unsupported)


def holding(content: Content) -> tuple[Format, ...]:
    """Formats from whose files a preset, a path or a flight is read."""
    return tuple(row for row in rows() if content in row.reads)


def names(chosen: tuple[Format, ...]) -> str:
    """Names of formats for reading: "bag, mcap"."""
    return ", ".join(row.name for row in chosen)


def markdown() -> str:
    """The table for the documentation."""
    head = ("format", "name", "written", "read", "what a file keeps", "certified as", "z up")
    lines = [head, ("---",) * len(head)]
    for row in rows():
        written = ("folder" if row.folder else "file") if row.written else "no"
        kind = row.certified_as if row.written else "never"
        upright = "always" if row.upright else "as the preset" if row.written else "–"
        lines.append((row.label, f"`{row.name}`", written, ", ".join(row.reads) or "no", row.keeps, kind, upright))
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)
