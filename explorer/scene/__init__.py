"""The 3-D picture: nodes created once, assigned by draw(picture), moved by move(picture, time). Up is −g."""

import time as clock
from collections.abc import Callable

import numpy as np
from viser import ClientHandle

from explorer.model import palette
from explorer.model.classroom import Camera
from explorer.model.comparison import NOTHING, Comparison
from explorer.model.compute import Picture
from explorer.model.details import Details
from explorer.model.drawn import Drawn
from explorer.scene.airframe import shape_of
from explorer.scene.basin import Globe
from explorer.scene.bounds import EMPTY_LINE, SceneBounds, nearest_sample, path_segments, scene_bounds
from explorer.scene.comparison import ComparisonNodes
from explorer.scene.estimate import EstimateNodes
from explorer.scene.excitation import ExcitationEllipsoid
from explorer.scene.labels import Labels
from explorer.scene.limits import LimitMarks
from explorer.scene.proposal import ProposedNodes
from explorer.scene.tail import Tail
from explorer.scene.twin import TwinGhost
from explorer.scene.vehicle import Vehicle
from explorer.scene.view import Direction, Step, View
from explorer.scene.world import BlindDirections, WorldNodes
from rangenav.inputs import Vec3

PATH_THICKNESS, BIG_PATH_THICKNESS = 3.0, 7.0
"""px"""
LABEL_PERIOD = 0.3
"""s between two arrangements of the labels while time or a handle moves."""


