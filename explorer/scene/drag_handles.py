"""Taking hold of anchor and waypoints in the 3-D picture: by a sphere across the screen, by a gizmo along an axis.

viser's loop     a handle is moved: remember where to, note()       nothing else, and only the latest place
session's loop   for grab in handles.take(): settings = …           what is held follows the pointer at once
                 handles.draw(anchor, waypoints, scene.stage)       and all others go where the settings have them

A sphere moves in the plane through it that faces the camera (viser: about 20 messages a second, start and end always
told). The one touched last has a gizmo for exact axes, until Escape or a click elsewhere. Places are in the inertial
frame whichever way is up.
"""

import math
import threading
import time
from collections.abc import Callable, Coroutine
from typing import Any

from viser import SceneApi, SceneClickEvent, SceneNodeDragEvent, SceneNodePointerEvent, TransformControlsEvent

from explorer.scene import handle_position
from explorer.scene.bounds import UNSEEN, SceneBounds
from explorer.scene.colors import BLUE, ORANGE
from explorer.scene.handle_position import Grab, Grip, HandleKind
from rangenav.inputs import Vec3

MAX_WAYPOINTS = 60
"""Drawn; of more, the others are moved by their numbers."""
EVERYWHERE = (-handle_position.MAX_REACH, handle_position.MAX_REACH)
STEPS = 1000
"""A place is rounded to the power of ten below a thousandth of the stage's radius: finer than a pixel, and readable."""
WAYPOINT_SHARE, ANCHOR_SHARE, GIZMO_SHARE = 0.18, 0.34, 1.8
"""Radii of the handles and length of the gizmo's arrows, in units of the stage. The anchor's encloses the beacon."""
ONE_CLICK = 0.3
"""s within which a click on a handle and one on the scene are the same click: viser tells both, in any order."""
OTHERS = f"{MAX_WAYPOINTS} (drag the first {MAX_WAYPOINTS}, the others by numbers)"

Told = Coroutine[Any, Any, None]


class _Handle:
    """A sphere to be dragged, with a word beside it."""

    def __init__(self, scene: SceneApi, kind: HandleKind, index: int) -> None:
        self.kind: HandleKind = kind
        self.index, self.place = index, (0.0, 0.0, 0.0)
        self.grip: Grip | None = None
        anchor = kind == "anchor"
        name = f"/handles/{kind}{'' if anchor else index + 1}"
        self.node = scene.add_icosphere(
            name,
            1.0,
            ORANGE if anchor else BLUE,
            subdivisions=1 if anchor else 2,
            wireframe=anchor,  # a cage around the beacon; a translucent shell is lost inside the range sphere
            scale=UNSEEN,
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )
        if not anchor:  # which has its word already
            self.label = scene.add_label(f"{name}/label", f"{index + 1}", anchor="bottom-left", font_screen_scale=0.9)

    def move(self, place: Vec3) -> None:
        if place != self.place:
            self.place = self.node.position = place


