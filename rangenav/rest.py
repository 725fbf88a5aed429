"""A recorded flight that starts at rest: gravity, the magnetic direction and the sensors' noise follow from the rest.

At rest the accelerometer reads −Rᵀg and the magnetometer Rᵀm. If the file has a true attitude, gravity and field are
computed in its frame. Otherwise they define the inertial frame: z along gravity, x towards magnetic north. That is
enough, because a range to an anchor does not depend on the axes.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats.import_result import Question
from rangenav.formats.recorded_flight import Flight, Frame
from rangenav.inputs import Vec3, require
from rangenav.motion import World, to_inertial
from rangenav.results import result

TURNING = 0.05
"""rad/s: above this the body turns. On a table a gyro reads its bias and noise, in a hand ten times more."""
SHAKING = 0.3
"""m/s²: with a change of the accelerometer's reading above this the body moves."""
AVERAGED = 0.2
"""s over which samples are averaged before they are compared, so that noise alone does not count as movement."""
LEAST = 0.5
"""s: a shorter rest is not used."""
USUAL_GRAVITY = (9.7, 9.9)
"""m/s²: gravity anywhere on earth, with 0.1 for the error of the accelerometer's scale."""

SLACK = 1.1
"""Factor from usual gravity within which a rest is suggested as the source of gravity."""


@result
class Rest:
    """A rest at the start of a record."""

    seconds: float
    gravity: Vec3
    """m/s², inertial."""
    magnetic: Vec3
    """Unit vector, inertial."""
    gyro_bias: Float[Array, "3"]
    """rad/s: what the gyro reads at rest. It is reported and not subtracted."""
    gyro_noise: float
    """rad/s, standard deviation per sample and axis."""
    accel_noise: float
    """m/s²"""
    aligned: bool
    """Whether the directions are in the frame of the file's attitude. If not, z is along gravity, x towards north."""

    @property
    def summary(self) -> str:
        """Gravity, field and gyro bias at rest, as one clause."""
        size, bias = float(np.linalg.norm(self.gravity)), np.degrees(np.linalg.norm(self.gyro_bias))
        dip = np.degrees(np.arcsin(np.clip(np.dot(self.gravity, self.magnetic) / size, -1, 1)))
        side = "below" if dip >= 0 else "above"
        frame = "in the frame of the file's attitude" if self.aligned else "with x towards magnetic north"
        odd = "" if USUAL_GRAVITY[0] <= size <= USUAL_GRAVITY[1] else " (not the earth's: is the scale right?)"
        return (
            f"the first {self.seconds:.3g} s are still and give gravity {size:.3f} m/s²{odd} and a field "
            f"{abs(dip):.1f}° {side} the horizon, {frame}; the gyro reads {bias:.2g}°/s at rest"
        )


