"""The tail of the estimate: where it was in the last seconds. All of an estimated path at once would be a haze."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.scene.bounds import SceneBounds, near_truth

LENGTH, PIECES = 3.0, 40
"""s, and the number of line segments, which is always the same: their colours are then sent only once."""
SHARES = np.linspace(0.0, 1.0, PIECES + 1)
"""Of its length, at which one segment ends and the next begins."""
THICKNESS, BIG_THICKNESS = 3.0, 6.0
"""px"""


class Tail:
    """The node /trail."""

    def __init__(self, scene: SceneApi) -> None:
        early, late = np.array(palette.linear(palette.TAIL_END)), np.array(palette.linear(palette.ESTIMATE))
        share = np.stack([np.arange(PIECES), np.arange(1, PIECES + 1)], axis=1)[..., None] / PIECES
        self._node = scene.add_line_segments(
            "/trail",
            np.zeros((PIECES, 2, 3), dtype=np.float32),
            (early + share * (late - early)).astype(np.uint8),
            thickness=THICKNESS,
            thickness_units="screen",
            visible=False,
        )
        self._positions = np.zeros((0, 3))
        self.enabled = True

    def appear(self, *, enabled: bool, big: bool) -> None:
        """Switch the layer on or off, with thick or thin lines."""
        self.enabled, self._node.thickness = enabled, BIG_THICKNESS if big else THICKNESS

    def draw(self, picture: Picture, bounds: SceneBounds) -> None:
        """Take the estimate of a picture; `move` shows its last seconds."""
        self._positions = near_truth(picture.position_estimate, picture.motion, bounds)

    def move(self, picture: Picture, k: int) -> None:
        """Show the seconds before sample k, as far as they are near the true path."""
        step = float(picture.motion.time[1] - picture.motion.time[0])
        lines = pieces(self._positions, k, round(LENGTH / step)) if self.enabled else None
        self._node.visible = lines is not None
        if lines is not None:
            self._node.points = lines.astype(np.float32)


def pieces(positions: Float[Array, "n 3"], k: int, back: int) -> Float[Array, "m 2 3"] | None:
    """`PIECES` segments from sample k - back to sample k; None if there is no known position among them.

    A segment with an end that is NaN has no length, and lies where another one ends."""
    length = min(back, k)
    samples = (k - length) + (SHARES * length + 0.5).astype(int)
    points = positions[samples]
    lines = np.empty((PIECES, 2, 3))
    lines[:, 0], lines[:, 1] = points[:-1], points[1:]
    if not np.isfinite(points).all():
        known = np.isfinite(lines).all(axis=(1, 2))
        if not known.any():
            return None
        lines[~known] = lines[known][-1, 1]
    return lines
