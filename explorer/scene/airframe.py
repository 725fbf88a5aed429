"""A small quadrotor of about unit span, z up, x ahead: vertices and faces in plain numpy."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

ARM, ROTOR, SIDES = 0.42, 0.24, 20
"""Half the diagonal between rotors, a rotor's radius, and the corners of its disc."""
FACES = ("013", "032", "467", "475", "045", "051", "237", "276", "026", "064", "157", "173")
"""Two triangles for each side of a box whose corners are numbered 4x + 2y + z."""
BOX_FACES = np.array([[int(corner) for corner in face] for face in FACES])


class Mesh(NamedTuple):
    """A triangle mesh."""

    vertices: Float[Array, "v 3"]
    faces: Int[Array, "f 3"]


def frame() -> Mesh:
    """Two crossed arms, a body, and a nose that shows which way is ahead."""
    bars = [_box((2 * ARM, 0.05, 0.04)) @ _about_z(angle) for angle in (np.pi / 4, -np.pi / 4)]
    body, nose = _box((0.3, 0.18, 0.12)), _box((0.22, 0.05, 0.05)) + np.array([0.22, 0.0, 0.0])
    return _join([(corners, BOX_FACES) for corners in (*bars, body, nose)])


def rotors() -> Mesh:
    """Four discs above the ends of the arms."""
    angles = np.pi / 4 + np.arange(4) * np.pi / 2
    centres = ARM * np.stack([np.cos(angles), np.sin(angles), np.full(4, 0.15)], axis=1)
    rim = np.linspace(0, 2 * np.pi, SIDES, endpoint=False)
    disc = np.vstack([[0.0, 0.0, 0.0], np.stack([np.cos(rim), np.sin(rim), 0 * rim], axis=1) * ROTOR])
    edge = np.arange(SIDES)
    fan = np.stack([np.zeros(SIDES, dtype=int), 1 + edge, 1 + (edge + 1) % SIDES], axis=1)
    return _join([(disc + centre, fan) for centre in centres])


def _box(size: tuple[float, float, float]) -> Float[Array, "8 3"]:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return corners * np.array(size) / 2


def _about_z(angle: float) -> Float[Array, "3 3"]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def _join(parts: list[tuple[Array, Array]]) -> Mesh:
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])[:-1]
    faces = [faces + start for (_, faces), start in zip(parts, starts, strict=True)]
    return Mesh(np.vstack([vertices for vertices, _ in parts]), np.vstack(faces))
