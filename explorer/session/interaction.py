"""The visitor's mouse moves controls: by drags of handles and of the twin, and by windows drawn across a plot."""

from explorer.charts import Charts
from explorer.model.compute import Picture
from explorer.model.playback import Playback
from explorer.panels.dock import Dock
from explorer.scene import Scene
from explorer.scene.drag_handles import DragHandles
from rangenav import twin

MIN_BRUSH = 0.01
"""Share of the time axis; a shorter drag across a plot is a click."""
BRUSH_STEP, BRUSH_DIGITS = 0.1, 1
"""s and digits of the window's slider; a window that is drawn across a plot is rounded to them."""


class Interaction:
    """Applies the mouse of one visitor to the controls."""

    def __init__(self, dock: Dock, charts: Charts, scene: Scene, handles: DragHandles, playback: Playback) -> None:
        self._dock, self._charts, self._scene, self._handles, self._playback = dock, charts, scene, handles, playback
        self._drags = 0

    def apply(self, picture: Picture | None) -> int | None:
        """Apply everything done since the last call to the controls; `picture` is the one shown.

        Returns the number of the drag while a handle is held, else None.
        """
        drag = self._apply_handles()
        self._apply_twin(picture)
        self._apply_brush()
        return drag

    def _apply_handles(self) -> int | None:
        """Move the anchor and the waypoints to where they were dragged."""
        drag, moves = self._drags, self._handles.take_moves()
        self._drags += any(move.done for move in moves)
        for move in moves:
            if move.kind == "anchor":
                self._dock.move_anchor(move.position)
            else:
                self._dock.move_waypoint(move.index, move.position)
        return drag if moves else None

    def _apply_twin(self, picture: Picture | None) -> None:
        """Turn the evil twin towards where it was dragged."""
        point = self._scene.take_twin_drag()
        if point is not None and picture is not None:
            self._dock.twin.write(twin.turn_towards(picture.preset, point, time=self._playback.time))

    def _apply_brush(self) -> None:
        """Set δ to the length of the window drawn across a plot, and seek its start; a click only seeks a time."""
        brush = self._charts.take_brush()
        if brush is None:
            return
        start, end = brush
        self._playback.seek(start)
        if end - start >= MIN_BRUSH * self._playback.duration:
            self._dock.motion.set_window(drawn_window(end - start, self._playback.duration))


def drawn_window(length: float, duration: float) -> float:
    """The window (s) for a drag of some length (s): at least one step of the slider, and shorter than the flight."""
    return max(round(min(length, duration - BRUSH_STEP), BRUSH_DIGITS), BRUSH_STEP)
