"""The world in the 3-D picture: ground grid, anchor with its mast and range sphere, gravity, the magnetic vector, and
the directions along which the range is blind."""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import SceneApi
from viser.transforms import SO3

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.model.drawn import Drawn
from explorer.scene import airframe
from explorer.scene.arrows import Arrow
from explorer.scene.bounds import EMPTY_LINE, INVISIBLE_SIZE, SceneBounds, rotation_from_x
from explorer.scene.labels import Labels
from explorer.web.frames import place
from rangenav.motion import World
from rangenav.observability import blindness
from rangenav.observability.blindness import Direction

USUAL_UP = (0.0, 0.0, -1.0)
"""The paper's z axis points down."""
GRID_RADII, FADE_RADII, CELLS_PER_SECTION = 16, 14, 5
BEACON_SHARE, RINGS_SHARE, LABEL_SHARE = 0.16, 0.36, 0.42
"""Radius of the beacon, size of the rings around it, and height of the anchor's label above it, clear of the drag
handle; in units of the scene."""
MIN_MAST = 0.01
"""Radii; a shorter mast is hidden."""
MIN_RANGE = 1e-6
"""m: the least radius of the range sphere, as the browser takes no scale of 0."""
MAX_BLIND, PARALLEL = 6, 0.999
"""Blind directions that are drawn; and the cosine above which two directions are the same."""


class WorldNodes:
    """The grid, and the nodes under /anchor and /compass that show the true world."""

    def __init__(self, scene: SceneApi, labels: Labels) -> None:
        self._scene, self._up = scene, np.array(USUAL_UP)
        self._fitted, self._sized, self._gridded = Drawn(), Drawn(), Drawn()
        scene.set_up_direction(USUAL_UP)
        self._grid = scene.add_grid("/grid", plane="xy", fade_strength=1.5)
        color = palette.rgb(palette.ANCHOR)
        self._anchor = scene.add_frame("/anchor", show_axes=False, visible=False)
        self._beacon = scene.add_icosphere(
            "/anchor/beacon", 1.0, color, subdivisions=2, flat_shading=True, scale=INVISIBLE_SIZE
        )
        rings = airframe.beacon()
        self._rings = scene.add_mesh_simple(
            "/anchor/rings", rings.vertices, rings.faces, color=color, opacity=0.75, side="double", scale=INVISIBLE_SIZE
        )
        self._mast = scene.add_line_segments("/anchor/mast", EMPTY_LINE, color, thickness=3.0, thickness_units="screen")
        self._label = labels.add("/anchor/label", self._above_anchor, rank=0, text="anchor")
        self._sphere = scene.add_icosphere(
            "/anchor/range",
            1.0,
            palette.rgb(palette.RANGE_SPHERE),
            subdivisions=14,
            opacity=0.1,
            scale=INVISIBLE_SIZE,
            material="toon3",  # without a graphics card: 33 frames a second; standard material on both sides gives 2
            cast_shadow=False,
            receive_shadow=False,
        )
        self._compass = scene.add_frame("/compass", show_axes=False)

        def origin() -> np.ndarray:
            return np.asarray(self._compass.position)

        self._gravity = Arrow(scene, labels, "/compass/gravity", "g", palette.GRAVITY, rank=20, origin=origin)
        self._magnetic = Arrow(scene, labels, "/compass/magnetic", "m", palette.MAGNETIC, rank=21, origin=origin)
        self._anchor_position, self._label_height = np.zeros(3), np.zeros(3)

    def appear(self, *, vectors: bool, sphere: bool, dark: bool) -> None:
        """Switch the layers on or off; the ground stays faint on a dark page as on a light one."""
        self._grid.cell_color, self._grid.section_color = (palette.rgb(one) for one in palette.SCENE_GRID[dark])
        self._gravity.enabled = self._magnetic.enabled = vectors
        self._sphere.visible = sphere
        self._fitted.forget()
        self._sized.forget()

    def fit(self, world: World, bounds: SceneBounds) -> None:
        """Take the sizes of a scene and the vectors of a world; values that have not changed are not sent again."""
        if not self._fitted.changed(world, bounds):
            return
        self._fit_grid(bounds)
        if self._sized.changed(world, bounds.unit, *bounds.up.tolist()):  # a path that moves a little keeps all of it
            self._fit_sizes(world, bounds)
        height = float((self._anchor_position - bounds.ground) @ bounds.up)
        self._mast.points = np.array([[[0.0, 0.0, 0.0], -height * bounds.up]])
        self._mast.visible = height > MIN_MAST * bounds.radius

    def _fit_sizes(self, world: World, bounds: SceneBounds) -> None:
        unit, up = bounds.unit, bounds.up
        self._anchor_position = np.asarray(world.anchor)
        self._anchor.position, self._anchor.visible = self._anchor_position, True
        self._beacon.scale, self._rings.scale = BEACON_SHARE * unit, RINGS_SHARE * unit
        self._rings.wxyz = _upright(bounds)
        self._label_height = LABEL_SHARE * unit * up
        self._label.handle.position = self._label_height
        self._gravity.fit(length=1.7 * unit, radius=0.035 * unit)
        self._magnetic.fit(length=1.5 * unit, radius=0.035 * unit)
        self._gravity.point(np.asarray(world.gravity))
        self._magnetic.point(np.asarray(world.magnetic))

    def move(self, position: Float[Array, "3"]) -> None:
        """Put the vectors at the vehicle's position (m), and let the range sphere pass through it."""
        place(self._compass, position)
        self._sphere.scale = max(math.dist(position.tolist(), self._anchor_position.tolist()), MIN_RANGE)

    def _fit_grid(self, bounds: SceneBounds) -> None:
        if not np.allclose(self._up, bounds.up):
            self._up = bounds.up
            self._scene.set_up_direction(bounds.up)
        self._grid.position, cell = bounds.ground, bounds.cell
        if not self._gridded.changed(bounds.radius, cell, *bounds.up.tolist()):
            return
        self._grid.width = self._grid.height = round(GRID_RADII * bounds.radius / cell) * cell
        self._grid.cell_size, self._grid.section_size = cell, CELLS_PER_SECTION * cell
        self._grid.fade_distance = FADE_RADII * bounds.radius
        self._grid.wxyz = _upright(bounds)

    def _above_anchor(self) -> Float[Array, "3"]:
        return self._anchor_position + self._label_height


