"""The order of the quaternion in a file: w x y z, or x y z w under names that say the other.

A reordered quaternion turns the body in a way that no mount of the sensors explains, and may follow the gyro in other
axes. So the attitude is tried in every order, and as its inverse, before axes of the sensors are.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import frames
from rangenav.formats.recorded_flight import Flight
from rangenav.number_format import fixed
from rangenav.record_checks import turning
from rangenav.record_checks.axes import AS_IT_IS
from rangenav.record_checks.check import Evidence
from rangenav.record_checks.truth import BESIDE, TILTED, body_axes, level, tilt, tilted, turned_from_field

ORDERS: dict[str, tuple[int, int, int, int]] = {"xyzw": (3, 0, 1, 2), "wxyz": (1, 2, 3, 0)}
"""Where w, x, y, z stand among the columns that are named w, x, y, z."""
MEANT = {
    "xyzw": "in the order x y z w under the names w x y z",
    "wxyz": "in the order w x y z under the names x y z w",
}
CLOSER = 0.5
"""Largest share of the distance from gravity, or of the angle from the field, that the order that was meant leaves."""


def reordered(rotation: Float[Array, "n 3 3"], order: str) -> Float[Array, "n 3 3"]:
    """The attitude whose quaternion stands in another order; NaN where it is unknown."""
    known = np.isfinite(rotation).all(axis=(1, 2))
    quaternion = frames.from_rotation(rotation[known])[:, list(ORDERS[order])]
    other = np.full_like(rotation, np.nan)
    other[known] = frames.to_rotation(quaternion)
    return other


def attitude_order(flight: Flight) -> Evidence | None:
    """An attitude that follows the gyro in its own axes, and turns gravity and field right, in another order only."""
    fit = turning.follows(flight)
    if fit is None or flight.rotation is None or fit.own >= turning.FOLLOWS:
        return None
    for order in ORDERS:
        other = replace(flight, rotation=reordered(flight.rotation, order))
        followed = turning.follows(other)
        if followed is not None and followed.own >= turning.FOLLOWS and _closer(other, flight):
            text = (
                f"the attitude in the file follows the gyro if its quaternion is {MEANT[order]} (correlation "
                f"{fixed(followed.own)}; as it is named, {fixed(fit.own)})"
            )
            return Evidence(text=text, suggestion=order)
    return None


def _closer(other: Flight, own: Flight) -> bool:
    """Whether another attitude turns gravity or the field to where it is much better, and neither away from it."""
    angles = [(measure(other), measure(own)) for measure in (tilt, turned_from_field)]
    known = [(a, b) for a, b in angles if a is not None and b is not None]
    levels = level(other), level(own)
    better = [a < CLOSER * b for a, b in known]
    if levels[0] is not None and levels[1] is not None:
        better.append(bool(levels[0][0] < CLOSER * levels[1][0]))
    return any(better) and all(a <= max(TILTED, b) for a, b in known)


def attitude_in_doubt(flight: Flight) -> Evidence | None:
    """An attitude that follows the gyro in other axes only, and turns gravity or the field away from where it is.

    The sensors are not turned by it: the gyro would be made to agree with what contradicts the other sensors.
    """
    fit = turning.follows(flight)
    if fit is None or fit.own >= turning.FOLLOWS or fit.axes == AS_IT_IS or body_axes(flight) is not None:
        return None
    gravity, field = tilted(flight), turned_from_field(flight)
    away = [] if gravity is None else [f"gravity {gravity:.0f}° from the vertical"]
    away += [f"the field {field:.0f}° from the one that is stated"] if field is not None and field > BESIDE else []
    if not away:
        return None
    text = (
        f"the attitude in the file follows the gyro in the axes {fit.axes} only, and turns {' and '.join(away)}: it is "
        "no attitude to hold the sensors against"
    )
    return Evidence(text=text, suggestion="ignore")
