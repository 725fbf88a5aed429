"""Drag handles of the anchor and the waypoints: a sphere moves across the screen, a gizmo along an axis.

viser's loop     a handle is moved: store the latest position, wake()         nothing else
session's loop   for move in handles.take_moves(): settings = …               the dragged handle follows the pointer
                 handles.draw(anchor, waypoints, scene.bounds)                all other handles follow the settings

A sphere moves in the plane through it that faces the camera. viser sends about 20 messages a second while it moves, and
always sends the press and the release. The handle touched last carries the gizmo until the visitor presses Escape or
clicks elsewhere. All positions are in the inertial frame.
"""

import math
import threading
import time
from collections.abc import Callable, Coroutine
from typing import Any

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import SceneApi, SceneClickEvent, SceneNodeDragEvent, SceneNodePointerEvent, TransformControlsEvent

from explorer.model import palette
from explorer.scene import handle_position
from explorer.scene.bounds import INVISIBLE_SIZE, SceneBounds
from explorer.scene.handle_position import Drag, HandleKind, HandleMove
from explorer.scene.labels import Labels
from rangenav.inputs import Vec3

MAX_WAYPOINTS = 60
"""Handles drawn at most; the remaining waypoints are edited by their numbers."""
REACH = (-handle_position.MAX_REACH, handle_position.MAX_REACH)
STEPS_PER_RADIUS = 1000
"""Positions are rounded to the power of ten below the scene's radius over this: finer than a pixel, and readable."""
WAYPOINT_SHARE, ANCHOR_SHARE, GIZMO_SHARE = 0.18, 0.34, 1.8
"""Radii of the handles and length of the gizmo's arrows, in units of the scene. The anchor's encloses the beacon."""
LABEL_RANK = 100
"""Of the first waypoint's number: all other labels of the scene are more important."""
SAME_CLICK = 0.3
"""s within which a click on a handle and one on the scene are the same click: viser reports both, in either order."""
LAST_LABEL = f"{MAX_WAYPOINTS} (drag the first {MAX_WAYPOINTS}, the others by numbers)"

Callback = Coroutine[Any, Any, None]


class _Handle:
    """A sphere to be dragged. The sphere of a waypoint has the number of the waypoint as its label."""

    def __init__(self, scene: SceneApi, labels: Labels, kind: HandleKind, index: int) -> None:
        self.kind: HandleKind = kind
        self.index, self.position = index, (0.0, 0.0, 0.0)
        self.drag: Drag | None = None
        anchor = kind == "anchor"
        name = f"/handles/{kind}{'' if anchor else index + 1}"
        self.node = scene.add_icosphere(
            name,
            1.0,
            palette.rgb(palette.ANCHOR if anchor else palette.WAYPOINT),
            subdivisions=1 if anchor else 2,
            wireframe=anchor,  # a cage around the beacon; a translucent shell is lost inside the range sphere
            scale=INVISIBLE_SIZE,
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )
        if not anchor:  # the anchor has a label of its own
            self.label = labels.add(
                f"{name}/label", self._place, rank=LABEL_RANK + index, text=f"{index + 1}", side="bottom-left"
            )

    def _place(self) -> Float[Array, "3"] | None:
        return np.array(self.position) if self.node.visible else None

    def move_to(self, position: Vec3) -> None:
        if position != self.position:
            self.position = self.node.position = position


