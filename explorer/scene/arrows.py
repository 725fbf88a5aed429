"""An arrow with a label at its tip: gravity, the magnetic vector, a blind direction, the direction of a far estimate.

The geometry is one unit arrow along x. Only the node is rotated, so that pointing it elsewhere costs one small message.
"""

import math
from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.model import palette
from explorer.scene.bounds import rotation_from_x
from explorer.scene.labels import Labels
from explorer.web.frames import place, turn

ALONG_X = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]], dtype=np.float32)
BOTH_WAYS = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], [[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]], dtype=np.float32)


def _origin() -> Float[Array, "3"]:
    return np.zeros(3)


class Arrow:
    """A node under `name` with one arrow, or with two opposite arrows for a direction that has no sign."""

    def __init__(
        self,
        scene: SceneApi,
        labels: Labels,
        name: str,
        text: str,
        color: palette.Color,
        *,
        rank: int,
        both_ways: bool = False,
        label_at: float = 1.0,
        origin: Callable[[], Float[Array, "3"]] = _origin,
    ) -> None:
        """rank: of its label. label_at: its place, by the arrow's length. origin: where the parent node is (m, inertial
        frame)."""
        self._shape = BOTH_WAYS if both_ways else ALONG_X
        self._node = scene.add_arrows(name, self._shape, palette.linear(color), visible=False)
        self._origin, self._direction, self._tip, self._label_at = origin, np.zeros(3), 0.0, label_at
        self._label = labels.add(f"{name}/label", self._tip_position, rank=rank, text=text, side="center-left")
        self._size = (0.0, 0.0)
        self.enabled = True
        """Whether its layer is switched on; takes effect when it is pointed next."""

    def fit(self, *, length: float, radius: float) -> None:
        """Length and shaft radius in metres."""
        if (length, radius) == self._size:
            return
        self._size = (length, radius)
        self._node.points = self._shape * np.float32(length)
        self._node.shaft_radius, self._node.head_radius = radius, 2.4 * radius
        self._node.head_length = min(6 * radius, 0.5 * length)
        self._tip = self._label_at * length + 2 * radius
        self._label.handle.position = (self._tip, 0.0, 0.0)

    def point(self, direction: Float[Array, "3"]) -> None:
        """Show it along a vector; hide it where the vector is zero or not finite."""
        norm = math.hypot(*direction.tolist())
        visible = self.enabled and math.isfinite(norm) and norm > 0
        if visible:
            turn(self._node, rotation_from_x(direction))
            self._direction = direction / norm
        self._node.visible = bool(visible)

    def place(self, position: Float[Array, "3"]) -> None:
        place(self._node, position)

    def set_label(self, text: str) -> None:
        self._label.write(text)

    def hide(self) -> None:
        self._node.visible = False

    def _tip_position(self) -> Float[Array, "3"] | None:
        if not self._node.visible:
            return None
        return self._origin() + np.asarray(self._node.position) + self._tip * self._direction
