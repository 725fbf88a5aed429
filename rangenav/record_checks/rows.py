"""Rows of the table that ask the same question of several quantities: in which unit, and in which axes?"""

from rangenav.formats import units
from rangenav.record_checks import corrections
from rangenav.record_checks.axes import AS_IT_IS
from rangenav.record_checks.check import Check, Find, Quantity

IS = {
    "gyro": "is the gyro",
    "accel": "is the accelerometer",
    "mag": "is the magnetometer",
    "body": "are the sensors",
    "time": "are the stamps",
    "range": "are the ranges",
}


def unit(kind: str, find: Find, *, about: Quantity, uses: tuple[Quantity, ...], compares: str) -> Check:
    """A check of the unit of one kind of `units.UNITS`; its reader applies the answer."""
    return Check(
        name=f"unit of {IS[kind].partition(' ')[2]}",
        compares=compares,
        about=about,
        uses=uses,
        find=find,
        key=kind,
        flag=f"--{kind}-unit",
        asks=f"in which unit {IS[kind]}",
        options=tuple(units.UNITS[kind]),
        correct=corrections.unit(kind),
        at_reading=True,
    )


def axes(of: str, find: Find, *, about: Quantity, uses: tuple[Quantity, ...], compares: str) -> Check:
    """A check of the axes of one sensor, or of all three: those of the body."""
    sensors = ("gyro", "accel", "mag") if of == "body" else (of,)
    return Check(
        name=f"axes of {'the body' if of == 'body' else IS[of].partition(' ')[2]}",
        compares=compares,
        about=about,
        uses=uses,
        find=find,
        key=f"{of}-axes",
        flag=f"--{of}-axes",
        asks=f"in which axes {IS[of]}",
        options=(AS_IT_IS,),
        correct=corrections.sensor_axes(*sensors),
    )
