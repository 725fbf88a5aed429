"""How large the 3-D picture is and which part of a curve fits in it; sizes follow the path. Pure functions.

An unobservable estimate may be anywhere, 10¹⁷ m away or NaN: only what lies on the stage is drawn, no number changed.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from explorer.model.compute import Picture
from rangenav.motion import Motion

REACH = 3.0
"""The stage ends at this many radii from its centre: curves, ellipsoids and ghosts beyond are not drawn."""
ASTRAY = 0.6
"""The estimated path is left out where it is more radii than this from the truth: while it peaks it would cover
everything with stray dashes. The ghost shows it all the same, and the error plots."""
SPHERE_SHARE = 0.8
"""Of the largest range sphere that the camera should see."""
SMALLEST_RADIUS = 0.01
"""m, for a path that stands on its anchor."""
UNIT_SHARE, SMALLEST_UNIT_SHARE, STANDING_SHARE = 0.16, 0.04, 0.3
"""The airframe's size against the stage; a 2 cm path 3 m away gets a small vehicle that one can fly up to, and one
that stands still has no path to cover."""
SAGITTA_SHARE = 0.002
"""How far, in radii, a chord of the drawn true path may leave the curve."""
MAX_POINTS, MAX_DASHES = 1500, 1500
NO_LINE = np.zeros((1, 2, 3))
"""What a line is made of before there is a picture."""
UNSEEN = 1e-4
"""m: the size of what waits for the first picture, while kernels compile; at its own size it would fill the view."""
DASHES_PER_RADIUS = 14


@dataclass(frozen=True, eq=False, kw_only=True)
class SceneBounds:
    """The ball that holds path and anchor, and the sizes that follow from it."""

    centre: Float[Array, "3"]
    radius: float
    unit: float
    """m: the length of the vehicle's arms' span, by which everything small is measured."""
    up: Float[Array, "3"]
    """−g/|g|"""
    ground: Float[Array, "3"]
    """The point below the centre at the height of the lowest of path and anchor."""
    cell: float
    """m between grid lines: 1, 2 or 5 times a power of ten."""
    view_centre: Float[Array, "3"]
    """Where the camera looks, and the radius it should take in: the stage and most of the range sphere."""
    view_radius: float

    def holds(self, points: Float[Array, "n 3"]) -> Array:
        """Which points lie on the stage; NaN does not."""
        with np.errstate(over="ignore", invalid="ignore"):
            return np.linalg.norm(points - self.centre, axis=-1) < REACH * self.radius


def stage(picture: Picture) -> SceneBounds:
    """The stage of a picture."""
    path, anchor = picture.motion.position, np.asarray(picture.preset.world.anchor)
    gravity = np.asarray(picture.preset.world.gravity)
    up = -gravity / np.linalg.norm(gravity)
    path_radius = float(np.linalg.norm(path.max(axis=0) - path.min(axis=0))) / 2
    points = np.vstack([path, anchor])
    low, high = points.min(axis=0), points.max(axis=0)
    centre = (low + high) / 2
    radius = max(float(np.linalg.norm(high - low)) / 2, SMALLEST_RADIUS)
    share = UNIT_SHARE * math.sqrt(path_radius / radius) if path_radius > 1e-3 * radius else STANDING_SHARE
    height = float((points @ up).min() - centre @ up)
    return SceneBounds(
        centre=centre,
        radius=radius,
        unit=radius * max(share, SMALLEST_UNIT_SHARE),
        up=up,
        ground=centre + height * up,
        cell=round_step(radius / 4),
        view_centre=(centre + anchor) / 2,
        view_radius=max(radius, SPHERE_SHARE * float(np.linalg.norm(path - anchor, axis=1).max())),
    )


def round_step(length: float) -> float:
    """The next 1, 2 or 5 times a power of ten, upwards."""
    power = 10.0 ** math.floor(math.log10(length))
    return next(step * power for step in (1, 2, 5, 10) if length <= step * power * (1 + 1e-9))


def solid(motion: Motion, on: SceneBounds) -> Float[Array, "m 2 3"]:
    """The true path as segments."""
    points = motion.position[chords(motion, on)]
    return np.stack([points[:-1], points[1:]], axis=1)


def chords(motion: Motion, on: SceneBounds) -> Int[Array, "k"]:
    """Samples to draw a path through: as few as keep each chord within the sagitta |p̈| Δt²/8, at most 1500."""
    count = len(motion.time)
    step = float(motion.time[1] - motion.time[0])
    fastest = float(np.linalg.norm(motion.acceleration, axis=1).max())
    chord = math.sqrt(8 * SAGITTA_SHARE * on.radius / max(fastest, 1e-9))
    stride = max(int(chord / step), -(-count // MAX_POINTS), 1)
    stride = min(stride, max(count // 8, 1))
    return np.append(np.arange(0, count - 1, stride), count - 1)


def not_astray(picture: Picture, on: SceneBounds) -> Float[Array, "n 3"]:
    """The estimated path, NaN where it is too far from the truth to be drawn as a curve."""
    return near(picture.position_estimate, picture.motion, on)


def near(positions: Float[Array, "n 3"], motion: Motion, on: SceneBounds) -> Float[Array, "n 3"]:
    """The same of any estimated path."""
    with np.errstate(over="ignore", invalid="ignore"):
        astray = ~(np.linalg.norm(positions - motion.position, axis=-1) < ASTRAY * on.radius)
    return np.where(astray[:, None], np.nan, positions)


def sample(grid: Float[Array, "n"], time: float) -> int:
    """The sample nearest to a time."""
    return int(np.clip(np.searchsorted(grid, time - (grid[1] - grid[0]) / 2), 0, len(grid) - 1))


def dashed(
    positions: Float[Array, "n 3"], on: SceneBounds, *, per_radius: int = DASHES_PER_RADIUS
) -> tuple[Float[Array, "m 2 3"], Float[Array, "m 2"]]:
    """A curve as dashes of equal length along it, and their ends' time (0 to 1); only what is on stage."""
    stride = -(-len(positions) // MAX_POINTS)
    timed = np.column_stack([positions, np.linspace(0.0, 1.0, len(positions))])[::stride]
    inside = np.flatnonzero(on.holds(timed[:, :3]))
    runs = [run for run in np.split(timed[inside], np.flatnonzero(np.diff(inside) > 1) + 1) if len(run) > 1]
    if not runs:
        return np.empty((0, 2, 3)), np.empty((0, 2))
    length = sum(_along(run)[-1] for run in runs)
    dash = max(on.radius / per_radius, length / MAX_DASHES)
    cut = np.concatenate([_cut(run, dash) for run in runs])
    return cut[..., :3], cut[..., 3]


def _along(timed: Float[Array, "n 4"]) -> Float[Array, "n"]:
    """Arc length from the first point."""
    return np.cumsum(np.linalg.norm(np.diff(timed[:, :3], axis=0, prepend=timed[:1, :3]), axis=1))


def _cut(timed: Float[Array, "n 4"], dash: float) -> Float[Array, "m 2 4"]:
    """A polyline cut where dashes begin and end, without the parts between them."""
    along = _along(timed)
    places = np.union1d(along, np.arange(0.0, along[-1], dash))
    at = np.stack([np.interp(places, along, column) for column in timed.T], axis=1)
    kept = np.floor((places[:-1] + places[1:]) / 2 / dash) % 2 == 0
    return np.stack([at[:-1], at[1:]], axis=1)[kept]


def turn_from_x(direction: Float[Array, "3"]) -> tuple[float, float, float, float]:
    """The quaternion (w, x, y, z) of the shortest turn from the x axis to a direction of any length but zero."""
    x, y, z = direction / np.linalg.norm(direction)
    if x < -1 + 1e-9:
        return 0.0, 0.0, 0.0, 1.0
    length = math.sqrt(2 * (1 + x))
    return float((1 + x) / length), 0.0, float(-z / length), float(y / length)


def ellipsoid(covariance: Float[Array, "3 3"]) -> tuple[Float[Array, "3"], Float[Array, "3 3"]] | None:
    """Semi-axes (1 σ) and a right-handed frame of them; None if this is no covariance any more."""
    if not np.isfinite(covariance).all():
        return None
    variances, axes = np.linalg.eigh(covariance)
    if variances[0] <= 0:
        return None
    return np.sqrt(variances), axes * np.sign(np.linalg.det(axes))


def last_seen(samples: Float[Array, "n 3"]) -> Float[Array, "n 3"]:
    """Each row, or the last row before it that is not NaN."""
    seen = ~np.isnan(samples).any(axis=1)
    return samples[np.maximum.accumulate(np.where(seen, np.arange(len(samples)), 0))]
