"""Motions with tones along any directions: circles in any plane, and a body that tumbles."""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from rangenav.signals import Multisine, Tone


def turned(tones: list[tuple[np.ndarray, float, float]], **fields: tuple) -> Multisine:
    """A Multisine whose tones lie along any vectors: (vector amplitude, frequency, phase)."""
    split = [
        Tone(axis=axis, amplitude=float(vector["xyz".index(axis)]), frequency=w, phase=phase)
        for vector, w, phase in tones
        for axis in ("x", "y", "z")
    ]
    return Multisine(tones=tuple(split), **fields)


def circle(radius: float, w: float, phase: float, orientation: Rotation) -> Multisine:
    """A circle in the plane of the first two columns of a rotation."""
    e1, e2, _ = orientation.as_matrix().T
    return turned([(radius * e1, w, phase + math.pi / 2), (radius * e2, w, phase)])


def tilted(tilt: float, heading: float) -> Rotation:
    """A plane whose normal is inclined to the vertical by tilt (rad)."""
    return Rotation.from_euler("ZX", [heading, tilt])


def tumbling() -> Multisine:
    """An angular velocity (rad/s) about all three axes, at three frequencies."""
    return Multisine(
        tones=(
            Tone(axis="x", amplitude=2.0, frequency=1.3),
            Tone(axis="y", amplitude=1.5, frequency=0.9, phase=1.0),
            Tone(axis="z", amplitude=1.0, frequency=1.7, phase=2.0),
        )
    )
