"""The excitation ∫p⁗p⁗ᵀ of the window that starts now: an ellipsoid on the path, and an arrow along its weakest axis.

The semi-axes are in proportion to the square roots of its eigenvalues. The longest always has the same length in the
picture, so that a flat ellipsoid means a direction that is not excited.
"""

import numpy as np
from viser import SceneApi

from explorer.model import details, palette
from explorer.model.compute import Picture
from explorer.model.drawn import Drawn
from explorer.scene.arrows import Arrow
from explorer.scene.bounds import SceneBounds, quaternion
from explorer.scene.labels import Labels
from explorer.web.frames import place, turn
from rangenav.number_format import significant
from rangenav.observability import blindness
from rangenav.observability.ellipsoid import Ellipsoid

LONGEST = 0.3
"""The longest semi-axis, by the scene's radius."""
THINNEST = 0.004
"""The least semi-axis that is drawn, by the longest one."""


class ExcitationEllipsoid:
    """Nodes /excitation and /weakest; hidden where nothing is excited."""

    def __init__(self, scene: SceneApi, labels: Labels) -> None:
        self._node = scene.add_icosphere(
            "/excitation",
            1.0,
            palette.rgb(palette.EXCITATION),
            subdivisions=3,
            wireframe=True,  # a translucent shell is lost inside the range sphere
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )
        self._weakest = Arrow(scene, labels, "/weakest", "", palette.WEAKEST_AXIS, rank=15, both_ways=True)
        self._picture: Picture | None = None
        self._drawn = Drawn()
        self.enabled = True
        """Whether the layer is switched on; takes effect at the next `move`."""

    def hide(self) -> None:
        """Hide it until the next `show`: it belongs to an earlier path."""
        self._picture = None
        self._node.visible = False
        self._weakest.hide()

    def show(self, picture: Picture) -> None:
        """Show the excitation of this picture's path from now on; `move` draws it."""
        self._picture = picture
        self._drawn.forget()

    def move(self, time: float, bounds: SceneBounds) -> None:
        """Show the excitation of the window that starts at a time (s)."""
        if not self.enabled:
            self._drawn.forget()
            self._node.visible = False
            self._weakest.hide()
        elif self._picture is not None:
            ellipsoid = details.excitation_at(self._picture.preset, time)
            if self._drawn.changed(ellipsoid, bounds):  # the same window for several frames
                self.draw(self._picture, ellipsoid, bounds)

    def draw(self, picture: Picture, ellipsoid: Ellipsoid, bounds: SceneBounds) -> None:
        """Show the excitation of one window, in the middle of that part of the path."""
        strongest = float(ellipsoid.semi_axes[2])
        self._node.visible = drawn = strongest > 0
        if not drawn:
            self._weakest.hide()
            return
        size = LONGEST * bounds.radius
        x, y, z = (size * max(float(axis) / strongest, THINNEST) for axis in ellipsoid.semi_axes)
        middle = picture.preset.path(ellipsoid.start + np.linspace(0.0, ellipsoid.window, 33)).mean(axis=0)
        self._node.scale = (x, y, z)
        place(self._node, middle)
        turn(self._node, quaternion(ellipsoid.axes))
        self._weakest.fit(length=1.25 * size, radius=0.006 * bounds.radius)
        self._weakest.place(middle)
        self._weakest.set_label(weakest_label(ellipsoid))
        self._weakest.point(ellipsoid.weakest)


def weakest_label(ellipsoid: Ellipsoid) -> str:
    """The weakest axis by name, and its eigenvalue μ (m²/s⁷)."""
    along = blindness.name(np.where(np.abs(ellipsoid.weakest) < 1e-9, 0.0, ellipsoid.weakest))
    if ellipsoid.eigenvalues[0] == 0:
        return f"no snap along {along}"
    return f"weakest: {along}, μ = {significant(ellipsoid.eigenvalues[0])}"
