"""The table of checks of a recorded flight: one row each. Questions, flags and the documentation follow from it.

To add a check, write the pure function that finds the evidence and add a row; a new flag needs an option of
`rangenav log`, and a test names a flag that has none. The order matters: a row may rely on what the rows before it have
settled.
"""

from rangenav.record_checks import (
    accel_axes,
    biases,
    clock,
    corrections,
    field,
    force,
    order,
    poses,
    rows,
    truth,
    turning,
)
from rangenav.record_checks.check import Check
from rangenav.record_checks.range_checks import RANGE_CHECKS

ATTITUDE = ("inverse", "xyzw", "wxyz", "ignore", "keep")
ATTITUDE_SAID = {
    "inverse": "the inverse of the attitude in the file",
    "xyzw": "the quaternion in the order x y z w",
    "wxyz": "the quaternion in the order w x y z",
    "ignore": "the attitude in the file not used",
    "keep": "the attitude in the file as it is",
}

CHECKS: tuple[Check, ...] = (
    Check(
        name="gaps of the IMU",
        compares="each step of the stamps with the usual one",
        about="time",
        find=clock.gaps,
        key="gaps",
        flag="--gaps",
        asks="what to do with gaps of the IMU",
        options=("longest", "bridge"),
        correct=corrections.gaps,
        said={"longest": "the longest part without a gap of the IMU", "bridge": "gaps of the IMU bridged"},
    ),
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
        said={"drop": "positions of 0 0 0 not used", "keep": "positions of 0 0 0 used"},
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
        said={"no": "the poses in the file are not the truth", "yes": "the poses in the file are the truth"},
        confirmable=True,
    ),
    Check(
        name="order of the quaternion",
        compares="the turns of the file's attitude, and gravity and field in it, with the sensors', in every order",
        about="attitude",
        find=order.attitude_order,
        key="attitude",
        flag="--attitude",
        asks="in which order is the quaternion in the file",
        options=ATTITUDE,
        correct=corrections.attitude,
        said=ATTITUDE_SAID,
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
        said=ATTITUDE_SAID,
    ),
    Check(
        name="attitude that contradicts the sensors",
        compares="the axes in which the file's attitude follows the gyro with gravity and field, turned by it",
        about="attitude",
        find=order.attitude_in_doubt,
        key="attitude",
        flag="--attitude",
        asks="is the attitude in the file the truth",
        options=ATTITUDE,
        correct=corrections.attitude,
        said=ATTITUDE_SAID,
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
    Check(
        name="rate of the IMU",
        compares="the turn of the body between two samples with what can be integrated",
        about="time",
        find=clock.rate,
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
        said=ATTITUDE_SAID,
    ),
    Check(
        name="offset of the gyro",
        compares="the turns by the gyro with those of the file's attitude: the constant that explains the difference",
        about="gyro",
        uses=("attitude",),
        find=biases.gyro_offset,
        key="gyro-offset",
        flag="--gyro-offset",
        asks="which constant is to be subtracted from the gyro",
        options=("0 0 0",),
        correct=corrections.gyro_offset,
        unit="rad/s",
    ),
    Check(
        name="offset of the accelerometer",
        compares="the specific force, turned by the file's attitude, with gravity and the bend of the file's positions",
        about="accel",
        uses=("attitude", "position"),
        find=biases.accel_offset,
        key="accel-offset",
        flag="--accel-offset",
        asks="which constant is to be subtracted from the accelerometer",
        options=("0 0 0",),
        correct=corrections.accel_offset,
        unit="m/s²",
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
    *RANGE_CHECKS,
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
        if not row.key:
            rows.append((row.name, row.compares, "–", "none: the record is not judged"))
            continue
        rows.append((row.name, row.compares, f"`{row.flag}`", taken))
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)
