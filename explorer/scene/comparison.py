"""What stands beside the run in the 3-D picture: A's estimated path and its ghost, and the paths of other estimators.

Each has its colour in the plots too, and dashes of its own length.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import LineSegmentsHandle, SceneApi

from explorer.model.comparison import NAMES, NOTHING, Comparison, Name
from explorer.model.compute import Picture
from explorer.scene import bounds as stages
from explorer.scene.bounds import NO_LINE, SceneBounds
from explorer.scene.colors import GREEN, ORANGE, PALE, PURPLE, Color, linear
from explorer.scene.vehicle import Vehicle
from rangenav.comparison import Candidate
from rangenav.motion import Motion

PINNED_DASHES = 36
"""Per radius of the stage; the run's own estimate has 14."""
RIVALS: dict[Name, tuple[Color, int]] = {"EKF": (ORANGE, 7), "refined": (GREEN, 24)}
THICKNESS, THIN = 2.0, 1.5
"""px; the true path has 3."""
BLACK_ENDS = np.zeros((1, 2, 3), dtype=np.uint8)
"""A colour for each end from the start: the browser cannot turn a line of one colour into one of many."""


class ComparisonNodes:
    """The nodes /pinned, /pinned_path, /pinned_trail and one path for each other estimator."""

    def __init__(self, scene: SceneApi) -> None:
        self._ghost = Vehicle(scene, "pinned", PURPLE, opacity=0.35, label_above=False)
        self._ghost.label.text, self._ghost.label.anchor = "A", "center-right"  # beside the words of the others
        self._ghost.show(False)
        self._path = _line(scene, "/pinned_path", PURPLE, THIN)
        self._trail = _line(scene, "/pinned_trail", BLACK_ENDS, THICKNESS)
        self._rivals: dict[Name, LineSegmentsHandle] = {
            name: _line(scene, f"/{name.lower()}_trail", BLACK_ENDS, THICKNESS) for name in NAMES
        }
        self._beside: Comparison = NOTHING
        self._on: SceneBounds | None = None

    def draw(self, picture: Picture, beside: Comparison, on: SceneBounds) -> None:
        """Show them on the stage of a picture; nothing of what is missing."""
        before, self._beside, self._on = self._beside, beside, on
        a = beside.pinned
        if a is None:
            if before.pinned is not None:
                self._ghost.show(False)
                self._path.visible = self._trail.visible = False
        else:
            self._ghost.fit(on)
            self._path.visible = other = not _same(a.motion, picture.motion)
            if other:
                self._path.points = _on_stage(stages.solid(a.motion, on), on)
            dash(self._trail, stages.not_astray(a, on), on, PURPLE, per_radius=PINNED_DASHES)
        paths = {name: _positions(picture, candidate) for name, candidate in beside.baselines if candidate is not None}
        for name, line in self._rivals.items():
            if name in paths:
                color, per_radius = RIVALS[name]
                dash(line, stages.near(paths[name], picture.motion, on), on, color, per_radius=per_radius)
            elif line.visible:
                line.visible = False

    def move(self, time: float) -> None:
        """Put A's ghost where it was at a time, if that is on the stage."""
        a = self._beside.pinned
        if a is None or self._on is None:
            return
        k = stages.sample(a.motion.time, time)
        position, rotation = a.position_estimate[k], a.estimate.rotation[k]
        here = bool(np.isfinite(rotation).all()) and bool(self._on.holds(position))
        self._ghost.show(here)
        if here:
            self._ghost.place(position, rotation)


def _line(scene: SceneApi, name: str, color: Color | Array, thickness: float) -> LineSegmentsHandle:
    return scene.add_line_segments(name, NO_LINE, color, thickness=thickness, thickness_units="screen", visible=False)


def dash(
    line: LineSegmentsHandle, positions: Float[Array, "n 3"], on: SceneBounds, color: Color, *, per_radius: int
) -> None:
    """Draw an estimated path, paler the earlier: it may wander far before it settles."""
    dashes, progress = stages.dashed(positions, on, per_radius=per_radius)
    line.visible = len(dashes) > 0
    if len(dashes):
        early, late = np.array(linear(PALE)), np.array(linear(color))
        colors = early + progress[..., None] * (late - early)
        line.points, line.colors = dashes.astype(np.float32), colors.astype(np.uint8)


def _positions(picture: Picture, candidate: Candidate) -> Float[Array, "n 3"]:
    with np.errstate(over="ignore", invalid="ignore"):
        return candidate.estimate.position(picture.preset.world)


def _on_stage(segments: Float[Array, "m 2 3"], on: SceneBounds) -> Array:
    inside = on.holds(segments).all(axis=1)
    return (segments[inside] if inside.any() else NO_LINE).astype(np.float32)


def _same(a: Motion, b: Motion) -> bool:
    return a is b or np.array_equal(a.position, b.position)
