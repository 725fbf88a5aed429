"""The bodies of vehicles, of about unit span, z up, x ahead: vertices and faces in plain numpy.

A quadrotor for vehicles with a limit on thrust, a hand-held unit for one that is carried, and else a rigid body with a
nose: an inertial measurement unit with nothing around it.
"""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.vehicle import HAND_HELD
from rangenav.vehicle import Vehicle as Limits

Shape = Literal["quadrotor", "hand-held", "rigid body"]
ARM, ROTOR, SIDES = 0.42, 0.24, 20
"""Half the diagonal between rotors, a rotor's radius, and the corners of its disc."""
FACES = ("013", "032", "467", "475", "045", "051", "237", "276", "026", "064", "157", "173")
"""Two triangles for each side of a box whose corners are numbered 4x + 2y + z."""
BOX_FACES = np.array([[int(corner) for corner in face] for face in FACES])


class Mesh(NamedTuple):
    """A triangle mesh."""

    vertices: Float[Array, "v 3"]
    faces: Int[Array, "f 3"]


def shape_of(vehicle: Limits) -> Shape:
    """The body of a vehicle."""
    if vehicle.thrust_to_weight is not None:
        return "quadrotor"
    return "hand-held" if vehicle.name == HAND_HELD.name else "rigid body"


def body(shape: Shape) -> Mesh:
    """The opaque part, with a nose that shows which way is ahead."""
    return {"quadrotor": _frame, "hand-held": _hand_held, "rigid body": _rigid_body}[shape]()


def see_through(shape: Shape) -> Mesh:
    """The part that is half transparent: the rotors, the screen of the hand-held unit, the lid of the rigid body."""
    if shape == "quadrotor":
        return _rotors()
    size, middle = (
        ((0.42, 0.3, 0.02), (0.0, 0.0, 0.1)) if shape == "hand-held" else ((0.5, 0.36, 0.02), (0.0, 0.0, 0.17))
    )
    return _join([(_box(size) + np.array(middle), BOX_FACES)])


def beacon() -> Mesh:
    """The anchor's head: three rings, one above the other, as of waves that leave it."""
    rings = [_ring(radius, height) for radius, height in ((0.55, 0.0), (0.85, 0.28), (0.85, -0.28))]
    return _join(rings)


def _frame() -> Mesh:
    """Two crossed arms, a body, and a nose."""
    bars = [_box((2 * ARM, 0.07, 0.06)) @ _about_z(angle) for angle in (np.pi / 4, -np.pi / 4)]
    hub, nose = _box((0.34, 0.2, 0.14)), _box((0.3, 0.07, 0.07)) + np.array([0.28, 0.0, 0.0])
    legs = [_box((0.04, 0.04, 0.16)) + np.array([x, y, -0.12]) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    return _join([(corners, BOX_FACES) for corners in (*bars, hub, nose, *legs)])


def _rotors() -> Mesh:
    """Four discs above the ends of the arms."""
    angles = np.pi / 4 + np.arange(4) * np.pi / 2
    centres = ARM * np.stack([np.cos(angles), np.sin(angles), np.full(4, 0.2)], axis=1)
    rim = np.linspace(0, 2 * np.pi, SIDES, endpoint=False)
    disc = np.vstack([[0.0, 0.0, 0.0], np.stack([np.cos(rim), np.sin(rim), 0 * rim], axis=1) * ROTOR])
    edge = np.arange(SIDES)
    fan = np.stack([np.zeros(SIDES, dtype=int), 1 + edge, 1 + (edge + 1) % SIDES], axis=1)
    return _join([(disc + centre, fan) for centre in centres])


def _hand_held() -> Mesh:
    """A slab with a grip below and an antenna ahead."""
    slab, grip = _box((0.5, 0.38, 0.16)), _box((0.14, 0.16, 0.42)) + np.array([-0.12, 0.0, -0.28])
    antenna = _box((0.06, 0.06, 0.34)) + np.array([0.2, 0.0, 0.24])
    nose = _box((0.14, 0.1, 0.1)) + np.array([0.32, 0.0, 0.0])
    return _join([(corners, BOX_FACES) for corners in (slab, grip, antenna, nose)])


def _rigid_body() -> Mesh:
    """A box that is longest ahead, with a nose."""
    box, nose = _box((0.6, 0.42, 0.3)), _box((0.26, 0.12, 0.12)) + np.array([0.42, 0.0, 0.0])
    return _join([(corners, BOX_FACES) for corners in (box, nose)])


def _ring(radius: float, height: float) -> tuple[Array, Array]:
    """A flat band around z."""
    angles = np.linspace(0, 2 * np.pi, 2 * SIDES, endpoint=False)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    inner, outer = (np.column_stack([factor * radius * around, np.full(len(angles), height)]) for factor in (0.86, 1.0))
    k = np.arange(len(angles))
    after, far = (k + 1) % len(angles), len(angles)
    return np.vstack([inner, outer]), np.vstack(
        [np.stack([k, far + k, after], 1), np.stack([after, far + k, far + after], 1)]
    )


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
