"""The 3-D picture: nodes made once, assigned by draw(picture), moved by move(picture, time). Up is −g."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import ClientHandle
from viser.transforms import SO3

from explorer.model.comparison import NOTHING, Comparison
from explorer.model.compute import Picture
from explorer.model.details import Details
from explorer.scene import bounds as stages
from explorer.scene.arrows import Arrow
from explorer.scene.basin import Globe
from explorer.scene.bounds import NO_LINE, UNSEEN, SceneBounds
from explorer.scene.colors import (
    BLUE,
    GREEN,
    LIGHT_GREEN,
    LIGHT_PURPLE,
    ORANGE,
    PALE,
    PURPLE,
    SKY,
    VERMILLION,
    linear,
)
from explorer.scene.comparison import ComparisonNodes
from explorer.scene.excitation import ExcitationEllipsoid
from explorer.scene.limits import LimitMarks
from explorer.scene.twin import TwinGhost
from explorer.scene.vehicle import Vehicle
from explorer.scene.view import View
from rangenav.inputs import Vec3
from rangenav.observability import blindness
from rangenav.observability.blindness import Direction

USUAL_UP = (0.0, 0.0, -1.0)
"""The paper's z axis points down."""
MAX_BLIND = 6
BLACK_ENDS = np.zeros((1, 2, 3), dtype=np.uint8)
"""A colour for each end from the start: the browser cannot turn a line of one colour into one of many."""


