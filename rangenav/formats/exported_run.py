"""One run of a preset as a logger records it: truth and measurements, in the preset's frame or z-up."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import axes, record
from rangenav.formats import frames
from rangenav.formats.recorded_flight import Frame
from rangenav.inputs import Vec3
from rangenav.preset import Preset
from rangenav.results import result

INERTIAL = ("position", "velocity", "acceleration", "jerk", "snap")
BODY = ("angular_velocity", "gyro", "accel", "mag")


@result
class ExportedRun:
    """Truth and measurements, time first; in the inertial frame unless a field says body."""

    time: Float[Array, "n"]
    position: Float[Array, "n 3"]
    velocity: Float[Array, "n 3"]
    acceleration: Float[Array, "n 3"]
    jerk: Float[Array, "n 3"]
    snap: Float[Array, "n 3"]
    rotation: Float[Array, "n 3 3"]
    """Body to inertial."""
    angular_velocity: Float[Array, "n 3"]
    """rad/s, body."""
    gyro: Float[Array, "n 3"]
    accel: Float[Array, "n 3"]
    """m/s², body: apparent acceleration, as measured."""
    mag: Float[Array, "n 3"]
    """Body; NaN between samples."""
    range_time: Float[Array, "m"]
    range: Float[Array, "m"]
    gravity: Vec3
    magnetic: Vec3
    anchor: Vec3
    frame: Frame | None
    """None if gravity does not point along z; `gravity` then says where it points."""


def run_of(preset: Preset) -> ExportedRun:
    """The preset's run, in its own frame and with its own seed."""
    course = record.truth_inputs(preset)
    truth, z, world = (
        record.simulated(course).motion,
        record.measured(course, preset.sensors, preset.seed),
        preset.world,
    )
    try:
        frame = "z-up" if axes.z_up(world) else "z-down"
    except ValueError:
        frame = None
    return ExportedRun(
        **{name: getattr(truth, name) for name in ("time", *INERTIAL, "rotation", "angular_velocity")},
        **{name: getattr(z, name) for name in ("gyro", "accel", "mag", "range_time", "range")},
        gravity=world.gravity,
        magnetic=world.magnetic,
        anchor=world.anchor,
        frame=frame,
    )


def upright_run(preset: Preset) -> ExportedRun:
    """The same numbers in a z-up world, forward-left-up body axes. Raises ValueError if gravity lies beside z."""
    run = run_of(preset)
    if axes.z_up(preset.world):
        return run
    change, turn = frames.Z_UP_Z_DOWN, frames.FRD_FLU
    return replace(
        run,
        **{name: frames.vector(change, getattr(run, name)) + 0.0 for name in INERTIAL},
        **{name: frames.vector(turn, getattr(run, name)) + 0.0 for name in BODY},
        rotation=change @ run.rotation @ turn,
        **{name: axes.flipped_vector(getattr(run, name)) for name in ("gravity", "magnetic", "anchor")},
        frame="z-up",
    )


def quaternions(run: ExportedRun) -> Float[Array, "n 4"]:
    """Attitude as quaternions (wxyz, body to inertial) whose signs do not jump."""
    return frames.continuous(frames.from_rotation(run.rotation))


def nanoseconds(time: Float[Array, "n"]) -> list[int]:
    """Whole nanoseconds."""
    return np.rint(time * 1e9).astype(np.int64).tolist()
