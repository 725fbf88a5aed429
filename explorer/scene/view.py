"""The camera frames the path anew when the path is somewhere else, but never while the visitor moves the camera.

viser's thread   the browser has reported its camera: wake() if `follow_up` has work to do      nothing else
session's loop   view.frame(bounds, path)     after each drawing
                 view.follow_up()             in each round of the loop

While a handle is dragged the camera stands still. It stays after the drag, too, unless the path was in view and has
left it.
"""

import math
import time as clock
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import CameraHandle
from viser.transforms import SO3

from explorer.scene.bounds import SceneBounds

IDLE_TIME = 0.5
"""s without camera movement, after which the path may be framed anew."""
MAX_ZOOM, MAX_SHIFT = 1.6, 0.5
"""Factor by which the scene must grow or shrink, or radii by which it must shift, to be framed anew."""
SIDE = np.array([0.5, 1.0, 0.25])
"""The direction from the scene to the camera, whose part along up is then removed: across x, along which most paths
are longest."""
HEIGHT = 0.55
"""The camera's height by its horizontal distance."""
MARGIN = 1.2
FAR, FAR_DISTANCES = 1000.0, 60.0
"""m, and distances of the camera, up to which nodes are drawn."""
MAX_RETRIES = 3
MIN_VISIBLE_SHARE = 0.5
"""Share of a path that must be visible for the path to be in view."""
WHOLE = 0.97
"""Share of a path that must be visible as long as the visitor has not moved the camera."""
POSE_TOLERANCE = 0.02
"""Share of the distance within which a camera is where it was sent."""
ENOUGH_POINTS = 500
"""Of a path: the share of them that is visible is that of the path."""
MIN_RESHAPE = 0.05
"""Share by which the narrower side of the picture must change, as when docks open, to be framed anew."""


TURN, CLOSER, STEEPEST = math.radians(15.0), 1.25, math.radians(85.0)
"""rad and factor of one step around the scene and towards it; rad above or below the ground that a step reaches."""
PARALLEL = 1e-6
"""Share of a vector that is level, below which the vector is along up."""
Direction = Literal["first", "above", "x", "y"]
"""From where the whole scene is seen: as at first, from above, against x, against y."""
Step = Literal["left", "right", "up", "down", "closer", "farther"]
"""How the camera moves about the point that it looks at."""


class CameraPose(NamedTuple):
    """Where the camera was sent."""

    position: Float[Array, "3"]
    target: Float[Array, "3"]


