"""The gyro against what else turns: the attitude in the file, and the magnetic field.

truth  log(R(t)ᵀ R(t + lag)) = A ∫ω        A: axes and units of the gyro
field  R' (m − b) is constant               R' = R' [ω]×, b: iron that turns with the body
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import so3
from rangenav.formats.recorded_flight import Flight
from rangenav.number_format import fixed, significant
from rangenav.record_checks import axes
from rangenav.record_checks.blocks import KEPT, blocks, rms
from rangenav.record_checks.check import Evidence, unit_for
from rangenav.results import result

LAGS = (0.1, 0.2, 0.5, 1.0, 2.0)
"""s over which two attitudes are compared; the shortest over which the body turns enough is used."""
ENOUGH, LEAST_TURN = 0.1, 0.005
"""rad, rms: a turn over which attitudes are compared, and the least one that tells anything."""
LARGEST_TURN = 2.5
"""rad: the rotation vector of a larger turn may be that of another one."""
PAIRS, LEAST_PAIRS = 4000, 20
FOLLOWS, DIFFERS = 0.9, 0.1
"""The least correlation of turns that are the same, and by how much it is larger than that of other axes."""
LESS = 0.02
"""By how much less the attitude correlates with the gyro than its inverse does, if it is the inverse that was meant."""
SCALE = 0.2
"""Relative: a gyro whose scale is off by less is not asked about."""


@result
class Follows:
    """How the attitude in a file follows the gyro, for the axes of the gyro that fit best."""

    axes: str
    scale: float
    """The file's attitude turns this many times as fast as the gyro says."""
    correlation: float
    own: float
    """The correlation with the gyro's axes as they are."""
    reversed: float
    """The best correlation if the attitudes were from inertial to body axes."""


@lru_cache(maxsize=KEPT)
def follows(flight: Flight) -> Follows | None:
    """The fit of the gyro's turns to those of the file's attitude; None without one, or where nothing turns."""
    if flight.rotation is None:
        return None
    b = blocks(flight)
    step = float(np.median(np.diff(b.time)))
    turned = np.concatenate([np.zeros((1, 3)), np.cumsum(b.turn, axis=0)])
    rotation = flight.rotation[b.start]
    truth = sensed = backwards = np.empty((0, 3))
    for lag in LAGS:
        n = max(1, round(lag / step))
        k = np.unique(np.linspace(0, len(rotation) - n - 1, PAIRS).astype(int)) if len(rotation) > n else np.array([0])
        if len(rotation) <= n:
            break
        first, last = rotation[k], rotation[k + n]
        known = np.asarray(np.isfinite(first).all(axis=(1, 2)) & np.isfinite(last).all(axis=(1, 2)))
        first, last = first[known], last[known]
        truth = so3.log(np.swapaxes(first, -1, -2) @ last)
        backwards = so3.log(first @ np.swapaxes(last, -1, -2))
        sensed = (turned[k + n] - turned[k])[known]
        small = np.linalg.norm(truth, axis=-1) < LARGEST_TURN
        truth, backwards, sensed = truth[small], backwards[small], sensed[small]
        if len(truth) and rms(truth) >= ENOUGH:
            break
    if len(truth) < LEAST_PAIRS or rms(truth) < LEAST_TURN or rms(sensed) == 0:
        return None
    correlations, scales = _fits(truth, sensed)
    best = int(np.argmax(correlations))
    return Follows(
        axes=axes.EVERY[best],
        scale=float(scales[best]),
        correlation=float(correlations[best]),
        own=float(correlations[0]),
        reversed=float(_fits(backwards, sensed)[0].max()),
    )


def _fits(truth: Array, sensed: Array) -> tuple[Float[Array, "48"], Float[Array, "48"]]:
    """Correlation and scale of the turns for each of the 48 axes."""
    products = np.einsum("aij,ij->a", axes.MATRICES, truth.T @ sensed)
    power = float(np.sum(sensed**2))
    return products / np.sqrt(power * float(np.sum(truth**2))), products / power


def attitude_reversed(flight: Flight) -> Evidence | None:
    """An attitude that does not follow the gyro in any axes: from inertial to body axes, or not this body's."""
    fit = follows(flight)
    if fit is None or fit.own >= FOLLOWS:
        return None
    if fit.reversed >= max(FOLLOWS, fit.correlation + LESS):
        text = (
            f"the inverse of the attitude in the file follows the gyro (correlation {fixed(fit.reversed)}), and the "
            f"attitude in no axes as well ({fixed(fit.correlation)})"
        )
        return Evidence(text=text, suggestion="inverse")
    if fit.correlation >= FOLLOWS:
        return None
    text = f"the attitude in the file follows the gyro in no axes (correlation {fixed(fit.correlation)})"
    return Evidence(text=text, suggestion=None)


def gyro_axes(flight: Flight) -> Evidence | None:
    """Axes of the gyro that are not those of the attitude in the file."""
    fit = follows(flight)
    if fit is None or fit.correlation < FOLLOWS or fit.own > fit.correlation - DIFFERS:
        return None
    text = (
        f"the attitude in the file follows the gyro in the axes {fit.axes} (correlation {fixed(fit.correlation)}) and "
        f"not in its own ({fixed(fit.own)}){axes.handedness(fit.axes)}"
    )
    return Evidence(text=text, suggestion=fit.axes)


def gyro_unit_by_attitude(flight: Flight) -> Evidence | None:
    """A scale of the gyro, against the attitude in the file, that is another unit's."""
    fit = follows(flight)
    unit = unit_for(flight, "gyro", fit.scale) if fit is not None and fit.correlation >= FOLLOWS else None
    if fit is None or unit is None:
        return None
    text = f"the attitude in the file turns {significant(fit.scale)} times as fast as the gyro says, which is {unit}"
    return Evidence(text=text, suggestion=unit)


def time_unit_by_attitude(flight: Flight) -> Evidence | None:
    """A scale of the gyro, against the attitude in the file, that is another unit's of the stamps; else any scale."""
    fit = follows(flight)
    if fit is None or fit.correlation < FOLLOWS or abs(fit.scale - 1) < SCALE or gyro_unit_by_attitude(flight):
        return None
    unit = unit_for(flight, "time", fit.scale)
    text = f"the attitude in the file turns {significant(fit.scale)} times as fast as the gyro says"
    return Evidence(text=text + (f", as if the stamps were {unit}" if unit else ", in no unit known"), suggestion=unit)