def rest_seconds(flight: Flight) -> float:
    """How long the body rests from the first sample on (s); 0 if the record starts in motion."""
    step = float(np.median(np.diff(flight.time)))
    width = max(1, min(round(AVERAGED / step), len(flight.time)))
    gyro, accel = _averaged(flight.gyro, width), _averaged(flight.accel, width)
    at_first = gyro[: max(1, len(gyro) // 1000)].mean(axis=0)
    if np.linalg.norm(at_first) > TURNING:
        return 0.0
    turning = np.linalg.norm(gyro - at_first, axis=-1) > TURNING
    shaking = np.linalg.norm(accel - accel[0], axis=-1) > SHAKING
    moving = turning | shaking
    first = int(np.argmax(moving)) if moving.any() else len(moving) - 1
    seconds = float(flight.time[first] - flight.time[0]) if first > 0 else 0.0
    return seconds if seconds >= LEAST else 0.0


def rest_of(flight: Flight, seconds: float) -> Rest:
    """The rest at the start of a record. Raises ValueError without a magnetometer, or with too few samples."""
    rest = flight.time - flight.time[0] <= seconds
    mag = None if flight.mag is None else flight.mag[rest]
    if mag is None or np.isnan(mag).any(axis=-1).all():
        raise ValueError("without a magnetometer at rest the world's magnetic direction must be given")
    require(int(rest.sum()) >= 2, f"{seconds:g} s of rest hold fewer than two samples")
    gyro, accel = flight.gyro[rest], flight.accel[rest]
    mag_mean, accel_mean = np.nanmean(mag, axis=0), accel.mean(axis=0)
    force, field = _level_axes(accel_mean, mag_mean, flight.frame)
    known = None if flight.rotation is None else ~np.isnan(flight.rotation[rest]).any(axis=(1, 2))
    aligned = False
    if known is not None and flight.rotation is not None and not np.isnan(mag[known]).any(axis=-1).all():
        rotation = flight.rotation[rest][known]
        force = np.mean(to_inertial(rotation, accel[known]), axis=0)
        field = np.nanmean(to_inertial(rotation, mag[known]), axis=0)
        aligned = True
    return Rest(
        seconds=seconds,
        gravity=_vec(-force),
        magnetic=_vec(field / np.linalg.norm(field)),
        gyro_bias=gyro.mean(axis=0),
        gyro_noise=float(gyro.std(axis=0).mean()),
        accel_noise=float(accel.std(axis=0).mean()),
        aligned=aligned,
    )


def noise_at_rest(flight: Flight) -> tuple[float, float, float] | None:
    """Noise of gyro (rad/s) and accelerometer (m/s²) per sample and the size of the gyro's bias (rad/s), at rest.

    None if the record does not start at rest. No magnetometer is needed.
    """
    seconds = rest_seconds(flight)
    rest = flight.time - flight.time[0] <= seconds
    if seconds == 0 or int(rest.sum()) < 2:
        return None
    gyro, accel = flight.gyro[rest], flight.accel[rest]
    bias = float(np.linalg.norm(gyro.mean(axis=0)))
    return float(gyro.std(axis=0).mean()), float(accel.std(axis=0).mean()), bias


def world_of(
    flight: Flight, *, anchor: Vec3, vectors: tuple[Vec3, Vec3] | None = None, confirmed: bool = False
) -> tuple[World | None, tuple[Question, ...], str]:
    """The world of a record: from `vectors`, (gravity, magnetic), else from the file, else from its rest if confirmed.

    Returns the world, or None; the questions that are open; and a clause on where gravity and field come from.
    """
    of_file = (flight.gravity, flight.magnetic) if flight.gravity is not None and flight.magnetic is not None else None
    if vectors is not None or of_file is not None:
        gravity, magnetic = vectors or of_file  # type: ignore[misc]
        source = "as given" if vectors else "as the file says"
        return World(gravity=gravity, magnetic=magnetic, anchor=anchor), (), f"gravity and field {source}"
    seconds = rest_seconds(flight)
    if seconds == 0:
        evidence = "the record does not start still, so nothing tells them"
        return None, (_question(None, evidence),), ""
    try:
        rest = rest_of(flight, seconds)
    except ValueError as error:
        return None, (_question(None, str(error)),), ""
    if not confirmed:
        size = float(np.linalg.norm(rest.gravity))
        earthly = USUAL_GRAVITY[0] / SLACK < size < USUAL_GRAVITY[1] * SLACK  # else it is no gravity to go by
        return None, (_question("still" if earthly else None, rest.summary),), ""
    return World(gravity=rest.gravity, magnetic=rest.magnetic, anchor=anchor), (), rest.summary


def _question(suggestion: str | None, evidence: str) -> Question:
    """Where gravity and field point. The still start is an option only where it is suggested: else it tells neither."""
    return Question(
        key="world",
        flag="--world",
        asks="where do gravity and the magnetic field point",
        options=(*(("still",) if suggestion else ()), "given --gravity X Y Z --magnetic X Y Z"),
        suggestion=suggestion,
        evidence=evidence,
    )


def _level_axes(accel: Array, mag: Array, frame: Frame) -> tuple[Array, Array]:
    """Specific force and magnetic field in axes with z along the force (z-up) or against it, and x towards north."""
    sign = 1.0 if frame == "z-up" else -1.0
    up = accel / np.linalg.norm(accel)
    vertical = float(mag @ up)
    level = float(np.linalg.norm(mag - vertical * up))
    force = np.array([0.0, 0.0, sign * np.linalg.norm(accel)])
    return force, np.array([level, 0.0, sign * vertical])


def _averaged(values: Float[Array, "n 3"], width: int) -> Float[Array, "n 3"]:
    """The mean over `width` samples around each sample."""
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(values, axis=0)])
    first = np.clip(np.arange(len(values)) - width // 2, 0, len(values) - width)
    return (total[first + width] - total[first]) / width


def _vec(values: Array) -> Vec3:
    x, y, z = values.tolist()
    return x, y, z
