"""The truth in a file against what its sensors read: gravity and field, and the acceleration of its positions.

R a ≈ −g on the average,  R m ∥ field,  p̈ = R a + g      R, p: attitude and positions in the file
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav import motion
from rangenav.formats.recorded_flight import Flight, Frame
from rangenav.number_format import significant, vector
from rangenav.record_checks import axes
from rangenav.record_checks.blocks import KEPT, blocks, means
from rangenav.record_checks.check import Evidence
from rangenav.record_checks.force import GAINED
from rangenav.record_checks.turning import follows

TILTED, REVERSED, BESIDE = 20.0, 160.0, 20.0
"""Degrees of the mean specific force from the vertical, and of the field from the file's, that are asked about. To the
first is added what a body may turn the mean by gaining speed."""
UPRIGHT = 0.5
"""Least cosine between the vertical and a gravity that tells which way z points."""
LEAST = 2.0
"""s of known attitudes."""
LEVEL = 2.0
"""s, windows over which the specific force is averaged before it is compared with gravity."""
AS_LEVEL = 1.1
"""Axes of the body leave at most this many times as much of gravity, if it is the field that they turn right."""
SAME, DIFFERS = 0.9, 0.1
"""The least correlation of turns that are the same, and by how much it is larger than that of other axes."""


def upwards(flight: Flight) -> Float[Array, "3"]:
    """−g (m/s²), of the file or of the earth in its frame."""
    if flight.gravity is not None:
        return -np.asarray(flight.gravity, dtype=float)
    return np.array([0.0, 0.0, 9.81 if flight.frame == "z-up" else -9.81])


def known_attitudes(flight: Flight) -> tuple[Float[Array, "b 3 3"], Bool[Array, "b"]] | None:
    """The file's attitude at each block, and where it is known; None where too little is."""
    if flight.rotation is None:
        return None
    b = blocks(flight)
    rotation = flight.rotation[b.start]
    known = np.asarray(np.isfinite(rotation).all(axis=(1, 2)))
    step = float(np.median(np.diff(b.time)))
    return (rotation, known) if known.sum() * step >= LEAST else None


def _angle(first: Array, second: Array) -> float:
    """Degrees between two vectors; 0 where one has no direction."""
    sine, cosine = float(np.linalg.norm(np.cross(first, second))), float(first @ second)
    return float(np.degrees(np.arctan2(sine, cosine)))


def tilt(flight: Flight) -> float | None:
    """Degrees between the vertical and the mean specific force, turned by the file's attitude."""
    attitudes = known_attitudes(flight)
    if attitudes is None:
        return None
    rotation, known = attitudes
    force = motion.to_inertial(rotation[known], blocks(flight).accel[known]).mean(axis=0)
    return _angle(force, upwards(flight)) if np.linalg.norm(force) > 0 else None


def tilted(flight: Flight) -> float | None:
    """The angle of `tilt` (degrees), if it is more than what a body that gains speed may have in a short part."""
    angle = tilt(flight)
    seconds = float(flight.time[-1] - flight.time[0])
    explained = float(np.degrees(np.arctan(GAINED / (seconds * float(np.linalg.norm(upwards(flight)))))))
    return angle if angle is not None and angle > TILTED + explained else None


def turned_from_field(flight: Flight, turn: Float[Array, "3 3"] | None = None) -> float | None:
    """Degrees between the file's field and the mean reading of the magnetometer, turned by the file's attitude.

    turn: from the axes of the magnetometer to those of the body; None if they are the same.
    """
    attitudes, mag = known_attitudes(flight), blocks(flight).mag
    if attitudes is None or mag is None or flight.magnetic is None:
        return None
    rotation, known = attitudes
    known = known & np.isfinite(mag).all(axis=-1)
    if not known.any():
        return None
    readings = mag[known] if turn is None else mag[known] @ turn.T
    return _angle(motion.to_inertial(rotation[known], readings).mean(axis=0), np.asarray(flight.magnetic))


