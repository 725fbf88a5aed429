"""Sampled positions as a path: a C⁸ spline through knots, whose values come from local parabolas fitted to the samples.

Positions printed to tenths of a millimetre at 100 Hz do not determine their fourth derivative: a rounding of ε becomes
up to 16 ε/h⁴ = 160 000 m/s⁴. The snap of such a path depends on the knots and not on the flight, so excitation is never
judged from it. The shape of the path is good; its largest distance from the file's positions is reported.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import require, require_within
from rangenav.results import result
from rangenav.signals import Waypoint, Waypoints
from rangenav.signals.waypoints import MAX_POINTS

SPACINGS = (0.5, 0.25, 0.1, 0.05)
"""s between knots, tried if no spacing was chosen: wide spacings smooth more, narrow ones follow more."""
AS_GOOD, CLOSE = 1.5, 2e-4
"""The widest spacing is used whose error is at most this multiple of the least error, or this many metres."""
PER_KNOT = 2.0
"""Least number of samples for each knot, where the spacing is not chosen; with fewer the curve follows their noise."""
LEAST_STEPS = 1.5
"""Usual steps of the samples to either side of a knot from which its value is taken, at the least."""
MIN_SPACING, MAX_SPACING = 0.02, 60.0
ROUNDING = 1e-9
"""Share by which a record may be shorter than a whole number of spacings."""
LEAST_KNOTS = 4
SNAP_OF_NOISE = 16.0
"""The sum of (1, 4, 6, 4, 1), the weights of a fourth difference."""


@result
class SplineFit:
    """A spline near the samples, and its distance from them."""

    path: Waypoints
    spacing: float
    """s"""
    rms: float
    """m"""
    largest: float
    """m"""

    @property
    def summary(self) -> str:
        """The spacing of the knots and the distance from the positions, as one clause."""
        near = f"{1e3 * self.largest:.3g} mm from the file's positions at most ({1e3 * self.rms:.2g} mm rms)"
        return f"path through knots every {self.spacing:g} s, {near}"


def fit(time: Float[Array, "n"], position: Float[Array, "n 3"], *, spacing: float | None, source: str) -> SplineFit:
    """The spline with knots `spacing` apart (s), with free ends; None chooses the spacing.

    Of SPACINGS the widest is chosen whose error is near the least one. The error is the rms distance from n samples,
    over 1 − knots/n: every knot brings a curve nearer to its samples, noise or not (generalised cross-validation).
    Raises ValueError if no spacing fits the samples.
    """
    if spacing is not None:
        return _fit_with(time, position, spacing, source)
    length = float(time[-1] - time[0])
    most = min(MAX_POINTS - 1, len(time) / PER_KNOT)
    possible = [wide for wide in SPACINGS if LEAST_KNOTS <= length / wide + 1 <= most]
    widest = length / (max(LEAST_KNOTS, min(most, MAX_POINTS - 2)) - 1)  # short, long, and slow records
    short = f"{source}: {length:.3g} s are too short for a curve through {LEAST_KNOTS} knots {MIN_SPACING:g} s apart"
    require(bool(possible) or widest >= MIN_SPACING, f"{short}: check the unit of the stamps")
    fits = [_fit_with(time, position, wide, source) for wide in possible or [widest]]
    errors = [one.rms / max(1 - len(one.path.points) / len(time), 1 / len(time)) for one in fits]
    allowed = max(AS_GOOD * min(errors), CLOSE)
    return next(one for one, error in zip(fits, errors, strict=True) if error <= allowed)


def _fit_with(time: Array, position: Array, spacing: float, source: str) -> SplineFit:
    require_within(f"{source}: spacing of knots", spacing, MIN_SPACING, MAX_SPACING, "s")
    length = float(time[-1] - time[0])
    count = int(length / spacing * (1 + ROUNDING)) + 1
    rule = (
        f"{source}: {length:.3g} s make {count} knots {spacing:g} s apart, {LEAST_KNOTS} to {MAX_POINTS} are possible"
    )
    require(LEAST_KNOTS <= count <= MAX_POINTS, rule)
    width = max(length / (count - 1), 2 * LEAST_STEPS * float(np.median(np.diff(time))))
    points = []
    for moment in time[0] + np.linspace(0, length, count):
        value = _local(time, position, moment, width)
        if value is not None:  # None in a gap, which the curve bridges
            points.append(Waypoint(time=float(moment - time[0]), value=value))
    try:
        path = Waypoints(points=tuple(points), free_ends=True)
    except ValueError as error:
        raise ValueError(f"{source}: with knots {spacing:g} s apart {error}") from None
    error = np.linalg.norm(path(time - time[0]) - position, axis=-1)
    return SplineFit(path=path, spacing=spacing, rms=float(np.sqrt(np.mean(error**2))), largest=float(error.max()))


def unjudged(time: Float[Array, "n"], position: Float[Array, "n 3"]) -> str:
    """Why excitation cannot be judged from these positions: one clause with the rounding error of the snap (m/s⁴)."""
    quantum, step = _quantum(position), float(np.median(np.diff(time)))
    noise = SNAP_OF_NOISE * quantum / step**4
    return (
        f"positions in steps of {quantum:.1g} m every {1e3 * step:.3g} ms leave some {noise:.1g} m/s⁴ of rounding in "
        "the snap: excitation cannot be judged from them, only from exact derivatives or from the IMU (rangenav log)"
    )


def _local(time: Array, position: Array, moment: float, width: float) -> tuple[float, float, float] | None:
    """The value at `moment` (s) of the parabola fitted to the samples within width/2 of it; None without samples."""
    first, last = np.searchsorted(time, [moment - width / 2, moment + width / 2 + 1e-9])
    if last - first < 1:
        return None
    degree = min(2, last - first - 1)
    s = (time[first:last] - moment) / width
    basis = s[:, None] ** np.arange(degree + 1)
    x, y, z = np.linalg.lstsq(basis, position[first:last], rcond=None)[0][0].tolist()
    return x, y, z


def _quantum(position: Array) -> float:
    """The unit of the last printed decimal, found from the values: 1e-9 to 1 m."""
    for decimals in range(10):
        if np.allclose(position * 10.0**decimals, np.rint(position * 10.0**decimals), rtol=0, atol=1e-4):
            return 10.0**-decimals
    return 1e-9