class View:
    """The camera of one visitor."""

    def __init__(self, camera: CameraHandle, wake: Callable[[], None]) -> None:
        """`wake` is called from viser's threads when `follow_up` has work to do."""
        self._camera, self._wake = camera, wake
        self._framed: SceneBounds | None = None
        self._sent: CameraPose | None = None
        self._retries = 0
        """How often the pose may still be sent again; 0 once the browser has reported that the camera is there."""
        self._reported = False
        """Whether the browser has reported its camera since the last `follow_up`."""
        self._narrowest = 1.0
        """Width by height of the picture that was framed, at most 1."""
        self._dragging = self._was_in_view = False
        self._chosen = False
        """Whether somebody has chosen where the camera is: it then stays there when docks open."""
        camera.on_update(self._camera_reported)

    def frame(self, bounds: SceneBounds, path: Float[Array, "n 3"], *, dragging: bool = False) -> None:
        """Look at path and anchor from above, unless the camera was last sent to about the same view."""
        if dragging:
            if not self._dragging:
                self._dragging, self._was_in_view = True, self._in_view(path)
            return
        ended, self._dragging = self._dragging, False
        left = ended and self._was_in_view and not self._in_view(path)
        if ended and not left:
            self._framed = bounds  # the visitor chose this view: only a later change of the path counts
            return
        before = self._framed
        if before is not None:
            moving = clock.time() - self._camera.update_timestamp < IDLE_TIME
            if moving or (same_framing(before, bounds) and not left and not self._runs_out(path)):
                return
        self._framed = bounds
        self._look(bounds)

    def look(self, direction: Direction) -> None:
        """Look at path and anchor from a direction, wherever the visitor has moved the camera."""
        if self._framed is not None:
            self._look(self._framed, direction)

    def step(self, step: Step) -> None:
        """Move around the point that the camera looks at, or towards it."""
        if self._framed is None:
            return
        position, target = np.asarray(self._camera.position), np.asarray(self._camera.look_at)
        self._chosen = True
        self._send(CameraPose(target + stepped(position - target, self._framed.up, step), target), MAX_RETRIES)

    def look_from(self, position: Float[Array, "3"], target: Float[Array, "3"], bounds: SceneBounds) -> None:
        """Look from a place at a point (m), as somebody else does; the path is not framed anew for that."""
        self._framed, self._chosen = bounds, True
        self._send(CameraPose(position, target), MAX_RETRIES)

    def follow_up(self) -> bool:
        """React to the camera that the browser has reported. Returns whether it has reported one.

        The browser takes over a new up direction only after the camera pose that was sent with it, and the camera is
        then elsewhere: the pose is sent again, at most three times. Docks that have opened since leave a narrower
        picture: the path is framed anew, unless the visitor has moved the camera.
        """
        if not self._reported or self._sent is None or self._framed is None:
            return False
        self._reported = False
        retries, self._retries = self._retries, 0
        if not self._at(self._sent):
            if retries > 0:
                self._send(self._sent, retries - 1)
        elif self._reshaped() and not self._chosen:
            self._look(self._framed)
        return True

    def _camera_reported(self, _: CameraHandle) -> None:
        self._reported = True
        if self._retries > 0 or self._reshaped():
            self._wake()

    def _look(self, bounds: SceneBounds, direction: Direction = "first") -> None:
        self._chosen = direction != "first"
        self._narrowest = width_by_height(self._camera)
        half = math.atan(math.tan(self._camera.fov / 2) * self._narrowest)
        distance = MARGIN * bounds.view_radius / math.sin(half)
        self._camera.far = max(FAR, FAR_DISTANCES * distance)
        position = bounds.view_centre + distance * view_direction(bounds.up, direction)
        self._send(CameraPose(position, bounds.view_centre), MAX_RETRIES)

    def _send(self, pose: CameraPose, retries: int) -> None:
        self._sent, self._retries, self._reported = pose, retries, False
        self._camera.position = pose.position
        self._camera.look_at = pose.target

    def _at(self, pose: CameraPose) -> bool:
        off = float(np.linalg.norm(np.asarray(self._camera.position) - pose.position))
        return off <= POSE_TOLERANCE * float(np.linalg.norm(pose.position - pose.target))

    def _reshaped(self) -> bool:
        return abs(width_by_height(self._camera) / self._narrowest - 1) > MIN_RESHAPE

    def _runs_out(self, path: Float[Array, "n 3"]) -> bool:
        """Whether a path leaves the picture of a camera that the visitor has not moved."""
        return self._sent is not None and not self._chosen and self._at(self._sent) and not self._in_view(path, WHOLE)

    def _in_view(self, path: Float[Array, "n 3"], least: float = MIN_VISIBLE_SHARE) -> bool:
        camera = self._camera
        shape = camera.image_width / max(camera.image_height, 1)
        some = path[:: max(len(path) // ENOUGH_POINTS, 1)]
        share = visible_share(some, np.asarray(camera.position), np.asarray(camera.wxyz), camera.fov, shape)
        return share >= least


def width_by_height(camera: CameraHandle) -> float:
    """The width of the picture by its height, at most 1."""
    return max(1, min(camera.image_width, camera.image_height)) / max(camera.image_height, 1)


def visible_share(
    path: Float[Array, "n 3"], position: Float[Array, "3"], wxyz: Float[Array, "4"], fov: float, shape: float
) -> float:
    """The share of a path's points that a camera sees.

    The camera stands at `position`. The quaternion takes (right, down, ahead) to the inertial axes, `fov` is the
    vertical field of view (rad), and `shape` is the picture's width by its height.
    """
    right, down, ahead = (SO3(wxyz).inverse().as_matrix() @ (path - position).T).astype(float)
    top = math.tan(fov / 2)
    return float(np.mean((ahead > 0) & (np.abs(down) <= top * ahead) & (np.abs(right) <= shape * top * ahead)))


def same_framing(before: SceneBounds, bounds: SceneBounds) -> bool:
    """Whether a camera that frames one scene also frames the other."""
    ratio = bounds.view_radius / before.view_radius
    shift = float(np.linalg.norm(bounds.view_centre - before.view_centre)) / before.view_radius
    return 1 / MAX_ZOOM < ratio < MAX_ZOOM and shift < MAX_SHIFT and np.allclose(bounds.up, before.up)


def view_direction(up: Float[Array, "3"], direction: Direction = "first") -> Float[Array, "3"]:
    """The unit vector from the scene to the camera."""
    if direction in ("x", "y"):
        return _level(np.array([float(direction == "x"), float(direction == "y"), 0.0]), up)
    if direction == "above":
        return math.cos(STEEPEST) * _level(SIDE, up) + math.sin(STEEPEST) * up
    raised = _level(SIDE, up) + HEIGHT * up
    return raised / np.linalg.norm(raised)


def stepped(away: Float[Array, "3"], up: Float[Array, "3"], step: Step) -> Float[Array, "3"]:
    """Where the camera is after a step, as its vector (m) from the point that it looks at."""
    if step in ("closer", "farther"):
        return away / CLOSER if step == "closer" else away * CLOSER
    distance = float(np.linalg.norm(away))
    sine = float(away @ up) / distance if distance else 0.0
    raised = math.asin(min(max(sine, -1.0), 1.0)) + {"up": TURN, "down": -TURN}.get(step, 0.0)
    raised = min(max(raised, -STEEPEST), STEEPEST)
    turned = SO3.exp({"left": -TURN, "right": TURN}.get(step, 0.0) * up).as_matrix() @ _level(away, up)
    return distance * (math.cos(raised) * turned + math.sin(raised) * up)


def _level(vector: Float[Array, "3"], up: Float[Array, "3"]) -> Float[Array, "3"]:
    """The unit vector along the part of a vector that is level; along another level direction where it has none."""
    for one in (vector, SIDE, np.roll(SIDE, 1)):
        level = one - one @ up * up
        length = float(np.linalg.norm(level))
        if length > PARALLEL * float(np.linalg.norm(one)):
            return level / length
    raise AssertionError("two directions that differ are not both along up")
