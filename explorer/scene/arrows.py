"""An arrow with a label at its tip: gravity, the magnetic vector, a blind direction, the way to a far estimate.

Its node is turned and scaled; its geometry is one unit arrow along x, so that moving it costs one small message.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.scene.bounds import turn_from_x
from explorer.scene.colors import Color, linear

ALONG_X = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]], dtype=np.float32)
BOTH_WAYS = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], [[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]], dtype=np.float32)


class Arrow:
    """A node under `name` with one arrow, or one each way for a direction that has no sign."""

    def __init__(self, scene: SceneApi, name: str, text: str, color: Color, *, both_ways: bool = False) -> None:
        self._ways = BOTH_WAYS if both_ways else ALONG_X
        self._node = scene.add_arrows(name, self._ways, linear(color), visible=False)
        self._label = scene.add_label(f"{name}/label", text, anchor="center-left", font_screen_scale=0.9)
        self._size = (0.0, 0.0)

    def fit(self, *, length: float, radius: float) -> None:
        """Length and shaft radius in metres."""
        if (length, radius) == self._size:
            return
        self._size = (length, radius)
        self._node.points = self._ways * np.float32(length)
        self._node.shaft_radius, self._node.head_radius = radius, 2.4 * radius
        self._node.head_length = min(6 * radius, 0.5 * length)
        self._label.position = (length + 2 * radius, 0.0, 0.0)

    def point(self, direction: Float[Array, "3"]) -> None:
        """Show it along a direction; not at all if that has no direction."""
        norm = float(np.linalg.norm(direction))
        visible = np.isfinite(norm) and norm > 0
        if visible:
            self._node.wxyz = turn_from_x(direction)
        self._node.visible = bool(visible)

    def place(self, position: Float[Array, "3"]) -> None:
        self._node.position = position

    def say(self, text: str) -> None:
        self._label.text = text

    def hide(self) -> None:
        self._node.visible = False