class DragHandles:
    """All drag handles of one visitor."""

    def __init__(self, scene: SceneApi, labels: Labels, wake: Callable[[], None]) -> None:
        """`labels` are those of the whole scene. `wake` is called from viser's loop when there is a move to take; it
        may set an event and nothing else."""
        self._scene, self._labels, self._wake, self._lock = scene, labels, wake, threading.Lock()
        self._anchor = self._add("anchor", 0)
        self._waypoints: list[_Handle] = []
        self._shown = 0
        self._step = 1e-3
        self._touched: _Handle | None = None
        """The handle that was touched since the last `take_moves`, which then moves the gizmo to it."""
        self._selected: _Handle | None = None
        """The handle that carries the gizmo."""
        self._handle_clicked_at = self._background_clicked_at = -math.inf
        self._gizmo = scene.add_transform_controls(
            "/handles/gizmo",
            disable_rotations=True,
            depth_test=False,
            translation_limits=(REACH, REACH, REACH),
            visible=False,
        )
        self._gizmo.on_update(self._gizmo_moved)

    @property
    def dragging(self) -> bool:
        """Whether a handle is held, or was released since the last `take_moves`."""
        return any(handle.drag is not None for handle in self._drawn())

    def draw(self, anchor: Vec3, waypoints: tuple[Vec3, ...], bounds: SceneBounds) -> None:
        """Show the handles at the anchor and the waypoints of the settings (m). A handle that is being dragged stays at
        the pointer."""
        self._step = 10.0 ** math.floor(math.log10(bounds.radius / STEPS_PER_RADIUS))
        before = [handle.position for handle in self._waypoints[: self._shown]]
        self._show_waypoints(len(waypoints))
        for handle, position in zip(self._drawn(), (anchor, *waypoints), strict=False):
            handle.node.scale = (ANCHOR_SHARE if handle.kind == "anchor" else WAYPOINT_SHARE) * bounds.unit
            if handle.drag is None:
                handle.move_to(position)
            handle.node.visible = True
        self._gizmo.scale = GIZMO_SHARE * bounds.unit
        self._draw_gizmo()
        if before != [handle.position for handle in self._waypoints[: self._shown]]:
            self._labels.arrange()

    def take_moves(self) -> list[HandleMove]:
        """The moves since the last call, at most one for each handle: to its latest position, where the scene shows it
        already."""
        taken = (self._take_move(handle) for handle in self._drawn())
        moves = [move for move in taken if move is not None]
        self._update_selection()
        self._draw_gizmo()
        return moves

    def deselect(self) -> None:
        """Hide the gizmo."""
        with self._lock:
            self._touched = None
        self._select(None)
        self._draw_gizmo()

    def _drawn(self) -> list[_Handle]:
        return [self._anchor, *self._waypoints[: self._shown]]

    def _add(self, kind: HandleKind, index: int) -> _Handle:
        handle = _Handle(self._scene, self._labels, kind, index)
        handle.node.on_drag(self._drag_callback(handle))
        handle.node.on_click(self._click_callback(handle))
        return handle

    def _show_waypoints(self, count: int) -> None:
        """Add the handles that are missing and hide those that are too many; a node is never created twice."""
        shown = min(count, MAX_WAYPOINTS)
        for k in range(len(self._waypoints), shown):
            self._waypoints.append(self._add("waypoint", k))
        for handle in self._waypoints[shown:]:
            handle.node.visible, handle.drag = False, None
        if len(self._waypoints) == MAX_WAYPOINTS:
            self._waypoints[-1].label.write(LAST_LABEL if count > MAX_WAYPOINTS else f"{MAX_WAYPOINTS}")
        self._shown = shown

    def _take_move(self, handle: _Handle) -> HandleMove | None:
        with self._lock:
            drag = handle.drag
            if drag is None or not drag.moved:
                return None
            latest, done, drag.moved = drag.latest, drag.done, False
            if done:
                handle.drag = None
        drag.last_valid = handle_position.dragged_position(drag, latest, self._step) or drag.last_valid
        if drag.last_valid is None:
            return None
        handle.move_to(drag.last_valid)
        return HandleMove(kind=handle.kind, index=handle.index, position=drag.last_valid, done=done)

    def _update_selection(self) -> None:
        """Select the handle touched last, or none after a click elsewhere."""
        with self._lock:
            touched, self._touched = self._touched, None
            elsewhere = abs(self._background_clicked_at - self._handle_clicked_at) > SAME_CLICK
            clicked, self._background_clicked_at = self._background_clicked_at > -math.inf, -math.inf
        if touched is not None or (clicked and elsewhere):
            self._select(touched)

    def _select(self, handle: _Handle | None) -> None:
        """Move the gizmo to another handle, or to none. A drag by the gizmo then ends here: the browser may never send
        its release."""
        with self._lock:
            before, self._selected = self._selected, handle
            if before is not None and before is not handle and before.drag is not None and before.drag.start is None:
                before.drag.moved = before.drag.done = True

    def _draw_gizmo(self) -> None:
        if self._selected is not None and self._selected not in self._drawn():
            self._select(None)
        selected = self._selected
        if (selected is not None) != self._gizmo.visible:
            self._gizmo.visible = selected is not None
            # only while there is a gizmo to hide: the callback turns the cursor into a hand over the whole scene
            if selected is None:
                self._scene.remove_click_callback(self._background_clicked)
            else:
                self._scene.on_click()(self._background_clicked)
        if selected is not None and (selected.drag is None or selected.drag.start is not None):
            self._gizmo.position = (
                selected.position
            )  # not while the gizmo itself is dragged: the browser has already moved it

    def _drag_callback(self, handle: _Handle) -> Callable[[SceneNodeDragEvent[Any]], Callback]:
        async def dragged(event: SceneNodeDragEvent[Any]) -> None:  # async: viser calls only those in their order
            self._record(handle, event.phase, event.start_position, event.end_position)

        return dragged

    def _click_callback(self, handle: _Handle) -> Callable[[SceneNodePointerEvent[Any]], Callback]:
        async def clicked(_: SceneNodePointerEvent[Any]) -> None:
            with self._lock:
                self._touched, self._handle_clicked_at = handle, time.monotonic()
            self._wake()

        return clicked

    def _background_clicked(self, _: SceneClickEvent) -> None:
        with self._lock:
            self._background_clicked_at = time.monotonic()
        self._wake()

    async def _gizmo_moved(self, event: TransformControlsEvent) -> None:
        if self._selected is not None:
            self._record(self._selected, event.phase, None, event.target.position.tolist())

    def _record(self, handle: _Handle, phase: str, start: Any, latest: Any) -> None:
        """Store the latest position of a drag, in place of one that the session has not taken."""
        with self._lock:
            if phase == "start":
                handle.drag, self._touched = Drag(handle.position, start), handle
            elif handle.drag is None or handle.drag.done:
                return
            else:
                handle.drag.latest, handle.drag.moved = latest, True
                handle.drag.done = phase == "end"
        self._wake()
