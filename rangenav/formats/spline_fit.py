"""Sampled positions as a path: a C⁸ curve through knots. The value at a knot is that of a parabola fitted around it.

Poses printed to tenths of a millimetre a hundred times a second do not hold their own fourth derivative (a step of ε
becomes up to 16 ε/h⁴ = 160 000 m/s⁴), so the snap of such a path is the knots' and not the flight's: excitation is
never judged from it. What it is good for is its shape, with the largest distance from the file's positions said.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import require, require_within
from rangenav.results import result
from rangenav.signals import Waypoint, Waypoints
from rangenav.signals.waypoints import MAX_POINTS

SPACINGS = (0.5, 0.25, 0.1, 0.05)
"""s between knots, tried in this order if no spacing was chosen: few knots smooth, many knots follow."""
CLOSE = 0.01
"""m: the widest spacing that stays this near to every position is chosen, else the nearest curve."""
MIN_SPACING, MAX_SPACING = 0.02, 60.0
LEAST_KNOTS = 4
SNAP_OF_NOISE = 16.0
"""The sum of (1, 4, 6, 4, 1), the weights of a fourth difference."""


@result
class SplineFit:
    """A curve near the samples."""

    path: Waypoints
    spacing: float
    """s"""
    rms: float
    """m"""
    largest: float
    """m"""

    @property
    def summary(self) -> str:
        """How the curve was made, and its distance from the positions."""
        near = f"{1e3 * self.largest:.3g} mm from the file's positions at most ({1e3 * self.rms:.2g} mm rms)"
        return f"path through knots every {self.spacing:g} s, {near}"


def fit(time: Float[Array, "n"], position: Float[Array, "n 3"], *, spacing: float | None, source: str) -> SplineFit:
    """The curve through knots `spacing` apart (s), or as far apart as it can be to stay within a centimetre.

    It starts and ends at rest, as every such curve does: a record that begins in flight is met less well there.
    """
    if spacing is not None:
        return _fit_with(time, position, spacing, source)
    length = float(time[-1] - time[0])
    tried = [wide for wide in SPACINGS if length / wide < MAX_POINTS - 1] or [length / (MAX_POINTS - 2)]
    fits: list[SplineFit] = []
    refusal = None
    for wide in tried:
        try:
            fits.append(_fit_with(time, position, wide, source))
        except ValueError as error:  # too few samples for knots as close as this, or too short for knots as wide
            refusal = error
            continue
        if fits[-1].largest <= CLOSE:
            break
    if not fits and refusal is not None:
        raise refusal
    return min(fits, key=lambda one: one.largest)


def _fit_with(time: Array, position: Array, spacing: float, source: str) -> SplineFit:
    require_within("spacing of knots", spacing, MIN_SPACING, MAX_SPACING, "s")
    length = float(time[-1] - time[0])
    count = int(length / spacing) + 1
    rule = (
        f"{source}: {length:.3g} s make {count} knots {spacing:g} s apart, {LEAST_KNOTS} to {MAX_POINTS} are possible"
    )
    require(LEAST_KNOTS <= count <= MAX_POINTS, rule)
    at = time[0] + np.linspace(0, length, count)
    points = []
    for k, moment in enumerate(at):
        value = _local(time, position, moment, length / (count - 1))
        require(value is not None, f"{source}: no samples around the knot at {moment:.3g} s: choose wider knots")
        assert value is not None
        points.append(Waypoint(time=float(at[k] - time[0]), value=value))
    path = Waypoints(points=tuple(points))
    error = np.linalg.norm(path(time - time[0]) - position, axis=-1)
    return SplineFit(path=path, spacing=spacing, rms=float(np.sqrt(np.mean(error**2))), largest=float(error.max()))


def unjudged(time: Float[Array, "n"], position: Float[Array, "n 3"]) -> str:
    """Why excitation cannot be judged from these positions, with the number."""
    quantum, step = _quantum(position), float(np.median(np.diff(time)))
    noise = SNAP_OF_NOISE * quantum / step**4
    return (
        f"positions in steps of {quantum:.1g} m every {1e3 * step:.3g} ms leave some {noise:.1g} m/s⁴ of rounding in "
        "the snap: excitation cannot be judged from them, only from exact derivatives or from the IMU (rangenav log)"
    )


def _local(time: Array, position: Array, moment: float, width: float) -> tuple[float, float, float] | None:
    """The value, at a time, of the parabola that fits the samples within half a knot's spacing."""
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
