"""The excitation of the window that starts now, as an ellipsoid on the path, and an arrow along its weakest axis.

Its semi-axes are in proportion to √λ of ∫p⁗p⁗ᵀ, the longest always as long in the picture: flat means not excited.
"""

import numpy as np
from viser import SceneApi
from viser.transforms import SO3

from explorer.model import details
from explorer.model.compute import Picture
from explorer.scene.arrows import Arrow
from explorer.scene.bounds import SceneBounds
from explorer.scene.colors import GREEN, ORANGE
from rangenav.observability import blindness
from rangenav.observability.ellipsoid import Ellipsoid

LONGEST = 0.3
"""Of the stage's radius: the longest semi-axis."""
THINNEST = 0.004
"""Of the longest semi-axis: so much is drawn of one that is 0."""


class ExcitationEllipsoid:
    """Nodes /excitation and /weakest; hidden where nothing is excited."""

    def __init__(self, scene: SceneApi) -> None:
        self._node = scene.add_icosphere(
            "/excitation",
            1.0,
            GREEN,
            subdivisions=3,
            wireframe=True,  # a translucent shell is lost inside the range sphere
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )
        self._weakest = Arrow(scene, "/weakest", "", ORANGE, both_ways=True)
        self._shown = True
        self._picture: Picture | None = None

    def show(self, visible: bool) -> None:
        """Switch it on or off; the next draw obeys."""
        self._shown = visible

    def wait(self) -> None:
        """Hide it until the path rests."""
        self._picture = None
        self._node.visible = False
        self._weakest.hide()

    def begin(self, picture: Picture) -> None:
        """The path that it belongs to; `move` then shows it."""
        self._picture = picture

    def move(self, time: float, on: SceneBounds) -> None:
        """Show the excitation of the window that starts at a time (s)."""
        if self._picture is not None:
            self.draw(self._picture, details.excitation_at(self._picture.preset, time), on)

    def draw(self, picture: Picture, found: Ellipsoid, on: SceneBounds) -> None:
        """Show the excitation of one window, in the middle of that part of the path."""
        strongest = float(found.semi_axes[2])
        self._node.visible = drawn = self._shown and strongest > 0
        if not drawn:
            self._weakest.hide()
            return
        size = LONGEST * on.radius
        x, y, z = (size * max(float(axis) / strongest, THINNEST) for axis in found.semi_axes)
        middle = picture.preset.path(found.start + np.linspace(0.0, found.window, 33)).mean(axis=0)
        self._node.scale, self._node.position = (x, y, z), middle
        self._node.wxyz = SO3.from_matrix(found.axes).wxyz
        self._weakest.fit(length=1.25 * size, radius=0.006 * on.radius)
        self._weakest.place(middle)
        self._weakest.say(weakest_label(found))
        self._weakest.point(found.weakest)


def weakest_label(found: Ellipsoid) -> str:
    """What stands at the arrow's tip."""
    along = blindness.name(np.where(np.abs(found.weakest) < 1e-9, 0.0, found.weakest))
    if found.eigenvalues[0] == 0:
        return f"no snap along {along}"
    return f"weakest: {along}, μ = {found.eigenvalues[0]:.3g}"
