"""The motion that a repair proposes, in the 3-D picture: a line with its name, until it is accepted or discarded."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import SceneApi

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.scene.bounds import EMPTY_LINE, SceneBounds
from explorer.scene.labels import Labels
from rangenav.preset import Preset

THICKNESS = 2.5
"""px; the true path has 3."""
POINTS = 600
NAME = "proposed motion"


class ProposedNodes:
    """The node /proposed: a line and its label."""

    def __init__(self, scene: SceneApi, labels: Labels) -> None:
        self._line = scene.add_line_segments(
            "/proposed", EMPTY_LINE, palette.rgb(palette.PROPOSED), thickness=THICKNESS, thickness_units="screen",
            visible=False,
        )  # fmt: skip
        self._named_point = None
        self._label = labels.add("/proposed/label", lambda: self._named_point, rank=2, text=NAME)

    def draw(self, picture: Picture, proposed: Preset | None, bounds: SceneBounds) -> None:
        """Show the proposed motion inside the bounds of a picture; None hides it."""
        if proposed is None:
            self._line.visible, self._named_point = False, None
            return
        positions = proposed.path(np.linspace(0.0, proposed.duration, POINTS))
        segments = np.stack([positions[:-1], positions[1:]], axis=1)
        segments = segments[bounds.contains(segments).all(axis=1)]
        self._line.visible, self._named_point = len(segments) > 0, None
        if len(segments):
            self._line.points = segments.astype(np.float32)
            self._named_point = _farthest(segments[:, 0], picture.motion.position)
            self._label.handle.position = self._named_point


def _farthest(points: Float[Array, "n 3"], path: Float[Array, "m 3"]) -> Float[Array, "3"]:
    """The one of the points that lies farthest from a path: there the name belongs to one line alone."""
    thinned = path[:: -(-len(path) // POINTS)]
    squares = (points**2).sum(axis=1)[:, None] + (thinned**2).sum(axis=1) - 2.0 * points @ thinned.T
    return points[int(squares.min(axis=1).argmax())]
