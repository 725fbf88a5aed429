"""Naming the axes anew: z down, as the paper has it, or z up. The same motion, described in turned axes.

Both the inertial and the body frame are turned by half a turn about x, F = diag(1, −1, −1) (NED and FRD become NWU and
FLU): p → Fp, R → FRF, ω → Fω, g → Fg. It is its own inverse, and nothing that can be measured changes.
"""

import msgspec
import numpy as np

from rangenav import provenance
from rangenav.inputs import Vec3, require
from rangenav.motion import World
from rangenav.preset import Preset
from rangenav.sensors import Sensors, effects
from rangenav.signals import AngularVelocity, Flown, Polynomials, Signal, Sum
from rangenav.signals.polynomials import Coefficients

FLIP = np.diag([1.0, -1.0, -1.0])
NO_SHIFT = np.zeros(3)
ALONG = 1e-9
"""Share of gravity that may lie across z."""


def z_up(world: World) -> bool:
    """Whether z points up. Raises ValueError if gravity does not lie along it."""
    x, y, z = world.gravity
    rule = f"gravity must lie along z to be written z-up, got ({x:g}, {y:g}, {z:g})"
    require(max(abs(x), abs(y)) <= ALONG * abs(z), rule)
    return z < 0


def upright(preset: Preset) -> Preset:
    """The same run in a z-up world with forward-left-up body axes, as vehicles and robots have them: a level body stays
    level and an accelerometer at rest reads +9.81 along z. Raises ValueError if gravity does not lie along z."""
    return preset if z_up(preset.world) else flipped(preset)


def flipped(preset: Preset) -> Preset:
    """The preset with y and z the other way round, inertial and body axes alike; a path that was imported stays one."""
    guess, path = preset.guess, flipped_signal(preset.path)
    return msgspec.structs.replace(
        preset,
        path=path,
        source=provenance.renamed(preset.source, preset.path, path),
        angular_velocity=flipped_turning(preset.angular_velocity),
        initial_rotation=flipped_vector(preset.initial_rotation),
        world=World(
            gravity=flipped_vector(preset.world.gravity),
            magnetic=flipped_vector(preset.world.magnetic),
            anchor=flipped_vector(preset.world.anchor),
        ),
        sensors=_flipped_sensors(preset.sensors),
        guess=msgspec.structs.replace(
            guess,
            position_offset=flipped_vector(guess.position_offset),
            velocity_offset=flipped_vector(guess.velocity_offset),
            gravity_offset=flipped_vector(guess.gravity_offset),
            attitude_axis=flipped_vector(guess.attitude_axis),
        ),
    )


def _flipped_sensors(sensors: Sensors) -> Sensors:
    """Biases and the lever arm are vectors in body axes."""
    known = sensors.unmodelled
    vectors = [name for name, row in effects.rows().items() if row.body_vector]
    turned = {name: flipped_vector(getattr(known, name)) for name in vectors}
    return msgspec.structs.replace(sensors, unmodelled=msgspec.structs.replace(known, **turned))


def flipped_vector(vector: Vec3) -> Vec3:
    """(x, −y, −z); a zero keeps its sign."""
    x, y, z = vector
    return x, 0.0 - y, 0.0 - z


def flipped_signal(signal: Signal) -> Signal:
    """The signal in the other axes, of the same family; the yaw of its pieces is about the other z."""
    if isinstance(signal, Sum):
        parts = {name: flipped_signal(getattr(signal, name)) for name in ("base", "wiggle")}
        return msgspec.structs.replace(signal.mapped(FLIP, NO_SHIFT), **parts)
    turned = signal.mapped(FLIP, NO_SHIFT)
    if not isinstance(turned, Polynomials):
        return turned
    pieces = tuple(msgspec.structs.replace(piece, yaw=_negative(piece.yaw)) for piece in turned.pieces)
    return msgspec.structs.replace(turned, pieces=pieces)


def flipped_turning(turning: AngularVelocity) -> AngularVelocity:
    """An angular velocity in the other axes; flown, the yaw about a z axis that points the other way."""
    if isinstance(turning, Flown):
        return Flown(yaw=negated(turning.yaw))
    return flipped_signal(turning)


def _negative(yaw: Coefficients) -> Coefficients:
    a, b, c, d, e, f, g, h = (0.0 - value for value in yaw)
    return a, b, c, d, e, f, g, h


def negated(formula: str) -> str:
    """Minus the formula; minus that is the formula as it was typed."""
    text = formula.strip()
    if text == "0":
        return text
    if text.startswith("-(") and text.endswith(")") and _closes_at_end(text[1:]):
        return text[2:-1]
    return f"-({text})"


def _closes_at_end(text: str) -> bool:
    """Whether the parenthesis that opens the text closes with its last character."""
    depth = 0
    for k, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if depth == 0:
            return k == len(text) - 1
    return False