def frame(flight: Flight) -> Evidence | None:
    """A frame against gravity: as it is stated, or as the attitude turns the accelerometer's readings."""
    other: Frame = "z-down" if flight.frame == "z-up" else "z-up"
    if flight.gravity is not None and against_gravity(flight):
        text = f"in {flight.frame}, gravity {vector(flight.gravity)} m/s² points up"
        if (tilt(flight) or 0.0) > REVERSED:
            wrong = f"{text}, along the mean specific force in the file's attitude: gravity itself has the wrong sign"
            return Evidence(text=wrong, suggestion=None)
        return Evidence(text=text, suggestion=other)
    angle = tilt(flight)
    if angle is None or angle < REVERSED or flight.gravity is not None:
        return None
    text = f"turned by the file's attitude, the mean specific force points {angle:.0f}° from up"
    return Evidence(text=text, suggestion=other)


def against_gravity(flight: Flight) -> bool:
    """Whether gravity, as it is stated, points up in the frame."""
    gravity = np.zeros(3) if flight.gravity is None else np.asarray(flight.gravity, dtype=float)
    down = gravity[2] if flight.frame == "z-down" else -gravity[2]
    return bool(down < -UPRIGHT * np.linalg.norm(gravity))


def attitude(flight: Flight) -> Evidence | None:
    """An attitude that turns gravity, or the field, away from where it is."""
    gravity, field = tilted(flight), turned_from_field(flight)
    if gravity is not None:
        text = f"turned by the file's attitude, the mean specific force points {gravity:.0f}° from up"
    elif field is not None and field > BESIDE:
        text = f"turned by the file's attitude, the magnetometer points {field:.0f}° from the field that is stated"
    else:
        return None
    return Evidence(text=text, suggestion="ignore")


def unconfirmed(flight: Flight) -> Evidence | None:
    """Poses whose names do not say that they are the truth."""
    if not flight.unconfirmed:
        return None
    gravity, field = tilt(flight), turned_from_field(flight)
    named = ", ".join(flight.unconfirmed)
    against = tilted(flight) is not None or (field or 0.0) > BESIDE
    angles = [] if gravity is None else [f"gravity {gravity:.0f}° from the vertical"]
    angles += [] if field is None else [f"the field {field:.0f}° from the one that is stated"]
    turned = f"; turned by it, the sensors read {' and '.join(angles)}" if angles else ""
    text = f"the columns {named} may be the truth or an estimate{turned}"
    return Evidence(text=text, suggestion="no" if against else None)


@lru_cache(maxsize=KEPT)
def level(flight: Flight) -> Float[Array, "48"] | None:
    """For each axes of the accelerometer, m/s² rms of its windows' mean about −g, turned by the file's attitude."""
    attitudes = known_attitudes(flight)
    if attitudes is None:
        return None
    rotation, known = attitudes
    b = blocks(flight)
    window, count = b.windows(LEVEL)
    there = np.unique(window[known])
    # the mean of R e_i a_j, for every i and j at once
    outer = np.einsum("nki,nj->nkij", rotation[known], b.accel[known])
    mean = means(outer, window[known], count)[there]
    force = np.einsum("wkij,aij->awk", mean, axes.MATRICES)
    return np.sqrt(np.mean(np.sum((force - upwards(flight)) ** 2, axis=-1), axis=-1))


def body_axes(flight: Flight) -> Evidence | None:
    """Axes in which gyro, and accelerometer or magnetometer, agree with the file's attitude, and not in their own."""
    fit, levels = follows(flight), level(flight)
    if fit is None or levels is None or fit.axes == axes.AS_IT_IS or fit.own > fit.correlation - DIFFERS:
        return None
    as_it_is, chosen = float(levels[0]), float(levels[axes.EVERY.index(fit.axes)])
    if fit.correlation < SAME:
        return None
    text = f"gyro and accelerometer agree with the file's attitude in the axes {fit.axes}: "
    if chosen <= as_it_is / 2:
        text += (
            f"the mean specific force is then {significant(chosen)} m/s² from −g, and {significant(as_it_is)} m/s² in "
            "their own axes"
        )
        return Evidence(text=text + axes.handedness(fit.axes), suggestion=fit.axes)
    own, turned = turned_from_field(flight), turned_from_field(flight, axes.matrix(fit.axes))
    if own is None or turned is None or own <= BESIDE or turned > BESIDE or chosen > AS_LEVEL * as_it_is:
        return None
    text += f"the magnetometer is then {turned:.0f}° from the field that is stated, and {own:.0f}° in its own axes"
    return Evidence(text=text + axes.handedness(fit.axes), suggestion=fit.axes)
