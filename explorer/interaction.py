"""What was done with the mouse in the scene and on the plots, taken over into the controls: drags, turns, brushes."""

from explorer.charts import Charts
from explorer.model.compute import Picture
from explorer.model.playback import Playback
from explorer.panels.dock import Dock
from explorer.scene import Scene
from explorer.scene.drag_handles import DragHandles
from rangenav import twin

SHORTEST_BRUSH = 0.01
"""Of a time axis: what is shorter was meant as a click."""
BRUSH_STEP, BRUSH_DIGITS = 0.1, 1
"""s, of a window that was drawn by hand: as its slider has them."""


class Interaction:
    """The controls of one visitor follow the mouse."""

    def __init__(self, dock: Dock, charts: Charts, scene: Scene, handles: DragHandles, playback: Playback) -> None:
        self._dock, self._charts, self._scene, self._handles, self._playback = dock, charts, scene, handles, playback
        self._drags = 0

    def apply(self, picture: Picture | None) -> int | None:
        """Take over all that was done since the last call, on the picture shown: the number of the drag of a handle,
        None if none is held."""
        held = self._handles_moved()
        self._twin_turned(picture)
        self._window_drawn()
        return held

    def _handles_moved(self) -> int | None:
        """Where anchor and waypoints were dragged to."""
        drag, moves = self._drags, self._handles.take_moves()
        self._drags += any(move.done for move in moves)
        for move in moves:
            if move.kind == "anchor":
                self._dock.move_anchor(move.position)
            else:
                self._dock.move_waypoint(move.index, move.position)
        return drag if moves else None

    def _twin_turned(self, picture: Picture | None) -> None:
        """Where the evil twin was dragged to."""
        point = self._scene.take_twin_drag()
        if point is not None and picture is not None:
            self._dock.twin.write(twin.turn_towards(picture.preset, point, time=self._playback.time))

    def _window_drawn(self) -> None:
        """The window that was drawn across a plot; a click there goes to that moment."""
        brush = self._charts.take_brush()
        if brush is None:
            return
        start, end = brush
        self._playback.seek(start)
        if end - start >= SHORTEST_BRUSH * self._playback.duration:
            self._dock.motion.set_window(drawn_window(end - start, self._playback.duration))


def drawn_window(length: float, duration: float) -> float:
    """The window (s) that is meant by a brush: a step long at least, and shorter than the flight, as windows are."""
    return max(round(min(length, duration - BRUSH_STEP), BRUSH_DIGITS), BRUSH_STEP)
