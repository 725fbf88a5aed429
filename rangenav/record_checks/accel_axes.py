"""The axes of the accelerometer: those in which it accelerates as the positions in the file do.

    p(t) = parabola + ∬ R A a          over windows of seconds, for each A of 48 axes
    A a = b + Rᵀ(p̈ − g) + noise         sample by sample, where the positions are smooth enough to be differentiated
The first is robust. The second decides between axes that the first cannot tell apart, because the body is hardly
accelerated along them.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from scipy.interpolate import CubicSpline

from rangenav import motion
from rangenav.formats.recorded_flight import Flight
from rangenav.number_format import fixed, significant
from rangenav.record_checks import axes
from rangenav.record_checks.blocks import KEPT, blocks
from rangenav.record_checks.check import Evidence
from rangenav.record_checks.truth import known_attitudes, level, upwards

MOVED = 3.0
"""s, windows over which positions are compared with the accelerometer's, less a parabola for each."""
MOST_WINDOWS = 40
LEAST_ROWS = 12
"""Samples of a window."""
LEAST_MOTION = 0.02
"""m, rms about the parabolas: smaller motions are the noise of the positions."""
SAME, AS_GOOD = 0.9, 0.02
"""The least correlation of motions that are the same, and by how much less others are as good."""
LIKELIER = 20.0
"""Chi-square by which other axes must fit the acceleration better, among those that fit the motion as well."""
OFF, BETTER = 3.0, 0.4
"""m/s² rms of the windows' mean specific force about −g, and the share of it that other axes leave."""
ALONE = 1.3
"""Axes that leave at most this many times as much explain it as well."""


def accel_axes(flight: Flight) -> Evidence | None:
    """Axes of the accelerometer that are not those of the file's attitude."""
    correlation = correlations(flight)
    if correlation is None or correlation.max() < SAME:
        return _by_gravity(flight)
    good = np.flatnonzero(correlation >= correlation.max() - AS_GOOD)
    if 0 not in good:
        chosen = axes.simplest(good)
        text = (
            f"the file's positions follow the accelerometer in the axes {chosen} (correlation "
            f"{fixed(correlation.max())}) and not in its own ({fixed(correlation[0])}){axes.handedness(chosen)}"
        )
        return Evidence(text=text, suggestion=chosen)
    return None if len(good) == 1 else _by_acceleration(flight, good)


@lru_cache(maxsize=KEPT)
def correlations(flight: Flight) -> Float[Array, "48"] | None:
    """Of the file's positions with the twice integrated accelerometer in each of 48 axes, less parabolas."""
    attitudes = known_attitudes(flight)
    if attitudes is None or flight.position is None:
        return None
    rotation, known = attitudes
    b = blocks(flight)
    position = flight.position[b.start]
    known = known & np.isfinite(position).all(axis=-1)
    window, count = b.windows(MOVED)
    together, own, power, rows = np.zeros(9), 0.0, np.zeros((9, 9)), 0
    for k in np.unique(np.linspace(0, count - 1, MOST_WINDOWS).astype(int)):
        inside = np.flatnonzero(window == k)
        if len(inside) < LEAST_ROWS or not known[inside].all():
            continue
        time = b.time[inside] - b.time[inside[0]]
        products = np.einsum("nki,nj->nkij", rotation[inside], b.accel[inside]).reshape(len(inside), -1)
        parabola, _ = np.linalg.qr(np.stack([time**0, time, time**2], axis=-1))
        moved = _less(parabola, _integral(time, _integral(time, products))).reshape(len(inside) * 3, 9)
        wanted = _less(parabola, position[inside]).reshape(-1)
        together, power = together + moved.T @ wanted, power + moved.T @ moved
        own, rows = own + float(wanted @ wanted), rows + len(inside)
    if rows == 0 or np.sqrt(own / rows) < LEAST_MOTION:
        return None
    flat = axes.MATRICES.reshape(48, 9)
    size = np.sqrt(np.einsum("ai,ij,aj->a", flat, power, flat) * own)
    return flat @ together / np.maximum(size, np.finfo(float).tiny)


def _integral(time: Array, values: Array) -> Array:
    steps = np.diff(time)[:, None] * (values[1:] + values[:-1]) / 2
    return np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(steps, axis=0)])


def _less(basis: Array, values: Array) -> Array:
    return values - basis @ (basis.T @ values)


def _by_acceleration(flight: Flight, candidates: Array) -> Evidence | None:
    """Which of the axes that fit the motion equally well fits the acceleration of the positions best."""
    assert flight.position is not None
    assert flight.rotation is not None
    known = np.isfinite(flight.position).all(axis=-1) & np.isfinite(flight.rotation).all(axis=(1, 2))
    acceleration = CubicSpline(flight.time[known], flight.position[known])(flight.time[known], 2)
    wanted = motion.to_body(flight.rotation[known], acceleration + upwards(flight))[2:-2]
    accel = flight.accel[known][2:-2]
    left = [_errors(accel @ axes.MATRICES[k].T - wanted) for k in candidates]
    squares = np.array([np.sum(error**2) for error in left])
    best = int(np.argmin(squares))
    error = left[best]
    variance = float(np.mean(error**2))
    correlated = max(0.0, float(np.mean(error[1:] * error[:-1])) / variance)
    better = float(squares[0] - squares[best]) / variance * (1 - correlated) / (1 + correlated)
    if better < LIKELIER:
        return None
    chosen = axes.EVERY[int(candidates[best])]
    text = (
        f"the acceleration of the file's positions fits the accelerometer better in the axes {chosen} than in its own "
        f"(chi-square less by {significant(better)}){axes.handedness(chosen)}"
    )
    return Evidence(text=text, suggestion=chosen)


def _errors(values: Array) -> Array:
    """The values without their mean: a bias tells nothing of the axes."""
    return values - values.mean(axis=0)


def _by_gravity(flight: Flight) -> Evidence | None:
    """Which axes turn the mean specific force of a few seconds to −g, without positions."""
    error = level(flight)
    if error is None:
        return None
    own, least = float(error[0]), float(error.min())
    if own < OFF or least > BETTER * own:
        return None
    chosen = axes.simplest(np.flatnonzero(error <= ALONE * least))
    text = (
        f"turned by the file's attitude, the mean specific force is {significant(own)} m/s² from −g, and "
        f"{significant(least)} m/s² in the axes {chosen}{axes.handedness(chosen)}"
    )
    return Evidence(text=text, suggestion=chosen)
