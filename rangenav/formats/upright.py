"""A preset or the arrays of its run in a z-up world with forward-left-up body axes, as vehicles and robots have them.

From a z-down world (the paper's) both the inertial frame and the body are turned over: p' = F p, R' = F R F and
ω' = F ω with F = diag(1, −1, −1), so a level body stays level and an accelerometer at rest reads +9.81 along z.
"""

import msgspec
import numpy as np

from rangenav.formats.flights import Frame
from rangenav.formats.frames import FRD_FLU, Z_UP_Z_DOWN
from rangenav.inputs import Vec3, require
from rangenav.preset import Preset
from rangenav.signals import Flown, Polynomials, Signal, mapped
from rangenav.signals.polynomials import Coefficients

ALONG = 1e-9
"""Share of gravity that may lie beside z."""


def frame_of(preset: Preset) -> Frame:
    """Which way z points. Raises ValueError if gravity does not lie along it."""
    x, y, z = preset.world.gravity
    rule = f"gravity must lie along z to be written z-up, got ({x:g}, {y:g}, {z:g})"
    require(max(abs(x), abs(y)) <= ALONG * abs(z), rule)
    return "z-down" if z > 0 else "z-up"


def upright(preset: Preset) -> Preset:
    """The same run in a z-up world; a preset that is z-up stays what it is."""
    if frame_of(preset) == "z-up":
        return preset
    world = preset.world
    flipped = msgspec.structs.replace(
        world, gravity=flip(world.gravity), magnetic=flip(world.magnetic), anchor=flip(world.anchor)
    )
    turning = preset.angular_velocity
    flown = isinstance(turning, Flown)
    turned = Flown(yaw=f"-({turning.yaw})") if flown else mapped(turning, FRD_FLU, np.zeros(3))
    return msgspec.structs.replace(
        preset,
        path=_path(preset.path),
        angular_velocity=turned,
        world=flipped,
        initial_rotation=flip(preset.initial_rotation),
    )


def flip(value: Vec3) -> Vec3:
    """(x, −y, −z)."""
    x, y, z = (Z_UP_Z_DOWN @ np.asarray(value) + 0.0).tolist()  # + 0.0: no negative zeros
    return x, y, z


def _path(path: Signal) -> Signal:
    turned = mapped(path, Z_UP_Z_DOWN, np.zeros(3))
    if isinstance(turned, Polynomials):
        pieces = tuple(msgspec.structs.replace(piece, yaw=_negative(piece.yaw)) for piece in turned.pieces)
        return msgspec.structs.replace(turned, pieces=pieces)
    return turned


def _negative(yaw: Coefficients) -> Coefficients:
    a, b, c, d, e, f, g, h = (-value for value in yaw)
    return a, b, c, d, e, f, g, h
