"""A globe of starts beside the path: each axis about which the attitude may be wrong is a dot, coloured by how long it
takes to settle.

    +u and −u of each undesired equilibrium R̃ = 2uuᵀ − I (paper, theorem) are sticks through it, with their names
Dots that never settle are larger, of another shape and of a colour that is not on the scale.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.model import basin
from explorer.model.compute import Picture
from explorer.scene.bounds import NO_LINE, SceneBounds
from explorer.scene.colors import PURPLE
from explorer.scene.view import direction
from rangenav.ensemble import Basin

SIZE = 0.25
"""Radius of the globe, in radii of the view."""
OFF = 0.75
"""How far from the middle of the view, in radii of the view: with its sticks it is still seen."""
TURNS = [sign * k * math.pi / 8 for k in range(9) for sign in (1, -1)]
"""rad from straight up, where it may be: the nearest to up first."""
CLEAR = 1.3
"""How far from path and anchor its centre should be, in its radii."""
CORE = 0.97
"""An opaque ball inside, in radii of the globe: dots of the far side would be read as those of the near one."""
GREY = (214, 214, 214)
BLACK = (20, 20, 20)
CROWDED = 300
"""So many dots have the size below; fewer are larger and more are smaller, so that they cover as much of the globe."""
DOT, LARGER = 0.07, 1.6
"""Half the width of a dot in radii; and how many times larger one that never settles is, or the slowest's rim."""
LARGEST = 2.0
"""Times the usual size: a few dots do not cover the globe."""
STICK, LABEL = 1.28, 1.36
"""Ends of the sticks through the undesired equilibria, in radii, and their names."""
POINTER = 1.5
"""The end of a line from the slowest start: seen from most sides though its dot be behind the globe."""
TITLE = 1.55
DIGITS = "₁₂₃"


class Globe:
    """The node /basin and what is on it; hidden while there is none."""

    def __init__(self, scene: SceneApi) -> None:
        self._root = scene.add_frame("/basin", show_axes=False, visible=False)
        self._core = scene.add_icosphere(
            "/basin/core", CORE, GREY, subdivisions=5, cast_shadow=False, receive_shadow=False
        )
        dot = np.array([[0.0, 0.0, 1.0]], dtype=np.float32)
        black = np.array([BLACK], dtype=np.uint8)
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
            "/basin/equilibria", NO_LINE, PURPLE, thickness=4.0, thickness_units="screen"
        )
        self._names = [
            scene.add_label(f"/basin/u{k}", "", anchor="center-center", font_screen_scale=0.9) for k in range(6)
        ]
        self._pointer = scene.add_line_segments(
            "/basin/slowest/pointer", NO_LINE, BLACK, thickness=2.0, thickness_units="screen"
        )
        self._slowest = scene.add_label("/basin/slowest/label", "", anchor="bottom-center", font_screen_scale=0.9)
        self._title = scene.add_label("/basin/title", "", anchor="bottom-center", font_screen_scale=0.9)
        self._drawn: Basin | None = None

    def draw(self, picture: Picture, found: Basin | None, on: SceneBounds) -> None:
        """Show a sphere of starts that belongs to a picture, or none."""
        self._root.visible = found is not None
        if found is None:
            self._drawn = None
            return
        radius = SIZE * on.view_radius
        self._root.position = place(picture.motion.position, np.asarray(picture.preset.world.anchor), on)
        self._core.scale = radius
        self._title.position = TITLE * radius * on.up
        if found is not self._drawn:
            self._drawn = found
            self._draw_dots(found, radius, on.up)
            self._draw_equilibria(picture, radius)

    def _draw_dots(self, found: Basin, radius: float, up: Float[Array, "3"]) -> None:
        settles = np.isfinite(found.settle)
        size = DOT * radius * min((CROWDED / len(settles)) ** 0.5, LARGEST)
        colors = basin.colors(found)
        for cloud, chosen, larger in ((self._dots, settles, 1.0), (self._never, ~settles, LARGER)):
            cloud.visible = bool(chosen.any())
            if chosen.any():
                cloud.points, cloud.colors = (radius * found.axis[chosen]).astype(np.float32), colors[chosen]
                cloud.point_size = larger * size
        last = basin.slowest(found)
        axis, when = found.axis[last], found.settle[last]
        self._rim.points = (0.995 * radius * axis[None]).astype(np.float32)
        self._rim.point_size = (LARGER if settles[last] else LARGER**2) * size
        self._pointer.points = (radius * np.array([[axis, POINTER * axis]])).astype(np.float32)
        self._slowest.position = POINTER * radius * axis
        self._slowest.anchor = "bottom-center" if axis @ up >= 0 else "top-center"  # not across the pointer
        self._slowest.text = f"slowest, {when:.3g} s" if settles[last] else f"not settled in {found.time[-1]:.3g} s"
        self._title.text = f"starts at {np.degrees(found.angle):.4g}°"

    def _draw_equilibria(self, picture: Picture, radius: float) -> None:
        axes = basin.equilibria(picture)
        self._sticks.points = (STICK * radius * np.stack([-axes, axes], axis=1)).astype(np.float32)
        for k, label in enumerate(self._names):
            sign = (1.0, -1.0)[k % 2]
            label.position = sign * LABEL * radius * axes[k // 2]
            label.text = f"{'+' if sign > 0 else '−'}u{DIGITS[k // 2]}"


def place(path: Float[Array, "n 3"], anchor: Float[Array, "3"], on: SceneBounds) -> Float[Array, "3"]:
    """Where the globe's centre is: beside the middle of the view as the camera is first set, above it rather than
    below, and there the first place that is clear of path and anchor, or else the one that is most so."""
    towards = direction(on.up)
    upwards = on.up - (on.up @ towards) * towards
    screen = np.stack([np.cross(upwards, towards), upwards]) / np.linalg.norm(upwards)
    seen = (np.vstack([path, anchor]) - on.view_centre) @ screen.T / on.view_radius
    spots = [OFF * np.array([math.sin(turn), math.cos(turn)]) for turn in TURNS]
    clear = [float(np.linalg.norm(seen - spot, axis=1).min()) for spot in spots]
    best = next((k for k, distance in enumerate(clear) if distance > CLEAR * SIZE), int(np.argmax(clear)))
    return on.view_centre + on.view_radius * spots[best] @ screen