def _upright(bounds: SceneBounds) -> Float[Array, "4"]:
    """The quaternion that turns z up."""
    return (SO3(np.array(rotation_from_x(bounds.up))) @ SO3.from_y_radians(np.pi / 2)).wxyz


class BlindDirections:
    """Arrows along the blind directions, on the path in the middle of the window of least rank; one label for all."""

    def __init__(self, scene: SceneApi, labels: Labels) -> None:
        self._arrows = [
            Arrow(scene, labels, f"/blind{i}", "", palette.BLIND_DIRECTION, rank=3 + i, both_ways=True, label_at=0.45)
            for i in range(MAX_BLIND)
        ]
        self.enabled, self._drawn = True, Drawn()

    def draw(self, picture: Picture, bounds: SceneBounds) -> None:
        """Show the blind directions of a picture; the same direction of two quantities is one arrow."""
        if not self._drawn.changed(picture.analysis, picture.preset.path, bounds, self.enabled):
            return
        directions = distinct(picture.analysis.directions) if self.enabled else ()
        middle = picture.analysis.gramian_at + picture.preset.requirement.window / 2
        position = picture.preset.path(np.array([middle]))[0]
        for i, arrow in enumerate(self._arrows):
            if i >= len(directions):
                arrow.hide()
                continue
            arrow.fit(length=0.7 * bounds.radius, radius=0.006 * bounds.radius)
            arrow.place(position)
            arrow.set_label(blind_label(directions, picture.analysis.directions) if i == 0 else "")
            arrow.point(directions[i].vector)


def distinct(directions: tuple[Direction, ...]) -> tuple[Direction, ...]:
    """The first of all that have the same direction in space, up to its sign."""
    found: list[Direction] = []
    for direction in directions:
        if not any(abs(direction.vector @ other.vector) > PARALLEL for other in found):
            found.append(direction)
    return tuple(found)


def blind_label(shown: tuple[Direction, ...], every: tuple[Direction, ...]) -> str:
    """Which quantities cannot be determined along the directions that are shown."""
    along = ", ".join(dict.fromkeys(blindness.name(direction.vector) for direction in shown))
    kinds = dict.fromkeys(kind for direction in every for kind in direction.kinds if kind != "snap")
    return f"blind along {along}: {', '.join(kinds)}" if kinds else f"no snap along {along}"
