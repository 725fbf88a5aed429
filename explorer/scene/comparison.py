"""The runs that are compared with the run on the page, in the 3-D picture.

The pinned run A has its true path where that differs, its estimated path, and a ghost. Each other estimator has its
estimated path, with its name where that is farthest from the true path. Every run is a thin solid line in the colour
that it has in the plots.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from viser import LineSegmentsHandle, SceneApi

from explorer.model import palette
from explorer.model.comparison import NAMES, NOTHING, Comparison, Name
from explorer.model.compute import Picture
from explorer.scene.airframe import shape_of
from explorer.scene.bounds import EMPTY_LINE, SceneBounds, near_truth, nearest_sample, path_segments
from explorer.scene.labels import Labels
from explorer.scene.vehicle import Vehicle
from rangenav.comparison import Candidate
from rangenav.motion import Motion

TRAIL_THICKNESS, PATH_THICKNESS = 1.5, 1.5
"""px; the true path has 3."""
NAME_RANK = 6
"""Of the first estimator's name among all labels."""
MAX_PIECES = 600
"""Line segments of an estimated path."""


class ComparisonNodes:
    """The nodes /pinned, /pinned_path, /pinned_trail and one path for each other estimator."""

    def __init__(self, scene: SceneApi, labels: Labels) -> None:
        self._ghost = Vehicle(scene, labels, "pinned", palette.PINNED, opacity=0.35, rank=5, text="A, pinned")
        self._path = _line(scene, "/pinned_path", palette.rgb(palette.PINNED), PATH_THICKNESS)
        self._trail = _line(scene, "/pinned_trail", palette.rgb(palette.PINNED), TRAIL_THICKNESS)
        self._estimators: dict[Name, LineSegmentsHandle] = {
            name: _line(scene, f"/{name.lower()}_trail", palette.rgb(palette.ESTIMATORS[name]), TRAIL_THICKNESS)
            for name in NAMES
        }
        self._names = {name: _Name(scene, labels, name, rank) for rank, name in enumerate(NAMES, start=NAME_RANK)}
        self._comparison: Comparison = NOTHING
        self._bounds: SceneBounds | None = None

    def draw(self, picture: Picture, comparison: Comparison, bounds: SceneBounds) -> None:
        """Show the compared runs inside the bounds of a picture; a run that is missing is hidden."""
        before, self._comparison, self._bounds = self._comparison, comparison, bounds
        if comparison.pinned is not None:
            self._draw_pinned(comparison.pinned, picture, bounds)
        elif before.pinned is not None:
            self._ghost.show(False)
            self._path.visible = self._trail.visible = False
        runs = {name: run for name, run in comparison.baselines if run is not None}
        for name, line in self._estimators.items():
            if name in runs:
                positions = near_truth(_positions(picture, runs[name]), picture.motion, bounds)
                _draw_path(line, positions)
                self._names[name].place(positions, picture.motion, bounds)
            elif line.visible:
                line.visible = False
                self._names[name].hide()

    def move(self, time: float) -> None:
        """Put the ghost of A where its estimate is at a time (s); hide it where that is outside the scene."""
        a = self._comparison.pinned
        if a is None or self._bounds is None:
            return
        k = nearest_sample(a.motion.time, time)
        position, rotation = a.position_estimate[k], a.estimate.rotation[k]
        inside = bool(np.isfinite(rotation).all()) and self._bounds.holds(position)
        self._ghost.show(inside)
        if inside:
            self._ghost.place(position, rotation)

    def _draw_pinned(self, a: Picture, picture: Picture, bounds: SceneBounds) -> None:
        self._ghost.fit(bounds, shape_of(a.preset.vehicle))
        self._path.visible = differs = not _same(a.motion, picture.motion)
        if differs:
            self._path.points = _inside(path_segments(a.motion, bounds), bounds)
        positions = near_truth(a.position_estimate, a.motion, bounds)
        _draw_path(self._trail, positions)


class _Name:
    """The name of an estimator at its path: colour alone would not say whose path it is."""

    def __init__(self, scene: SceneApi, labels: Labels, name: Name, rank: int) -> None:
        self._node = scene.add_frame(f"/{name.lower()}_name", show_axes=False)
        self._point: np.ndarray | None = None
        labels.add(f"/{name.lower()}_name/label", lambda: self._point, rank=rank, text=name)

    def place(self, positions: Float[Array, "n 3"], motion: Motion, bounds: SceneBounds) -> None:
        """Put it where an estimated path inside the scene is farthest from the true one."""
        inside = bounds.contains(positions)
        off = np.where(inside, np.linalg.norm(positions - motion.position, axis=1), -1.0)
        self._point = positions[int(np.argmax(off))] if inside.any() else None
        if self._point is not None:
            self._node.position = self._point

    def hide(self) -> None:
        """Leave it out."""
        self._point = None


def _draw_path(line: LineSegmentsHandle, positions: Float[Array, "n 3"]) -> None:
    """Draw an estimated path where it is known (not NaN)."""
    points = positions[:: -(-len(positions) // MAX_PIECES)]
    lines = np.stack([points[:-1], points[1:]], axis=1)
    lines = lines[np.isfinite(lines).all(axis=(1, 2))]
    line.visible = len(lines) > 0
    if len(lines):
        line.points = lines.astype(np.float32)


def _line(scene: SceneApi, name: str, color: palette.Rgb, thickness: float) -> LineSegmentsHandle:
    return scene.add_line_segments(
        name, EMPTY_LINE, color, thickness=thickness, thickness_units="screen", visible=False
    )


def _positions(picture: Picture, run: Candidate) -> Float[Array, "n 3"]:
    with np.errstate(over="ignore", invalid="ignore"):
        return run.estimate.position(picture.preset.world)


def _inside(segments: Float[Array, "m 2 3"], bounds: SceneBounds) -> Array:
    inside = bounds.contains(segments).all(axis=1)
    return (segments[inside] if inside.any() else EMPTY_LINE).astype(np.float32)


def _same(a: Motion, b: Motion) -> bool:
    return a is b or np.array_equal(a.position, b.position)
