"""The columns of a recorded flight as its file has them, and what the file states of them."""

from collections.abc import Mapping
from dataclasses import field

from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.formats.import_result import (
    Question,
)
from rangenav.formats.recorded_flight import Frame
from rangenav.formats.text import Table
from rangenav.inputs import Vec3
from rangenav.results import result


@result
class FlightColumns:
    """The columns of a file, unchanged; `stated` holds the units that the file states."""

    table: Table
    """The table that the columns come from; messages name its lines."""
    format: str
    time: Float[Array, "n"]
    gyro: Float[Array, "n 3"]
    accel: Float[Array, "n 3"]
    mag: Float[Array, "n 3"] | None = None
    range: Float[Array, "n"] | None = None
    """m, on the rows of the table; NaN in rows without a range."""
    ranges: tuple[Float[Array, "m"], Float[Array, "m"]] | None = None
    """(stamps, distances) in the unit of `time` and in m, if ranges have a file of their own."""
    rotation: Float[Array, "n 3 3"] | None = None
    position: Float[Array, "n 3"] | None = None
    moving: Bool[Array, "n"] | None = None
    stated: Mapping[str, str] = field(default_factory=dict)
    frame: Frame | None = None
    gravity: Vec3 | None = None
    magnetic: Vec3 | None = None
    anchor: Vec3 | None = None
    findings: tuple[str, ...] = ()
    unconfirmed: tuple[str, ...] = ()
    """Columns of `rotation` and `position` whose names do not say that they are the truth."""
    of_format: tuple[str, ...] = ()
    """Quantities whose unit is that of the format; it is asked only if the numbers contradict it."""
    questions: tuple[Question, ...] = ()
    """What the names of the columns leave open."""
