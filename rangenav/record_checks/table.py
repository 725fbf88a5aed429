"""The table of checks of a recorded flight: one row each. Questions, flags and the documentation follow from it.

To add a check, write the pure function that finds the evidence and add a row; a new flag needs an option of
`rangenav log`, and a test names a flag that has none. The order matters: a row may rely on what the rows before it have
settled.
"""

from rangenav.record_checks import (
    accel_axes,
    corrections,
    distances,
    field,
    force,
    poses,
    range_unit,
    ranges,
    rows,
    truth,
    turning,
)
from rangenav.record_checks.check import Check

ATTITUDE = ("inverse", "ignore", "keep")

CHECKS: tuple[Check, ...] = (
    Check(
        name="lost poses",
        compares="positions that are 0 0 0 with their neighbours",
        about="position",
        find=poses.lost_poses,
        key="poses",
        flag="--poses",
        asks="what to do with positions of 0 0 0",
        options=("drop", "keep"),
        correct=corrections.lost_poses,
        default="drop",
    ),
    Check(
        name="truth",
        compares="the names of the poses' columns, and the poses with gravity and field",
        about="attitude",
        find=truth.unconfirmed,
        key="truth",
        flag="--truth",
        asks="are the poses in the file the truth",
        options=("no", "yes"),
        correct=corrections.truth,
        confirmable=True,
    ),
    Check(
        name="direction of the attitude",
        compares="the turns of the file's attitude with the gyro's",
        about="attitude",
        find=turning.attitude_reversed,
        key="attitude",
        flag="--attitude",
        asks="is the attitude in the file from body to inertial axes",
        options=ATTITUDE,
        correct=corrections.attitude,
    ),
    rows.unit(
        "gyro",
        turning.gyro_unit_by_attitude,
        about="gyro",
        uses=("attitude",),
        compares="the gyro, integrated, with the file's attitude",
    ),
    rows.unit(
        "time",
        turning.time_unit_by_attitude,
        about="gyro",
        uses=("attitude",),
        compares="the gyro, integrated over the stamps, with the file's attitude",
    ),
    rows.unit(
        "gyro",
        field.gyro_unit_by_field,
        about="gyro",
        uses=("mag",),
        compares="the spread of the magnetic field in axes turned by the gyro, for each unit",
    ),
    rows.axes(
        "body",
        truth.body_axes,
        about="gyro",
        uses=("attitude", "accel"),
        compares="gyro and accelerometer with the file's attitude, in 48 axes (FRD and FLU among them)",
    ),
    rows.axes(
        "gyro",
        turning.gyro_axes,
        about="gyro",
        uses=("attitude",),
        compares="the turns of the file's attitude with the gyro's, in 48 axes",
    ),
    rows.axes(
        "gyro",
        field.gyro_axes_by_field,
        about="gyro",
        uses=("mag",),
        compares="the spread of the magnetic field in axes turned by a left-handed gyro, in 24 axes",
    ),
    rows.unit(
        "gyro",
        force.gyro_unit_by_gravity,
        about="gyro",
        uses=("accel",),
        compares="the mean specific force in axes turned by the gyro with gravity, for each unit",
    ),
    rows.axes(
        "accel",
        accel_axes.accel_axes,
        about="accel",
        uses=("attitude", "position", "gyro"),
        compares="the file's positions with the accelerometer, twice integrated in the file's attitude, in 48 axes",
    ),
    rows.unit(
        "accel",
        force.accel_unit,
        about="accel",
        uses=("gyro",),
        compares="the mean specific force in axes turned by the gyro with gravity, for each unit",
    ),
    Check(
        name="scale of the accelerometer",
        compares="the mean specific force in axes turned by the gyro with gravity: removed, halved",
        about="accel",
        uses=("gyro",),
        find=force.accel_scale,
        key="accel-scale",
        flag="--accel-scale",
        asks="by which factor is the accelerometer to be multiplied",
        options=("1",),
        correct=corrections.accel_scale,
    ),
    Check(
        name="frame of the attitude",
        compares="gravity as it is stated, and the mean specific force, turned by the file's attitude, with the frame",
        about="attitude",
        uses=("accel", "gyro"),
        find=truth.frame,
        key="frame",
        flag="--frame",
        asks="which way does the world's z point",
        options=("z-up", "z-down"),
        correct=corrections.frame,
        at_reading=True,
    ),
    Check(
        name="attitude",
        compares="accelerometer and magnetometer, turned by the file's attitude, with gravity and field",
        about="attitude",
        uses=("accel", "gyro", "mag"),
        find=truth.attitude,
        key="attitude",
        flag="--attitude",
        asks="is the attitude in the file the truth",
        options=ATTITUDE,
        correct=corrections.attitude,
    ),
    rows.axes(
        "mag",
        field.mag_axes,
        about="mag",
        uses=("gyro",),
        compares="the spread of the magnetic field in axes turned by the gyro, in 24 axes",
    ),
    Check(
        name="offset of the magnetometer",
        compares="the part of the readings that turns with the body with the part that does not: hard iron",
        about="mag",
        uses=("gyro",),
        find=field.hard_iron,
        key="mag-offset",
        flag="--mag-offset",
        asks="which constant is to be subtracted from the magnetometer",
        options=("0 0 0",),
        correct=corrections.mag_offset,
    ),
    Check(
        name="values of the ranges",
        compares="each range with zero, with its neighbours, and with values that come back: sentinels",
        about="range",
        find=ranges.values,
        key="range-values",
        flag="--range-values",
        asks="what to do with ranges that are no distances",
        options=("drop", "keep"),
        correct=corrections.range_values,
        default="drop",
    ),
    Check(
        name="held ranges",
        compares="the length of runs of equal ranges",
        about="range",
        find=ranges.held,
        key="held-ranges",
        flag="--held-ranges",
        asks="how often does a range count that stands on several rows",
        options=("once", "each"),
        correct=corrections.held_ranges,
        default="once",
    ),
    rows.unit(
        "range",
        range_unit.unit,
        about="range",
        uses=("gyro", "accel", "position"),
        compares="the ranges with the true positions, or with what the IMU can reach",
    ),
    Check(
        name="clock of the ranges",
        compares="what the true positions, or the IMU, leave of the ranges if their stamps are up to 1 s late or early",
        about="range",
        uses=("gyro", "accel", "position"),
        find=distances.delay,
        key="range-delay",
        flag="--range-delay",
        asks="by how many seconds are the stamps of the ranges late",
        options=("0",),
        correct=corrections.range_delay,
    ),
    Check(
        name="anchor",
        compares="the ranges with the distances from the true positions to the anchor, and to the one that fits best",
        about="range",
        uses=("position", "range"),
        find=distances.anchor,
        key="anchor",
        flag="--anchor",
        asks="where does the anchor stand",
        options=(),
        correct=corrections.anchor,
    ),
)
"""In the order in which they are made."""


def markdown() -> str:
    """The table for the documentation."""
    head = ("check", "what is compared", "flag", "answers")
    rows = [head, ("---",) * len(head)]
    for row in CHECKS:
        answers = ", ".join(f"`{one}`" for one in row.options) or "where it stands"
        if len(row.options) == 1:
            answers = f"a value; {answers}: as it is"
        taken = f"{answers}; without a question `{row.default}`" if row.default else answers
        rows.append((row.name, row.compares, f"`{row.flag}`", taken))
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)
