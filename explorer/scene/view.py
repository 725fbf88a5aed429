"""Where the camera stands: set anew when the path is somewhere else, and never while someone moves it.

While a handle is dragged it stands still. It stays after the drag, too, unless the path was in view and has left it.
"""

import math
import time as clock
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import CameraHandle
from viser.transforms import SO3

from explorer.scene.bounds import SceneBounds

RESTING = 0.5
"""s without camera movement, after which the camera may be set anew."""
REFRAME, SHIFT = 1.6, 0.5
"""Factor by which the stage must grow or shrink, or radii by which it must shift, before the camera is set anew."""
SIDE = np.array([0.5, 1.0, 0.25])
"""Whence the camera looks, before the part along up is taken away: across x, along which most paths are longest."""
HEIGHT = 0.55
"""Of the camera's direction, against its horizontal distance."""
MARGIN = 1.2
FAR, FAR_DISTANCES = 1000.0, 60.0
"""m, and distances of the camera, up to which things are drawn."""
TRIES = 3
IN_VIEW = 0.5
"""Share of a path that must be seen for the path to be in view."""
ARRIVED = 0.02
"""Of the distance: a camera this near to where it was sent has arrived."""
RESHAPED = 0.05
"""Share by which the narrower side of the picture must change, as when docks open, before it is framed anew."""


class Aim(NamedTuple):
    """Where the camera was sent, and how often that may still be said again."""

    position: Float[Array, "3"]
    target: Float[Array, "3"]
    tries: int


class View:
    """The camera of one visitor."""

    def __init__(self, camera: CameraHandle) -> None:
        self._camera = camera
        self._framed: SceneBounds | None = None
        self._aim: Aim | None = None
        self._sent: Aim | None = None
        self._narrowest = 1.0
        """Width by height of the picture that was framed, at most 1."""
        self._dragged = self._seen = False
        camera.on_update(self._confirm)

    def frame(self, on: SceneBounds, path: Float[Array, "n 3"], *, dragging: bool = False) -> None:
        """Look at path and anchor from above, if they are not where the camera was set last."""
        if dragging:
            if not self._dragged:
                self._dragged, self._seen = True, self._sees(path)
            return
        dragged, self._dragged = self._dragged, False
        left = dragged and self._seen and not self._sees(path)
        if dragged and not left:
            self._framed = on  # as the visitor likes to look at it: only what comes after counts
            return
        before = self._framed
        if before is not None:
            moving = clock.time() - self._camera.update_timestamp < RESTING
            if moving or (alike(before, on) and not left):
                return
        self._framed = on
        self._look(on)

    def _look(self, on: SceneBounds) -> None:
        self._narrowest = narrowest(self._camera)
        half = math.atan(math.tan(self._camera.fov / 2) * self._narrowest)
        distance = MARGIN * on.view_radius / math.sin(half)
        self._camera.far = max(FAR, FAR_DISTANCES * distance)
        self._send(Aim(on.view_centre + distance * direction(on.up), on.view_centre, TRIES))

    def _sees(self, path: Float[Array, "n 3"]) -> bool:
        camera = self._camera
        shape = camera.image_width / max(camera.image_height, 1)
        return seen(path, np.asarray(camera.position), np.asarray(camera.wxyz), camera.fov, shape) >= IN_VIEW

    def _send(self, aim: Aim) -> None:
        self._aim = self._sent = aim
        self._camera.position = aim.position
        self._camera.look_at = aim.target

    def _confirm(self, camera: CameraHandle) -> None:
        """The page tells its camera. It takes up a new up direction only after the camera that came along with it,
        and is then elsewhere: say it again. Docks that have opened since leave a narrower picture: frame it anew,
        unless the visitor has moved the camera."""
        aim, sent, on = self._aim, self._sent, self._framed
        if sent is None or on is None:
            return
        off = float(np.linalg.norm(np.asarray(camera.position) - sent.position))
        there = off <= ARRIVED * np.linalg.norm(sent.position - sent.target)
        self._aim = None
        if aim is not None and not there and aim.tries > 0:
            self._send(aim._replace(tries=aim.tries - 1))
        elif there and abs(narrowest(camera) / self._narrowest - 1) > RESHAPED:
            self._look(on)


def narrowest(camera: CameraHandle) -> float:
    """The width of the picture by its height, at most 1."""
    return max(1, min(camera.image_width, camera.image_height)) / max(camera.image_height, 1)


def seen(
    path: Float[Array, "n 3"], position: Float[Array, "3"], wxyz: Float[Array, "4"], fov: float, shape: float
) -> float:
    """The share of a path that a camera sees: at its place, turned by a quaternion that takes (right, down, ahead) to
    the inertial axes, with a vertical field of view (rad) and a picture `shape` times as wide as high."""
    right, down, ahead = (SO3(wxyz).inverse().as_matrix() @ (path - position).T).astype(float)
    top = math.tan(fov / 2)
    return float(np.mean((ahead > 0) & (np.abs(down) <= top * ahead) & (np.abs(right) <= shape * top * ahead)))


def alike(before: SceneBounds, on: SceneBounds) -> bool:
    """Whether a camera set for one stage does for the other."""
    ratio = on.view_radius / before.view_radius
    shift = float(np.linalg.norm(on.view_centre - before.view_centre)) / before.view_radius
    return 1 / REFRAME < ratio < REFRAME and shift < SHIFT and np.allclose(on.up, before.up)


def direction(up: Float[Array, "3"]) -> Float[Array, "3"]:
    """The unit vector from the stage to the camera."""
    level = SIDE - SIDE @ up * up
    raised = level / np.linalg.norm(level) + HEIGHT * up
    return raised / np.linalg.norm(raised)
