"""Pieces through rows with derivatives: of degree 7 through position to jerk, or of degree 5 without jerk.

Knots lie on every k-th row, for the largest k whose error is near the least one. The error is that of the snap columns,
or else of the highest derivative.
"""

from itertools import pairwise

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.formats import hermite, spline_fit
from rangenav.results import result
from rangenav.signals import Polynomials
from rangenav.signals.polynomials import MAX_PIECES

AS_GOOD, CLOSE = 1.5, 1e-3
"""Pieces are good enough if their error is at most this multiple of the least error, or this share of the snap."""
STRIDES = (1, 2, 4, 8, 16, 32, 64, 128)
"""Samples per piece that are tried: close knots amplify rounding of printed digits, distant knots miss the motion."""
SNAP = 4
"""The order of the derivative."""
SNAP_KEPT = 0.1
"""Largest share of the file's snap (rms) that the pieces may miss; with more, the snap comes from the fit."""
AGREES = 0.2
"""Largest difference (rms, relative) between a derivative and the differences of what it is the derivative of."""
UNJUDGED = (
    "without acceleration and jerk the snap would be the fourth difference of sampled positions, which is mostly not "
    "the motion's: excitation cannot be judged from them, only from exact derivatives or from the IMU (rangenav log)"
)
IMPLIED = "the file holds jerk and no snap, and between its rows the pieces have the snap that joins them"
ACCELERATED = (
    "the file holds acceleration and no jerk, and between its rows the pieces have the jerk and snap that join them: "
    "excitation cannot be judged from it"
)


@result
class ReferenceFit:
    """Pieces, and their distance from the file's data."""

    path: Polynomials
    distance: float
    """m, the largest over all rows."""
    snap: float | None
    """Root mean square of the snap's error, relative; None where the file has no snap."""
    stride: int


def path_through(
    time: Array, position: Array, derivatives: list[Array | None], knots: float | None, source: str, findings: list[str]
) -> tuple[Polynomials | spline_fit.Waypoints, float, str, str | None]:
    """The path, its largest distance from the file's positions (m), the kind of fit, and why it is not judged."""
    velocity, acceleration, jerk, snap = derivatives
    if (
        velocity is None
        or acceleration is None
        or (jerk is None and not _agree(time, [position, velocity, acceleration]))
    ):
        findings += _doubts(time, position, velocity, acceleration)
        curve = spline_fit.fit(time, position, spacing=knots, source=source)
        findings.append(curve.summary)
        return curve.path, curve.largest, curve.summary, UNJUDGED
    through = [position, velocity, acceleration, *(() if jerk is None else (jerk,))]
    fit = fitted(time, np.stack(through, axis=1), snap if jerk is not None else None, source=source)
    degree, near = 2 * len(through) - 1, f"{1e3 * fit.distance:.2g} mm from the file's positions at most"
    fit_text = f"pieces of degree {degree} every {fit.stride} rows, {near}"
    if fit.snap is None:
        why = ACCELERATED if jerk is None else IMPLIED
        findings += [fit_text, why]
        return fit.path, fit.distance, fit_text, why
    fit_text += f", snap within {fit.snap:.2%} of the file's"
    findings.append(fit_text)
    lost = f"of the snap in the file the pieces miss {fit.snap:.0%}: its rows are too far apart, or do not agree"
    return fit.path, fit.distance, fit_text, lost if fit.snap > SNAP_KEPT else None


def _doubts(time: Array, position: Array, velocity: Array | None, acceleration: Array | None) -> list[str]:
    """What becomes of velocity and acceleration columns that are no part of the path."""
    if velocity is None:
        return []
    if not _agree(time, [position, velocity]):
        return [_differs("velocity", "position", time, position, velocity)]
    if acceleration is None:
        return ["the velocity columns agree with the differences of the position; the path is made of the position"]
    return [_differs("acceleration", "velocity", time, velocity, acceleration)]


def _differs(word: str, lower: str, time: Array, below: Array, values: Array) -> str:
    share = _difference(time, below, values)
    return f"the {word} columns differ by {share:.0%} from the differences of the {lower}: neither is used but position"


def _agree(time: Array, orders: list[Array]) -> bool:
    """Whether each of the values is the derivative of the one before."""
    return all(_difference(time, low, high) <= AGREES for low, high in pairwise(orders))


def _difference(time: Array, below: Array, values: Array) -> float:
    """Root mean square of values less the differences of what is below, over that of the values."""
    size = float(np.sqrt(np.mean(values**2)))
    slope = np.diff(below, axis=0) / np.diff(time)[:, None]
    return float(np.sqrt(np.mean((slope - (values[1:] + values[:-1]) / 2) ** 2))) / size


def fitted(
    time: Float[Array, "n"], derivatives: Float[Array, "n g 3"], snap: Float[Array, "n 3"] | None, *, source: str
) -> ReferenceFit:
    """Pieces through every k-th row, for the largest k whose error is near the least one.

    derivatives: 0 to g − 1 = 2 or 3. The error is that of the snap, or else of the highest derivative. Pieces are
    equally long but for one row, whatever the number of rows: no short piece is left over at the end.
    """
    fits: list[tuple[float, ReferenceFit]] = []
    order = derivatives.shape[1] - 1 if snap is None else SNAP
    target = derivatives[:, -1] if snap is None else snap
    size = float(np.sqrt(np.mean(target**2)))
    for stride in STRIDES:
        count = max(1, round((len(time) - 1) / stride))
        chosen = np.rint(np.linspace(0, len(time) - 1, count + 1)).astype(int)
        if count > MAX_PIECES or len(time) < 2 or np.diff(time[chosen]).min() < 1e-3:
            continue
        try:
            path = hermite.polynomials(time[chosen], derivatives[chosen])
        except ValueError:  # rounding in knots this close exceeds what pieces may hold
            continue
        error = float(np.sqrt(np.mean((path(time, order) - target)[1:-1] ** 2)))
        distance = float(np.linalg.norm(path(time) - derivatives[:, 0], axis=-1).max())
        relative = error / size if snap is not None and size > 0 else None
        fits.append((error, ReferenceFit(path=path, distance=distance, snap=relative, stride=stride)))
    if not fits:
        raise ValueError(f"{source}: no pieces can be put through these rows: their stamps are too close or too uneven")
    allowed = max(AS_GOOD * min(error for error, _ in fits), CLOSE * size)
    return next(fit for error, fit in reversed(fits) if error <= allowed)
