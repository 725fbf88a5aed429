"""The globe of initial attitude errors next to the path: a dot for each axis of the error, coloured by settling time.

Each undesired equilibrium R̃ = 2uuᵀ − I (paper, theorem) has a stick through the globe, from −u to +u, with both names.
Dots that never settle are larger, have another shape, and a colour that is not on the scale.
"""

import math
from functools import partial

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.model import basin, palette
from explorer.model.compute import Picture
from explorer.scene.bounds import EMPTY_LINE, SceneBounds, near_truth
from explorer.scene.labels import Label, Labels
from explorer.scene.view import view_direction
from rangenav.ensemble import Basin
from rangenav.number_format import quantity, subscript

SIZE = 0.25
"""Radius of the globe, in radii of the view."""
OFFSETS = (0.75, 0.9, 1.05)
"""Distances from the middle of the view, in radii of the view: the globe with its sticks is then still in view, for the
last one beside the path in a picture that is wider than high."""
ANGLES = [sign * k * math.pi / 8 for k in range(9) for sign in (1, -1)]
"""rad from straight up in the view: the directions that are tried for the globe, those nearest to up first."""
CLEARANCE = 1.3
"""Least distance of its centre from path and anchor, in radii of the globe."""
CORE = 0.97
"""Radius of the opaque ball inside, in radii of the globe: it hides the dots of the far side."""
USUAL_COUNT = 300
"""This many dots have the size below. Fewer are larger and more are smaller: they always cover the same area."""
DOT, EMPHASIS = 0.07, 1.6
"""Half the width of a dot in radii of the globe; and the factor for a dot that never settles, or the rim of the
slowest."""
MAX_ENLARGEMENT = 2.0
"""The largest factor on the size of the dots: a few dots need not cover the globe."""
STICK, LABEL = 1.28, 1.36
"""Where the sticks through the undesired equilibria end, and where their names are, in radii of the globe."""
POINTER = 1.5
"""Where the line from the slowest start ends, in radii of the globe: visible from most sides, even if the dot is on the
far side."""
TITLE = 1.55
"""Height of the title, in radii of the globe."""


