"""The bounds of the 3-D picture: a ball that holds path and anchor, and the parts of curves that lie inside it.

All sizes follow the path. An unobservable estimate may be 10¹⁷ m away, or NaN: what lies outside the bounds is left
out, and no number is changed. Pure functions.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from explorer.model.compute import Picture
from rangenav.motion import Motion

SCENE_RADII = 3.0
"""The scene ends at this many radii from its centre: curves, ellipsoids and ghosts beyond are not drawn."""
MAX_STRAY = 0.6
"""Radii from the truth beyond which an estimated path is left out: while an estimate peaks, its dashes would cover
everything else. The ghost and the error plots still show the estimate."""
SPHERE_SHARE = 0.8
"""Share of the largest range sphere that the camera should see."""
MIN_RADIUS = 0.01
"""m, for a path that stays at its anchor."""
UNIT_SHARE, MIN_UNIT_SHARE, STATIONARY_SHARE = 0.22, 0.05, 0.32
"""The airframe's size by the scene's radius. A path of 2 cm that is 3 m away gets a small vehicle, so that the vehicle
does not cover it; a stationary vehicle has no path to cover."""
SAGITTA_SHARE = 0.002
"""Radii by which a chord of the drawn true path may leave the curve."""
MAX_POINTS, MAX_DASHES = 1500, 1500
EMPTY_LINE = np.zeros((1, 2, 3))
"""The points of a line before there is a picture."""
INVISIBLE_SIZE = 1e-4
"""m: the size of a node until the first picture comes; at its usual size it would fill the view meanwhile."""
DASHES_PER_RADIUS = 14


@dataclass(frozen=True, eq=False, kw_only=True)
class SceneBounds:
    """The ball that holds path and anchor, and the sizes that follow from it."""

    centre: Float[Array, "3"]
    radius: float
    unit: float
    """m: the span of the vehicle's arms, in which the sizes of all small nodes are given."""
    up: Float[Array, "3"]
    """−g/|g|"""
    ground: Float[Array, "3"]
    """The point below the centre at the height of the lowest of path and anchor."""
    cell: float
    """m between grid lines: 1, 2 or 5 times a power of ten."""
    view_centre: Float[Array, "3"]
    """The point at which the camera looks."""
    view_radius: float
    """m: what the camera should take in: path, anchor and most of the range sphere."""

    def contains(self, points: Float[Array, "n 3"]) -> Array:
        """Which points lie inside the scene; NaN does not."""
        with np.errstate(over="ignore", invalid="ignore"):
            return np.linalg.norm(points - self.centre, axis=-1) < SCENE_RADII * self.radius

    def holds(self, point: Float[Array, "3"]) -> bool:
        """Whether one point lies inside the scene; NaN does not."""
        return math.dist(point.tolist(), self.centre.tolist()) < SCENE_RADII * self.radius


def scene_bounds(picture: Picture) -> SceneBounds:
    """The bounds of a picture."""
    path, anchor = picture.motion.position, np.asarray(picture.preset.world.anchor)
    gravity = np.asarray(picture.preset.world.gravity)
    up = -gravity / np.linalg.norm(gravity)
    path_radius = float(np.linalg.norm(path.max(axis=0) - path.min(axis=0))) / 2
    points = np.vstack([path, anchor])
    low, high = points.min(axis=0), points.max(axis=0)
    centre = (low + high) / 2
    radius = max(float(np.linalg.norm(high - low)) / 2, MIN_RADIUS)
    share = UNIT_SHARE * math.sqrt(path_radius / radius) if path_radius > 1e-3 * radius else STATIONARY_SHARE
    height = float((points @ up).min() - centre @ up)
    return SceneBounds(
        centre=centre,
        radius=stepped(radius),
        unit=stepped(radius * max(share, MIN_UNIT_SHARE)),
        up=up,
        ground=centre + height * up,
        cell=round_step(stepped(radius) / 4),
        view_centre=(centre + anchor) / 2,
        view_radius=max(radius, SPHERE_SHARE * float(np.linalg.norm(path - anchor, axis=1).max())),
    )


def stepped(length: float) -> float:
    """The next length, upwards, in ratios of 2^(1/8): the nodes keep their sizes while a path changes a little."""
    return 2.0 ** (math.ceil(8 * math.log2(length) - 1e-9) / 8)


def round_step(length: float) -> float:
    """The next 1, 2 or 5 times a power of ten, upwards."""
    power = 10.0 ** math.floor(math.log10(length))
    return next(step * power for step in (1, 2, 5, 10) if length <= step * power * (1 + 1e-9))


def path_segments(motion: Motion, bounds: SceneBounds) -> Float[Array, "m 2 3"]:
    """The true path as line segments."""
    points = motion.position[chord_samples(motion, bounds)]
    return np.stack([points[:-1], points[1:]], axis=1)