class Scene:
    """All 3-D nodes of one visitor."""

    def __init__(self, client: ClientHandle, wake: Callable[[], None]) -> None:
        """`note` is called from viser's threads when the twin was dragged."""
        self._client = client
        scene = client.scene
        self._time = 0.0
        self._stage: SceneBounds | None = None
        self._view = View(client.camera)
        self._magnetic = np.zeros((0, 3))
        scene.set_up_direction(USUAL_UP)
        self._up = np.array(USUAL_UP)
        self._grid = scene.add_grid("/grid", plane="xy", fade_strength=1.5)
        self._path = scene.add_line_segments("/path", NO_LINE, BLUE, thickness=3.0, thickness_units="screen")
        self._broken = LimitMarks(scene)
        self._trail = scene.add_line_segments("/trail", NO_LINE, BLACK_ENDS, thickness=2.0, thickness_units="screen")
        self._anchor = scene.add_frame("/anchor", show_axes=False)
        self._beacon = scene.add_icosphere(
            "/anchor/beacon", 1.0, ORANGE, subdivisions=1, flat_shading=True, scale=UNSEEN
        )
        self._mast = scene.add_line_segments("/anchor/mast", NO_LINE, ORANGE, thickness=3.0, thickness_units="screen")
        self._anchor_word = scene.add_label("/anchor/label", "anchor", anchor="bottom-center", font_screen_scale=0.9)
        self._sphere = scene.add_icosphere(
            "/anchor/range",
            1.0,
            SKY,
            subdivisions=14,
            opacity=0.1,
            scale=UNSEEN,
            material="toon3",  # without a graphics card: 33 frames a second; standard material on both sides gives 2
            cast_shadow=False,
            receive_shadow=False,
        )
        self._truth = Vehicle(scene, "vehicle", BLUE, opacity=None, label_above=True)
        self._ghost = Vehicle(scene, "estimate", VERMILLION, opacity=0.4, label_above=False)
        self._companions = ComparisonNodes(scene)
        self._globe = Globe(scene)
        self._ellipsoid = scene.add_icosphere(
            "/ellipsoid",
            1.0,
            VERMILLION,
            subdivisions=10,
            opacity=0.13,
            material="toon3",
            cast_shadow=False,
            receive_shadow=False,
        )
        self._compass = scene.add_frame("/compass", show_axes=False)
        self._gravity = Arrow(scene, "/compass/gravity", "g", GREEN)
        self._gravity_estimate = Arrow(scene, "/compass/gravity_estimate", "g est.", LIGHT_GREEN)
        self._north = Arrow(scene, "/compass/magnetic", "m", PURPLE)
        self._north_estimate = Arrow(scene, "/compass/magnetic_estimate", "m est.", LIGHT_PURPLE)
        self._far = Arrow(scene, "/compass/far", "", VERMILLION)
        self._twin, self._excitation = TwinGhost(scene, wake), ExcitationEllipsoid(scene)
        self._blind = [Arrow(scene, f"/blind{i}", "", ORANGE, both_ways=True) for i in range(MAX_BLIND)]

    def twin_dragged(self) -> Vec3 | None:
        """Where the evil twin was dragged to since this was asked last (m)."""
        return self._twin.dragged()

    @property
    def stage(self) -> SceneBounds | None:
        """How large the picture drawn last is; None before the first."""
        return self._stage

    def draw(self, picture: Picture, beside: Comparison = NOTHING, *, dragging: bool = False) -> None:
        """Show another picture and what stands beside it, at the time shown last. While something is dragged the camera
        stands still."""
        on = stages.stage(picture)
        self._fit(picture, on)
        self._path.points = stages.solid(picture.motion, on).astype(np.float32)
        self._broken.draw(picture.motion, picture.breaks, on)
        self._draw_trail(stages.not_astray(picture, on), on)
        self._magnetic = stages.last_seen(picture.measurements.mag)
        self._draw_blind(picture, on)
        self._twin.wait()
        self._excitation.wait()
        self._companions.draw(picture, beside, on)
        self._globe.draw(picture, beside.basin, on)
        self._view.frame(on, picture.motion.position, dragging=dragging)
        self.move(picture, self._time)

    def draw_later(self, picture: Picture, deep: Details) -> None:
        """Show the evil twin and the excitation, which take a while to find; for when nothing moves."""
        assert self._stage is not None, "draw comes before draw_later"
        self._twin.draw(picture, deep.twin, self._stage)
        self._excitation.begin(picture)
        self.move(picture, self._time)

    def move(self, picture: Picture, time: float) -> None:
        """Move everything that moves to the sample nearest to a time."""
        assert self._stage is not None, "draw comes before move"
        self._time = time
        k = stages.sample(picture.motion.time, time)
        position, rotation = picture.motion.position[k], picture.motion.rotation[k]
        self._truth.place(position, rotation)
        self._compass.position = position
        self._sphere.scale = max(float(np.linalg.norm(position - picture.preset.world.anchor)), 1e-6)
        self._move_estimate(picture, k)
        self._companions.move(time)
        self._twin.move(picture, time)
        self._excitation.move(time, self._stage)

    def _move_estimate(self, picture: Picture, k: int) -> None:
        on = self._stage
        assert on is not None
        position, rotation = picture.position_estimate[k], picture.estimate.rotation[k]
        turned = bool(np.isfinite(rotation).all())
        self._gravity_estimate.point(rotation @ picture.estimate.state[k, 10:13] if turned else np.zeros(3))
        self._north_estimate.point(rotation @ self._magnetic[k] if turned else np.zeros(3))
        here = turned and bool(on.holds(position))
        self._ghost.show(here)
        if here:
            self._ghost.place(position, rotation)
            self._far.hide()
        else:
            self._point_far(position - picture.motion.position[k])
        self._move_ellipsoid(picture, k, here=here)

    def _point_far(self, offset: Float[Array, "3"]) -> None:
        """The ghost is off the stage: an arrow at the vehicle says where to, a label how far."""
        with np.errstate(over="ignore", invalid="ignore"):
            distance = float(np.linalg.norm(offset))
        known = np.isfinite(distance)
        self._far.say(f"estimate {distance:.3g} m this way" if known else "the estimate is not a number any more")
        self._far.point(offset if known else np.ones(3))

    def _move_ellipsoid(self, picture: Picture, k: int, *, here: bool) -> None:
        on, rotation = self._stage, picture.estimate.rotation[k]
        assert on is not None
        found = stages.ellipsoid(picture.estimate.covariance[k, 0]) if here else None
        drawn = found is not None and found[0][2] < stages.REACH * on.radius
        self._ellipsoid.visible = drawn
        if here:
            self._ghost.label.text = "estimate, 1σ by P" if drawn else "estimate, σ by P too large to draw"
        if found is not None and drawn:
            x, y, z = (float(axis) for axis in found[0])
            self._ellipsoid.scale = (x, y, z)
            self._ellipsoid.wxyz = SO3.from_matrix(rotation @ found[1]).wxyz
            self._ellipsoid.position = picture.position_estimate[k]

    def _fit(self, picture: Picture, on: SceneBounds) -> None:
        """Everything that depends on the world or on the size of the stage; unchanged values are not sent again."""
        world, unit = picture.preset.world, on.unit
        if not np.allclose(self._up, on.up):
            self._up = on.up
            self._client.scene.set_up_direction(on.up)
        self._stage = on
        self._grid.width = self._grid.height = round(16 * on.radius / on.cell) * on.cell
        self._grid.cell_size, self._grid.section_size = on.cell, 5 * on.cell
        self._grid.fade_distance = 14 * on.radius
        self._grid.position = on.ground
        self._grid.wxyz = (SO3(np.array(stages.turn_from_x(on.up))) @ SO3.from_y_radians(np.pi / 2)).wxyz
        self._anchor.position = np.asarray(world.anchor)
        self._beacon.scale = 0.22 * unit
        self._anchor_word.position = 0.4 * unit * on.up  # clear of what one takes hold of
        foot = float((np.asarray(world.anchor) - on.ground) @ on.up)
        self._mast.points = np.array([[[0.0, 0.0, 0.0], -foot * on.up]])
        self._mast.visible = foot > 0.01 * on.radius
        self._truth.fit(on)
        self._ghost.fit(on)
        for arrow, length, radius in (
            (self._gravity, 1.7, 0.035),
            (self._gravity_estimate, 2.2, 0.022),
            (self._north, 1.5, 0.035),
            (self._north_estimate, 2.0, 0.022),
            (self._far, 3.0, 0.03),
        ):
            arrow.fit(length=length * unit, radius=radius * unit)
        self._gravity.point(np.asarray(world.gravity))
        self._north.point(np.asarray(world.magnetic))

    def _draw_trail(self, positions: Float[Array, "n 3"], on: SceneBounds) -> None:
        """The estimated path, paler the earlier: it may wander far before it settles."""
        dashes, progress = stages.dashed(positions, on)
        self._trail.visible = len(dashes) > 0
        if len(dashes):
            early, late = np.array(linear(PALE)), np.array(linear(VERMILLION))
            colors = early + progress[..., None] * (late - early)
            self._trail.points, self._trail.colors = dashes.astype(np.float32), colors.astype(np.uint8)

    def _draw_blind(self, picture: Picture, on: SceneBounds) -> None:
        """Arrows on the path, in the middle of the window of least rank."""
        directions: tuple[Direction, ...] = picture.analysis.directions
        middle = picture.analysis.gramian_at + picture.preset.requirement.window / 2
        place = picture.preset.path(np.array([middle]))[0]
        for i, arrow in enumerate(self._blind):
            if i >= len(directions):
                arrow.hide()
                continue
            arrow.fit(length=0.7 * on.radius, radius=0.006 * on.radius)
            arrow.place(place)
            arrow.say(blind_label(directions[i]))
            arrow.point(directions[i].vector)


def blind_label(direction: Direction) -> str:
    """A word for a blind direction: what cannot be told along it."""
    along = blindness.name(direction.vector)
    told = [kind for kind in direction.kinds if kind != "snap"]
    return f"blind along {along}: {', '.join(told)}" if told else f"no snap along {along}"
