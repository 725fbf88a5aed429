"""The evil twin in the 3-D picture: its path, its vehicle, and both ranges from the anchor, which are equally long."""

import threading
from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import MeshHandle, SceneApi, SceneNodeDragEvent

from explorer.model.compute import Picture
from explorer.scene.bounds import MAX_POINTS, SceneBounds, dashed
from explorer.scene.colors import OLIVE
from explorer.scene.vehicle import Vehicle
from rangenav.inputs import Vec3
from rangenav.twin import Refusal, Twin

FARTHEST = 1e6
"""m; what a drag tells beyond that is no place anybody points at."""


class TwinGhost:
    """Nodes /twin, /twin_path and /twin_ranges; hidden while there is none. `note` is called when it was dragged."""

    def __init__(self, scene: SceneApi, wake: Callable[[], None]) -> None:
        nothing = np.zeros((1, 2, 3))
        self._wake, self._lock = wake, threading.Lock()
        self._found: Twin | None = None
        self._dragged: Vec3 | None = None
        self._on: SceneBounds | None = None
        self._path = scene.add_line_segments("/twin_path", nothing, OLIVE, thickness=3.0, thickness_units="screen")
        self._ranges = scene.add_line_segments("/twin_ranges", nothing, OLIVE, thickness=1.5, thickness_units="screen")
        # opaque: a translucent one is lost inside the range sphere
        self._vehicle = Vehicle(scene, "twin", OLIVE, opacity=None, label_above=True)
        for part in self._vehicle.parts:
            part.on_drag("left")(self._drag)
        self._show(False)

    def wait(self) -> None:
        """Hide it until the path rests."""
        self._found = None
        self._show(False)

    def draw(self, picture: Picture, found: Twin | Refusal, on: SceneBounds) -> None:
        """Show the twin of a picture, or none; `move` then puts it at a time."""
        self._found, self._on = (found if isinstance(found, Twin) else None), on
        if self._found is None:
            self._show(False)
            return
        time = np.linspace(0.0, picture.preset.duration, MAX_POINTS)
        dashes, _ = dashed(self._found.path(time), on)
        self._path.visible = len(dashes) > 0
        if len(dashes):
            self._path.points = dashes.astype(np.float32)
        self._vehicle.fit(on)
        self._vehicle.label.text = "evil twin, drag it" if self._found.draggable else "evil twin"

    def move(self, picture: Picture, time: float) -> None:
        """Put the twin where it is at the sample nearest to a time, in the attitude of the true vehicle."""
        if self._found is None or self._on is None:
            return
        grid = picture.motion.time
        k = int(np.clip(np.searchsorted(grid, time - (grid[1] - grid[0]) / 2), 0, len(grid) - 1))
        position = picture.motion.position[k] + self._found.shift + grid[k] * self._found.drift
        here = bool(self._on.holds(position))
        self._vehicle.show(here)
        self._ranges.visible = here
        if here:
            self._vehicle.place(position, picture.motion.rotation[k])
            self._ranges.points = _from(picture.preset.world.anchor, picture.motion.position[k], position)

    def dragged(self) -> Vec3 | None:
        """Where it was dragged to since this was asked last (m); what `twin.turn_towards` takes."""
        with self._lock:
            point, self._dragged = self._dragged, None
        return point

    async def _drag(self, event: SceneNodeDragEvent[MeshHandle]) -> None:
        """In viser's loop, so in order: remember and say so; a page may send anything, so only a place is taken."""
        x, y, z = (float(value) for value in event.end_position)
        if np.isfinite([x, y, z]).all() and max(abs(x), abs(y), abs(z)) < FARTHEST:
            with self._lock:
                self._dragged = (x, y, z)
            self._wake()

    def _show(self, visible: bool) -> None:
        self._path.visible = self._ranges.visible = visible
        self._vehicle.show(visible)


def _from(anchor: Vec3, true: Float[Array, "3"], twin: Float[Array, "3"]) -> Float[Array, "2 2 3"]:
    return np.array([[anchor, true], [anchor, twin]], dtype=np.float32)