class DragHandles:
    """All handles of one visitor."""

    def __init__(self, scene: SceneApi, wake: Callable[[], None]) -> None:
        """`note` is called from viser's loop when there is something to take; it may set an event and nothing else."""
        self._scene, self._wake, self._lock = scene, wake, threading.Lock()
        self._anchor = self._add("anchor", 0)
        self._waypoints: list[_Handle] = []
        self._shown = 0
        self._step = 1e-3
        self._touched: _Handle | None = None
        """To be given the gizmo."""
        self._chosen: _Handle | None = None
        """Has the gizmo."""
        self._clicked = self._clicked_beside = -math.inf
        self._gizmo = scene.add_transform_controls(
            "/handles/gizmo",
            disable_rotations=True,
            depth_test=False,
            translation_limits=(EVERYWHERE, EVERYWHERE, EVERYWHERE),
            visible=False,
        )
        self._gizmo.on_update(self._pulled)

    @property
    def dragging(self) -> bool:
        """Whether something is held, or was let go since the last take."""
        return any(handle.grip is not None for handle in self._drawn())

    def draw(self, anchor: Vec3, waypoints: tuple[Vec3, ...], on: SceneBounds) -> None:
        """Show the handles where the settings have anchor and waypoints; what is held stays where it is held."""
        self._step = 10.0 ** math.floor(math.log10(on.radius / STEPS))
        self._show_waypoints(len(waypoints))
        for handle, place in zip(self._drawn(), (anchor, *waypoints), strict=False):
            handle.node.scale = (ANCHOR_SHARE if handle.kind == "anchor" else WAYPOINT_SHARE) * on.unit
            if handle.grip is None:
                handle.move(place)
            handle.node.visible = True
        self._gizmo.scale = GIZMO_SHARE * on.unit
        self._draw_gizmo()

    def take(self) -> list[Grab]:
        """What was moved since the last call, each handle once at its latest place; it is there in the picture, too."""
        found = (self._taken(handle) for handle in self._drawn())
        grabs = [grab for grab in found if grab is not None]
        self._choose()
        self._draw_gizmo()
        return grabs

    def let_go(self) -> None:
        """Put the gizmo away."""
        with self._lock:
            self._touched = None
        self._give_gizmo(None)
        self._draw_gizmo()

    def _drawn(self) -> list[_Handle]:
        return [self._anchor, *self._waypoints[: self._shown]]

    def _add(self, kind: HandleKind, index: int) -> _Handle:
        handle = _Handle(self._scene, kind, index)
        handle.node.on_drag(self._hearing(handle))
        handle.node.on_click(self._clicking(handle))
        return handle

    def _show_waypoints(self, count: int) -> None:
        """Make handles that are missing and hide those that are too many; nodes are never made twice."""
        shown = min(count, MAX_WAYPOINTS)
        for k in range(len(self._waypoints), shown):
            self._waypoints.append(self._add("waypoint", k))
        for handle in self._waypoints[shown:]:
            handle.node.visible, handle.grip = False, None
        if len(self._waypoints) == MAX_WAYPOINTS:
            self._waypoints[-1].label.text = OTHERS if count > MAX_WAYPOINTS else f"{MAX_WAYPOINTS}"
        self._shown = shown

    def _taken(self, handle: _Handle) -> Grab | None:
        with self._lock:
            grip = handle.grip
            if grip is None or not grip.news:
                return None
            latest, done, grip.news = grip.latest, grip.done, False
            if done:
                handle.grip = None
        grip.good = handle_position.place(grip, latest, self._step) or grip.good
        if grip.good is None:
            return None
        handle.move(grip.good)
        return Grab(kind=handle.kind, index=handle.index, position=grip.good, done=done)

    def _choose(self) -> None:
        """Give the gizmo to the handle touched last, or put it away after a click elsewhere."""
        with self._lock:
            touched, self._touched = self._touched, None
            elsewhere = abs(self._clicked_beside - self._clicked) > ONE_CLICK
            clicked, self._clicked_beside = self._clicked_beside > -math.inf, -math.inf
        if touched is not None or (clicked and elsewhere):
            self._give_gizmo(touched)

    def _give_gizmo(self, handle: _Handle | None) -> None:
        """Another handle has it, or none; one that it was pulling is let go, for its end may never be told."""
        with self._lock:
            before, self._chosen = self._chosen, handle
            if before is not None and before is not handle and before.grip is not None and before.grip.start is None:
                before.grip.news = before.grip.done = True

    def _draw_gizmo(self) -> None:
        if self._chosen is not None and self._chosen not in self._drawn():
            self._give_gizmo(None)
        chosen = self._chosen
        if (chosen is not None) != self._gizmo.visible:
            self._gizmo.visible = chosen is not None
            # only while there is a gizmo to put away: the browser shows a pointing hand everywhere
            if chosen is None:
                self._scene.remove_click_callback(self._beside)
            else:
                self._scene.on_click()(self._beside)
        if chosen is not None and (chosen.grip is None or chosen.grip.start is not None):
            self._gizmo.position = chosen.place  # never while it is pulled itself: the browser has moved it already

    def _hearing(self, handle: _Handle) -> Callable[[SceneNodeDragEvent[Any]], Told]:
        async def heard(event: SceneNodeDragEvent[Any]) -> None:  # async: those alone are called in their order
            self._hear(handle, event.phase, event.start_position, event.end_position)

        return heard

    def _clicking(self, handle: _Handle) -> Callable[[SceneNodePointerEvent[Any]], Told]:
        async def clicked(_: SceneNodePointerEvent[Any]) -> None:
            with self._lock:
                self._touched, self._clicked = handle, time.monotonic()
            self._wake()

        return clicked

    def _beside(self, _: SceneClickEvent) -> None:
        with self._lock:
            self._clicked_beside = time.monotonic()
        self._wake()

    async def _pulled(self, event: TransformControlsEvent) -> None:
        if self._chosen is not None:
            self._hear(self._chosen, event.phase, None, event.target.position.tolist())

    def _hear(self, handle: _Handle, phase: str, start: Any, latest: Any) -> None:
        """Remember where a handle is held; whatever came before and was not taken is forgotten."""
        with self._lock:
            if phase == "start":
                handle.grip, self._touched = Grip(handle.place, start), handle
            elif handle.grip is None or handle.grip.done:
                return
            else:
                handle.grip.latest, handle.grip.news = latest, True
                handle.grip.done = phase == "end"
        self._wake()