def chord_samples(motion: Motion, bounds: SceneBounds) -> Int[Array, "k"]:
    """The samples through which a path is drawn: as few as keep the sagitta |p̈| Δt²/8 of each chord small, at most
    1500."""
    count = len(motion.time)
    step = float(motion.time[1] - motion.time[0])
    fastest = float(np.linalg.norm(motion.acceleration, axis=1).max())
    chord = math.sqrt(8 * SAGITTA_SHARE * bounds.radius / max(fastest, 1e-9))
    stride = max(int(chord / step), -(-count // MAX_POINTS), 1)
    stride = min(stride, max(count // 8, 1))
    return np.append(np.arange(0, count - 1, stride), count - 1)


def near_truth(positions: Float[Array, "n 3"], motion: Motion, bounds: SceneBounds) -> Float[Array, "n 3"]:
    """An estimated path; NaN where it is too far from the true one to be drawn as a curve."""
    with np.errstate(over="ignore", invalid="ignore"):
        strays = ~(np.linalg.norm(positions - motion.position, axis=-1) < MAX_STRAY * bounds.radius)
    return np.where(strays[:, None], np.nan, positions)


def nearest_sample(grid: Float[Array, "n"], time: float) -> int:
    """The sample nearest to a time."""
    return min(int(grid.searchsorted(time - float(grid[1] - grid[0]) / 2)), len(grid) - 1)


def dashes_along(
    positions: Float[Array, "n 3"], bounds: SceneBounds, *, per_radius: int = DASHES_PER_RADIUS
) -> tuple[Float[Array, "m 2 3"], Float[Array, "m 2"]]:
    """A curve as dashes of equal length along it, inside the scene; and the time at both ends of each dash, from 0 at
    the curve's start to 1 at its end."""
    stride = -(-len(positions) // MAX_POINTS)
    timed = np.column_stack([positions, np.linspace(0.0, 1.0, len(positions))])[::stride]
    inside = np.flatnonzero(bounds.contains(timed[:, :3]))
    runs = [run for run in np.split(timed[inside], np.flatnonzero(np.diff(inside) > 1) + 1) if len(run) > 1]
    if not runs:
        return np.empty((0, 2, 3)), np.empty((0, 2))
    length = sum(_arc_length(run)[-1] for run in runs)
    dash = max(bounds.radius / per_radius, length / MAX_DASHES)
    cut = np.concatenate([_cut_into_dashes(run, dash) for run in runs])
    return cut[..., :3], cut[..., 3]


def _arc_length(timed: Float[Array, "n 4"]) -> Float[Array, "n"]:
    """Arc length from the first point."""
    return np.cumsum(np.linalg.norm(np.diff(timed[:, :3], axis=0, prepend=timed[:1, :3]), axis=1))


def _cut_into_dashes(timed: Float[Array, "n 4"], dash: float) -> Float[Array, "m 2 4"]:
    """The dashes of a polyline: cut where dashes begin and end, without the gaps."""
    along = _arc_length(timed)
    places = np.union1d(along, np.arange(0.0, along[-1], dash))
    at = np.stack([np.interp(places, along, column) for column in timed.T], axis=1)
    drawn = np.floor((places[:-1] + places[1:]) / 2 / dash) % 2 == 0
    return np.stack([at[:-1], at[1:]], axis=1)[drawn]


def rotation_from_x(direction: Float[Array, "3"]) -> tuple[float, float, float, float]:
    """The quaternion (w, x, y, z) of the shortest rotation from the x axis to a direction of any length but zero."""
    x, y, z = direction.tolist()
    norm = math.hypot(x, y, z)
    x, y, z = x / norm, y / norm, z / norm
    if x < -1 + 1e-9:
        return 0.0, 0.0, 0.0, 1.0
    length = math.sqrt(2 * (1 + x))
    return (1 + x) / length, 0.0, -z / length, y / length


def quaternion(rotation: Float[Array, "3 3"]) -> tuple[float, float, float, float]:
    """The unit quaternion (w, x, y, z) of a rotation matrix, w ≥ 0. Of 4q², the greatest of its entries on the diagonal
    is divided by, so that no small number is."""
    (a, b, c), (d, e, f), (g, h, i) = rotation.tolist()
    w, x, y, z = 1 + a + e + i, 1 + a - e - i, 1 - a + e - i, 1 - a - e + i
    greatest = max(w, x, y, z)
    if greatest == w:
        q = w, h - f, c - g, d - b
    elif greatest == x:
        q = h - f, x, b + d, c + g
    elif greatest == y:
        q = c - g, b + d, y, f + h
    else:
        q = d - b, c + g, f + h, z
    length = math.copysign(math.hypot(*q), q[0])
    return q[0] / length, q[1] / length, q[2] / length, q[3] / length


def ellipsoid_axes(covariance: Float[Array, "3 3"]) -> tuple[Float[Array, "3"], Float[Array, "3 3"]] | None:
    """Semi-axes (1 σ, ascending) and a right-handed frame of them; None if the matrix is not positive definite."""
    if not np.isfinite(covariance).all():
        return None
    variances, axes = np.linalg.eigh(covariance)
    if variances[0] <= 0:
        return None
    return np.sqrt(variances), axes * np.sign(np.linalg.det(axes))


def last_known(samples: Float[Array, "n 3"]) -> Float[Array, "n 3"]:
    """Each row, or the last row before it that is not NaN."""
    known = ~np.isnan(samples).any(axis=1)
    return samples[np.maximum.accumulate(np.where(known, np.arange(len(samples)), 0))]
