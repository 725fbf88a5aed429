"""The 3-D picture: nodes created once, assigned by draw(picture), moved by move(picture, time). Up is −g."""

from collections.abc import Callable

import numpy as np
from viser import ClientHandle

from explorer.model import palette
from explorer.model.comparison import NOTHING, Comparison
from explorer.model.compute import Picture
from explorer.model.details import Details
from explorer.scene.basin import Globe
from explorer.scene.bounds import EMPTY_LINE, SceneBounds, near_truth, nearest_sample, path_segments, scene_bounds
from explorer.scene.comparison import TRAIL_THICKNESS, TWO_COLORS, ComparisonNodes, draw_dashed
from explorer.scene.estimate import EstimateNodes
from explorer.scene.excitation import ExcitationEllipsoid
from explorer.scene.limits import LimitMarks
from explorer.scene.twin import TwinGhost
from explorer.scene.vehicle import Vehicle
from explorer.scene.view import View
from explorer.scene.world import BlindDirections, WorldNodes
from rangenav.inputs import Vec3

ESTIMATE_DASHES = 14
"""Dashes per radius of the scene."""


class Scene:
    """All 3-D nodes of one visitor."""

    def __init__(self, client: ClientHandle, wake: Callable[[], None]) -> None:
        """`wake` is called from viser's threads when the visitor has dragged the twin or the camera needs attention."""
        scene = client.scene
        self._time = 0.0
        self._bounds: SceneBounds | None = None
        self._view = View(client.camera, wake)
        self._world = WorldNodes(scene)
        self._path = scene.add_line_segments(
            "/path", EMPTY_LINE, palette.rgb(palette.TRUTH), thickness=3.0, thickness_units="screen"
        )
        self._limits = LimitMarks(scene)
        self._trail = scene.add_line_segments(
            "/trail", EMPTY_LINE, TWO_COLORS, thickness=TRAIL_THICKNESS, thickness_units="screen"
        )
        self._vehicle = Vehicle(scene, "vehicle", palette.TRUTH, opacity=None, label_above=True)
        self._estimate = EstimateNodes(scene)
        self._comparison = ComparisonNodes(scene)
        self._globe = Globe(scene)
        self._twin, self._excitation = TwinGhost(scene, wake), ExcitationEllipsoid(scene)
        self._blind = BlindDirections(scene)

    def take_twin_drag(self) -> Vec3 | None:
        """Where the visitor has dragged the evil twin since the last call (m, inertial frame); None if nowhere."""
        return self._twin.take_drag()

    def appear(self, *, hidden: frozenset[str], big: bool) -> None:
        """Switch layers off and on, and take big labels and thick lines, or the usual ones."""

    @property
    def bounds(self) -> SceneBounds | None:
        """The bounds of the picture drawn last; None before the first."""
        return self._bounds

    def draw(self, picture: Picture, comparison: Comparison = NOTHING, *, dragging: bool = False) -> None:
        """Show another picture and the runs compared with it, at the time shown last. The camera stands still while
        a handle is dragged."""
        self._bounds = bounds = scene_bounds(picture)
        self._world.fit(picture.preset.world, bounds)
        self._vehicle.fit(bounds)
        self._estimate.fit(picture, bounds)
        self._path.points = path_segments(picture.motion, bounds).astype(np.float32)
        self._limits.draw(picture.motion, picture.breaks, bounds)
        positions = near_truth(picture.position_estimate, picture.motion, bounds)
        draw_dashed(self._trail, positions, bounds, palette.ESTIMATE, per_radius=ESTIMATE_DASHES)
        self._blind.draw(picture, bounds)
        self._twin.hide()
        self._excitation.hide()
        self._comparison.draw(picture, comparison, bounds)
        self._globe.draw(picture, comparison.basin, bounds)
        self._view.frame(bounds, picture.motion.position, dragging=dragging)
        self.move(picture, self._time)

    def draw_details(self, picture: Picture, details: Details) -> None:
        """Show the evil twin and the excitation, which take longer to compute; called when nothing has changed for a
        moment."""
        assert self._bounds is not None, "draw comes before draw_details"
        self._twin.draw(picture, details.twin, self._bounds)
        self._excitation.show(picture)
        self.move(picture, self._time)

    def move(self, picture: Picture, time: float) -> None:
        """Move every node that moves to the sample nearest to a time (s)."""
        bounds = self._bounds
        assert bounds is not None, "draw comes before move"
        self._time = time
        k = nearest_sample(picture.motion.time, time)
        position = picture.motion.position[k]
        self._vehicle.place(position, picture.motion.rotation[k])
        self._world.move(position)
        self._estimate.move(picture, k, bounds)
        self._comparison.move(time)
        self._twin.move(picture, time)
        self._excitation.move(time, bounds)
        self._view.follow_up()