class Scene:
    """All 3-D nodes of one visitor. Before the first picture nothing but the ground is shown."""

    def __init__(self, client: ClientHandle, wake: Callable[[], None]) -> None:
        """`wake` is called from viser's threads when the visitor has dragged the twin or the camera needs attention."""
        scene = client.scene
        self._time = 0.0
        self._bounds: SceneBounds | None = None
        self._bounded, self._moved = Drawn(), Drawn()
        self._drawn: tuple[Picture, Comparison] | None = None
        self._details: Details | None = None
        self._arranged_at = 0.0
        self.labels = labels = Labels(scene, client.camera)
        """All labels, also those of the drag handles."""
        self._view = View(client.camera, wake)
        self._world = WorldNodes(scene, labels)
        self._path = scene.add_line_segments(
            "/path", EMPTY_LINE, palette.rgb(palette.TRUTH), thickness=PATH_THICKNESS, thickness_units="screen"
        )
        self._limits, self._tail = LimitMarks(scene, labels), Tail(scene)
        self._vehicle = Vehicle(scene, labels, "vehicle", palette.TRUTH, opacity=None, rank=1)
        self._estimate = EstimateNodes(scene, labels)
        self._comparison = ComparisonNodes(scene, labels)
        self._proposed = ProposedNodes(scene, labels)
        self._globe = Globe(scene, labels)
        self._twin, self._excitation = TwinGhost(scene, labels, wake), ExcitationEllipsoid(scene, labels)
        self._blind = BlindDirections(scene, labels)

    def take_twin_drag(self) -> Vec3 | None:
        """Where the visitor has dragged the evil twin since the last call (m, inertial frame); None if nowhere."""
        return self._twin.take_drag()

    def look(self, direction: Direction) -> None:
        """Look at path and anchor from a direction: as at first, from above, against an axis."""
        self._view.look(direction)

    def step_camera(self, step: Step) -> None:
        """Move the camera a step around what it looks at, or towards it."""
        self._view.step(step)

    def instruct(self, on: bool) -> None:
        """Whether labels say what a visitor may do; in a picture for a file they only name what is shown."""
        self._twin.instruct(on)
        self._arrange()

    def appear(self, *, hidden: frozenset[str], big: bool, dark: bool, height: float) -> None:
        """Switch layers off and on (names of `explorer.model.layers`), with big labels and thick lines, or the usual
        ones, on a dark page or a light one. height: of the picture, CSS px."""
        vectors = "vectors" not in hidden
        self._world.appear(vectors=vectors, sphere="sphere" not in hidden, dark=dark)
        self._estimate.appear(vectors=vectors, ellipsoid="uncertainty" not in hidden)
        self._tail.appear(enabled="tail" not in hidden, big=big)
        self._path.visible = "path" not in hidden
        self._path.thickness = BIG_PATH_THICKNESS if big else PATH_THICKNESS
        self._excitation.enabled = "excitation" not in hidden
        self._blind.enabled, self._twin.enabled = "blind" not in hidden, "twin" not in hidden
        self.labels.appear(shown="labels" not in hidden, big=big, height=height)
        if self._drawn is not None and self._bounds is not None:
            picture, _ = self._drawn
            self._world.fit(picture.preset.world, self._bounds)
            self._blind.draw(picture, self._bounds)
            if self._details is not None:
                self._twin.draw(picture, self._details.twin, self._bounds)
            self._show_all(picture)

    def look_from(self, camera: Camera) -> None:
        """Look at the scene as another visitor does; `draw` comes before."""
        if self._bounds is not None:
            self._view.look_from(np.array(camera.position), np.array(camera.look_at), self._bounds)

    @property
    def bounds(self) -> SceneBounds | None:
        """The bounds of the picture drawn last; None before the first."""
        return self._bounds

    def shows_path_of(self, picture: Picture) -> bool:
        """Whether the path and the world of a picture are those drawn last, so that few nodes change."""
        before = None if self._drawn is None else self._drawn[0]
        return before is not None and before.motion is picture.motion and before.preset.world == picture.preset.world

    def draw(self, picture: Picture, comparison: Comparison = NOTHING, *, dragging: bool = False) -> None:
        """Show another picture and the runs compared with it, at the time shown last. The camera stands still while
        a handle is dragged."""
        bounds, moved = self._bounds, self._bounded.changed(picture.motion, picture.preset.world)
        if bounds is None or moved:
            self._bounds = bounds = scene_bounds(picture)
            self._path.points = path_segments(picture.motion, bounds).astype(np.float32)
        self._drawn, self._details = (picture, comparison), None
        self._world.fit(picture.preset.world, bounds)
        self._vehicle.fit(bounds, shape_of(picture.preset.vehicle))
        self._vehicle.show(True)
        self._estimate.fit(picture, bounds)
        self._limits.draw(picture.motion, picture.breaks, bounds)
        self._tail.draw(picture, bounds)
        self._blind.draw(picture, bounds)
        self._twin.hide()
        self._excitation.hide()
        self._comparison.draw(picture, comparison, bounds)
        self._proposed.draw(picture, comparison.proposed, bounds)
        self._globe.draw(picture, comparison.basin, bounds)
        self._view.frame(bounds, picture.motion.position, dragging=dragging)
        if dragging:  # twenty pictures a second: the labels follow as they do while time moves
            self._moved.forget()
            self.move(picture, self._time)
        else:
            self._show_all(picture)

    def draw_details(self, picture: Picture, details: Details) -> None:
        """Show the evil twin and the excitation, which take longer to compute; called when nothing has changed for a
        moment."""
        assert self._bounds is not None, "draw comes before draw_details"
        self._details = details
        self._twin.draw(picture, details.twin, self._bounds)
        self._excitation.show(picture)
        self._show_all(picture)

    def move(self, picture: Picture, time: float) -> None:
        """Move every node that moves to the sample nearest to a time (s)."""
        bounds = self._bounds
        assert bounds is not None, "draw comes before move"
        self._time = time
        if self._moved.changed(picture, time, bounds):
            self._move_to(picture, time, bounds)
        if self._view.follow_up() or clock.monotonic() > self._arranged_at + LABEL_PERIOD:
            self._arrange()

    def _move_to(self, picture: Picture, time: float, bounds: SceneBounds) -> None:
        k = nearest_sample(picture.motion.time, time)
        position = picture.motion.position[k]
        self._vehicle.place(position, picture.motion.rotation[k])
        self._world.move(position)
        self._estimate.move(picture, k, bounds)
        self._tail.move(picture, k)
        self._comparison.move(time)
        self._twin.move(picture, time)
        self._excitation.move(time, bounds)

    def _show_all(self, picture: Picture) -> None:
        """Move every node, and arrange the labels once."""
        self._moved.forget()
        self._arranged_at = clock.monotonic()
        self.move(picture, self._time)
        self._arrange()

    def _arrange(self) -> None:
        self._arranged_at = clock.monotonic()
        self.labels.arrange()
