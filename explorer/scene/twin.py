"""The evil twin in the 3-D picture: its path, its vehicle, and both ranges from the anchor, which are equally long."""

import threading
from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import MeshHandle, SceneApi, SceneNodeDragEvent

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.scene.airframe import shape_of
from explorer.scene.bounds import EMPTY_LINE, MAX_POINTS, SceneBounds, dashes_along, nearest_sample
from explorer.scene.labels import Labels
from explorer.scene.vehicle import Vehicle
from rangenav.inputs import Vec3
from rangenav.twin import Refusal, Twin

MAX_REACH = 1e6
"""m from the origin along each axis; a drag beyond it is ignored, for no visitor can point there."""


class TwinGhost:
    """The nodes /twin, /twin_path and /twin_ranges; hidden while there is no twin."""

    def __init__(self, scene: SceneApi, labels: Labels, wake: Callable[[], None]) -> None:
        """`wake` is called from viser's loop when the visitor has dragged the twin."""
        self._wake, self._lock = wake, threading.Lock()
        self._twin: Twin | None = None
        self._instructs = True
        self._dragged: Vec3 | None = None
        self._bounds: SceneBounds | None = None
        color = palette.rgb(palette.TWIN)
        self._path = scene.add_line_segments("/twin_path", EMPTY_LINE, color, thickness=3.0, thickness_units="screen")
        self._ranges = scene.add_line_segments(
            "/twin_ranges", EMPTY_LINE, color, thickness=1.5, thickness_units="screen"
        )
        # opaque: a translucent vehicle is lost inside the range sphere
        self._vehicle = Vehicle(scene, labels, "twin", palette.TWIN, opacity=None, rank=4)
        for part in self._vehicle.parts:
            part.on_drag("left")(self._record_drag)
        self.enabled = True
        """Whether the layer is switched on; takes effect at the next `draw`."""
        self._show(False)

    def hide(self) -> None:
        """Hide the twin until the next `draw`: it belongs to an earlier path."""
        self._twin = None
        self._show(False)

    def draw(self, picture: Picture, twin: Twin | Refusal, bounds: SceneBounds) -> None:
        """Show the twin of a picture, or none; `move` then puts its vehicle at a time."""
        shown = twin if isinstance(twin, Twin) and self.enabled else None
        self._twin, self._bounds = shown, bounds
        if self._twin is None:
            self._show(False)
            return
        time = np.linspace(0.0, picture.preset.duration, MAX_POINTS)
        dashes, _ = dashes_along(self._twin.path(time), bounds)
        self._path.visible = len(dashes) > 0
        if len(dashes):
            self._path.points = dashes.astype(np.float32)
        self._vehicle.fit(bounds, shape_of(picture.preset.vehicle))
        self._write_label()

    def move(self, picture: Picture, time: float) -> None:
        """Put the twin where it is at the sample nearest to a time (s), in the attitude of the true vehicle."""
        if self._twin is None or self._bounds is None:
            return
        grid = picture.motion.time
        k = nearest_sample(grid, time)
        position = picture.motion.position[k] + self._twin.shift + grid[k] * self._twin.drift
        inside = self._bounds.holds(position)
        self._vehicle.show(inside)
        self._ranges.visible = inside
        if inside:
            self._vehicle.place(position, picture.motion.rotation[k])
            self._ranges.points = _range_lines(picture.preset.world.anchor, picture.motion.position[k], position)

    def instruct(self, on: bool) -> None:
        """Whether the label says what a visitor may do, which a picture in a file does not."""
        self._instructs = on
        self._write_label()

    def _write_label(self) -> None:
        draggable = self._twin is not None and self._twin.draggable and self._instructs
        self._vehicle.label.write("evil twin, drag it" if draggable else "evil twin")

    def take_drag(self) -> Vec3 | None:
        """Where the visitor has dragged the twin since the last call (m, inertial frame); None if nowhere."""
        with self._lock:
            position, self._dragged = self._dragged, None
        return position

    async def _record_drag(self, event: SceneNodeDragEvent[MeshHandle]) -> None:
        """Called in viser's loop, in the order of the messages. A browser may send anything; only positions count."""
        x, y, z = (float(value) for value in event.end_position)
        if np.isfinite([x, y, z]).all() and max(abs(x), abs(y), abs(z)) < MAX_REACH:
            with self._lock:
                self._dragged = (x, y, z)
            self._wake()

    def _show(self, visible: bool) -> None:
        self._path.visible = self._ranges.visible = visible
        self._vehicle.show(visible)


def _range_lines(anchor: Vec3, true: Float[Array, "3"], twin: Float[Array, "3"]) -> Float[Array, "2 2 3"]:
    return np.array([[anchor, true], [anchor, twin]], dtype=np.float32)