class Globe:
    """The node /basin and all below it; hidden while there is no basin."""

    def __init__(self, scene: SceneApi, labels: Labels) -> None:
        self._root = scene.add_frame("/basin", show_axes=False, visible=False)
        self._core = scene.add_icosphere(
            "/basin/core", CORE, palette.rgb(palette.GLOBE), subdivisions=5, cast_shadow=False, receive_shadow=False
        )
        dot = np.array([[0.0, 0.0, 1.0]], dtype=np.float32)
        ink = palette.rgb(palette.GLOBE_INK)
        black = np.array([ink], dtype=np.uint8)
        self._dots = scene.add_point_cloud(
            "/basin/settling", dot, black, point_shape="circle", precision="float32", point_shading="flat"
        )
        self._never = scene.add_point_cloud(
            "/basin/never", dot, black, point_shape="diamond", precision="float32", point_shading="flat"
        )
        self._rim = scene.add_point_cloud(
            "/basin/slowest", dot, black, point_shape="circle", precision="float32", point_shading="flat"
        )
        self._sticks = scene.add_line_segments(
            "/basin/equilibria", EMPTY_LINE, palette.rgb(palette.EQUILIBRIUM), thickness=4.0, thickness_units="screen"
        )
        self._names = [labels.add(f"/basin/u{k}", partial(self._name_at, k), rank=30 + k) for k in range(6)]
        self._pointer = scene.add_line_segments(
            "/basin/slowest/pointer", EMPTY_LINE, ink, thickness=2.0, thickness_units="screen"
        )
        self._slowest = labels.add("/basin/slowest/label", lambda: self._at(self._slowest), rank=29)
        self._title = labels.add("/basin/title", lambda: self._at(self._title), rank=28)
        self._drawn: Basin | None = None

    def draw(self, picture: Picture, shown: Basin | None, bounds: SceneBounds) -> None:
        """Show the basin that belongs to a picture, or none."""
        self._root.visible = shown is not None
        if shown is None:
            self._drawn = None
            return
        radius = SIZE * bounds.view_radius
        estimate = near_truth(picture.position_estimate, picture.motion, bounds)
        run = np.vstack([picture.motion.position, estimate[np.isfinite(estimate).all(axis=1)]])
        self._root.position = globe_centre(run, np.asarray(picture.preset.world.anchor), bounds)
        self._core.scale = radius
        self._title.handle.position = TITLE * radius * bounds.up
        if shown is not self._drawn:
            self._drawn = shown
            self._draw_dots(shown, radius, bounds.up)
            self._draw_equilibria(picture, radius)

    def _draw_dots(self, starts: Basin, radius: float, up: Float[Array, "3"]) -> None:
        settles = np.isfinite(starts.settle)
        size = DOT * radius * min((USUAL_COUNT / len(settles)) ** 0.5, MAX_ENLARGEMENT)
        colors = basin.colors(starts)
        for cloud, chosen, factor in ((self._dots, settles, 1.0), (self._never, ~settles, EMPHASIS)):
            cloud.visible = bool(chosen.any())
            if chosen.any():
                cloud.points, cloud.colors = (radius * starts.axis[chosen]).astype(np.float32), colors[chosen]
                cloud.point_size = factor * size
        last = basin.slowest(starts)
        axis, when = starts.axis[last], starts.settle[last]
        self._rim.points = (0.995 * radius * axis[None]).astype(np.float32)
        self._rim.point_size = (EMPHASIS if settles[last] else EMPHASIS**2) * size
        self._pointer.points = (radius * np.array([[axis, POINTER * axis]])).astype(np.float32)
        self._slowest.handle.position = POINTER * radius * axis
        self._slowest.side = "bottom-center" if axis @ up >= 0 else "top-center"  # not across the pointer
        self._slowest.handle.anchor = self._slowest.side
        self._slowest.write(
            f"slowest, {quantity(when, 's')}" if settles[last] else f"not settled in {quantity(starts.time[-1], 's')}"
        )
        self._title.write(f"starts at {quantity(np.degrees(starts.angle), '°', digits=4)}")

    def _draw_equilibria(self, picture: Picture, radius: float) -> None:
        axes = basin.equilibria(picture)
        self._sticks.points = (STICK * radius * np.stack([-axes, axes], axis=1)).astype(np.float32)
        for k, label in enumerate(self._names):
            sign = (1.0, -1.0)[k % 2]
            label.handle.position = sign * LABEL * radius * axes[k // 2]
            label.write(f"{'+' if sign > 0 else '−'}u{subscript(k // 2 + 1)}")

    def _name_at(self, k: int) -> Float[Array, "3"] | None:
        return self._at(self._names[k])

    def _at(self, label: Label) -> Float[Array, "3"] | None:
        if not self._root.visible:
            return None
        return np.asarray(self._root.position) + np.asarray(label.handle.position)


def globe_centre(path: Float[Array, "n 3"], anchor: Float[Array, "3"], bounds: SceneBounds) -> Float[Array, "3"]:
    """The globe's centre (m), for the camera as it is first set.

    The directions from the middle of the view are tried in order, those above the path first, at each of the distances.
    The first place that is clear of path and anchor is taken, or else the one with the largest distance from them.
    """
    towards = view_direction(bounds.up)
    upwards = bounds.up - (bounds.up @ towards) * towards
    screen = np.stack([np.cross(upwards, towards), upwards]) / np.linalg.norm(upwards)
    projected = (np.vstack([path, anchor]) - bounds.view_centre) @ screen.T / bounds.view_radius
    spots = [away * np.array([math.sin(angle), math.cos(angle)]) for away in OFFSETS for angle in ANGLES]
    gaps = [float(np.linalg.norm(projected - spot, axis=1).min()) for spot in spots]
    best = next((k for k, gap in enumerate(gaps) if gap > CLEARANCE * SIZE), int(np.argmax(gaps)))
    return bounds.view_centre + bounds.view_radius * spots[best] @ screen
