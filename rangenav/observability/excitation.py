"""Persistency of excitation: ∫_t^{t+δ} (Rφ)(Rφ)ᵀ ds = ∫ p⁗ p⁗ᵀ ds ≥ μ I₃ for all t (paper, Proposition 1).

    φ = ä + 2ω×ȧ + ω̇×a + ω×(ω×a) = Rᵀ p⁗      (the snap in body axes)
The paper prints φ = ä − ω×ȧ − 2ω×(ω×a), integrated in body axes. That condition holds for a vehicle that hovers and
turns, which is unobservable. Excitation is necessary for observability on a window, and not sufficient:
p⁗ = (τ, τ², τ³) excites all three directions of a window of rank 10. The same path s times slower has μ over one period
smaller by s⁷.
Where the snap of a piecewise path jumps, the least excited window often starts or ends at a knot. Such windows are
evaluated in addition to those of the grid.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.arguments import finite_array, increasing_array, number
from rangenav.inputs import require
from rangenav.motion import Motion, to_body, to_inertial
from rangenav.observability import quadrature, running_sums, windows
from rangenav.signals import Signal, knots

MIN_GRID, MAX_GRID = 64, 4000
"""The bound for all t evaluates at least and at most so many windows."""
MAX_KNOTS = 2000
"""Most knots at which additional windows start or end. With more knots a window has hundreds, and no one matters."""
UNEXCITED = 1e-12
"""An excitation below this share of window · sup|p⁗|² counts as zero; a finer grid would not change it."""
CLEAR = 1e-6
"""An excitation above this share of it is far from zero, whatever rounds it."""
BOUND_SHARE, BOUND_ROUNDS = 0.05, 4
"""The grid is refined until the possible drop of λ_min between its points is at most this share of μ: only where λ_min
is low, so two rounds and 700 windows give the bound for which an even grid needs 4000."""


def phi(motion: Motion) -> Float[Array, "n 3"]:
    """φ = Rᵀp⁗ (m/s⁴), body axes."""
    return to_body(motion.rotation, motion.snap)


def phi_printed(motion: Motion) -> Float[Array, "n 3"]:
    """The printed φ = ä − ω×ȧ − 2ω×(ω×a), body axes, with the true derivatives of a = Rᵀ(p̈ − g)."""
    w = motion.angular_velocity
    rate, second = apparent_derivatives(motion)
    return second - np.cross(w, rate) - 2 * np.cross(w, np.cross(w, motion.apparent_acceleration))


def apparent_derivatives(motion: Motion) -> tuple[Float[Array, "n 3"], Float[Array, "n 3"]]:
    """ȧ and ä in body axes, from Rᵀp⃛ = ȧ + ω×a and from Rᵀp⁗ = ä + 2ω×ȧ + ω̇×a + ω×(ω×a)."""
    w, a = motion.angular_velocity, motion.apparent_acceleration
    rate = to_body(motion.rotation, motion.jerk) - np.cross(w, a)
    turning = 2 * np.cross(w, rate) + np.cross(motion.angular_acceleration, a) + np.cross(w, np.cross(w, a))
    return rate, phi(motion) - turning


def eigenvalues(path: Signal, start: Float[Array, "w"], window: float) -> Float[Array, "w 3"]:
    """Eigenvalues (m²/s⁷, ascending) of ∫p⁗p⁗ᵀ over [t, t + δ], from singular values of the weighted snap.

    Raises ValueError for what `windows.checked` refuses, and for windows with too many nodes.
    """
    start, window = windows.checked(path, start, window)
    return np.linalg.svd(_triangles(path, start, window), compute_uv=False)[:, ::-1] ** 2


def directions(path: Signal, start: float, window: float) -> tuple[Float[Array, "3"], Float[Array, "3 3"]]:
    """Eigenvalues (m²/s⁷, ascending) and eigenvectors (columns, inertial axes) of the excitation of one window.

    Raises ValueError as `eigenvalues` does.
    """
    _, singular, right = np.linalg.svd(_triangles(path, *windows.checked_one(path, start, window))[0])
    return singular[::-1] ** 2, right[::-1].T


def _triangles(path: Signal, start: Array, window: float) -> Array:
    tau, weight = quadrature.nodes(path, start, window, raised=quadrature.SNAP)
    snap = path(start[:, None] + tau, 4) * np.sqrt(weight * window)[..., None]
    return np.asarray(np.linalg.qr(snap, mode="r"))


def floor(values: Float[Array, "w 3"]) -> float:
    """Eigenvalues of the excitation (m²/s⁷) below this are rounding: the path has no snap along their direction."""
    return UNEXCITED * float(values.max())


def most(path: Signal, window: float) -> float:
    """What no eigenvalue (m²/s⁷) of any window (s) exceeds: ∫|p⁗|² ≤ δ sup|p⁗|². Infinite where no bound is known."""
    snap = path.bound(4)
    return window * snap * snap


def worst(path: Signal, start: Float[Array, "w"], window: float) -> tuple[Float[Array, "3"], float]:
    """The eigenvalues (ascending, the first is μ) of the least excited window, and when it starts (s).

    Between the first and the last of these windows, those that start or end at a knot of the path are evaluated too.
    Raises ValueError as `eigenvalues` does.
    """
    start, window = windows.checked(path, start, window)
    first, last = float(start.min()), float(start.max())
    sums = running_sums.between(path, first, last + window)
    if sums is not None:
        events = _events(path, first, last, window)
        every = start if events is None else np.union1d(start, events)
        least = running_sums.least_eigenvalues(path, sums, every, window)
        alike = least <= least.min() + 2 * (sums.rounding + sums.quadrature)  # sums cannot tell these apart
        lowest = int(np.sum(alike))
        start = every[np.argsort(least, kind="stable")[: min(lowest, len(start))]]
    values = eigenvalues(path, start, window)
    k = int(np.argmin(values[:, 0]))
    return values[k], float(start[k])


def bound_for_all_t(path: Signal, window: float) -> float | None:
    """A lower bound (≥ 0) of μ over every window, at every t ≥ 0.

    None if the path has no period, so that no finite grid covers all t, or if p⁗ or p⁽⁵⁾ has no known bound.

    λ_min is concave. |Ẅ| ≤ 2 Σ sup|p⁗| sup|p⁽⁵⁾|, summed over the pieces in which the window starts and ends, holds
    unless an end lies at a knot. Windows with an end at a knot are points of the grid, so between neighbours Δ apart
    λ_min stays above min(λᵢ, λᵢ₊₁) − (Δ²/8) sup|Ẅ|. The snap may jump at knots; lower derivatives must not.
    """
    _, window = windows.checked_one(path, 0.0, window)
    period = path.period
    if period is None:
        return None
    if period == 0:
        return 0.0
    events = _events(path, 0.0, period, window)
    if events is None or not math.isfinite(path.bound(4)):
        return None
    time = np.union1d(np.linspace(0, period, MIN_GRID + 1), events)
    sums = running_sums.between(path, 0.0, period + window)
    if sums is None:
        least, rounding = eigenvalues(path, time, window)[:, 0], 0.0
    else:
        least, rounding = running_sums.least_eigenvalues(path, sums, time, window), sums.rounding
    for _ in range(BOUND_ROUNDS):
        more = _refinements(time, least, _slack(path, time, window))
        if sums is None or len(more) == 0 or least.min() <= UNEXCITED * window * path.bound(4) ** 2:
            break
        order = np.argsort(np.append(time, more))
        least = np.append(least, running_sums.least_eigenvalues(path, sums, more, window))[order]
        time = np.append(time, more)[order]
    lowest = lowest_between(least, _slack(path, time, window), rounding)
    return max(0.0, lowest) if math.isfinite(lowest) else None


def lowest_between(least: Float[Array, "w"], drop: Float[Array, "c"], rounding: float) -> float:
    """A lower bound of λ_min over every start between the points of a grid, from its values at these points.

    `bound_for_all_t` uses it on a grid of at most 4000 starts, refined in 4 rounds, with the drop of `drop_between`. A
    certificate uses it on up to 40 000 starts with a smaller drop (`eigenvalue_drop`), and adds the error
    of its quadrature to the rounding.
    """
    return float(np.min(np.minimum(least[1:], least[:-1]) - drop)) - rounding


def drop_between(start: Float[Array, "w"], *ends: tuple[Float[Array, "c"], Float[Array, "c"]]) -> Float[Array, "c"]:
    """How far λ_min may fall below both of two neighbouring starts Δ apart: (Δ²/8) sup|Ẅ|, sup|Ẅ| ≤ Σ 2 |p⁗| |p⁽⁵⁾|.

    ends: for the window's start and for its end, bounds of |p⁗| and |p⁽⁵⁾| on each cell. No window between two
    neighbours may start or end at a knot of the path.
    """
    curvature = sum(snap * rate for snap, rate in ends)
    return np.diff(start) ** 2 / 4 * curvature


def _events(path: Signal, first: float, last: float, window: float) -> Array | None:
    """Starts of windows, strictly between two times, that start or end at a knot; None if there are too many knots."""
    if knots.most(path, last - first + window) > MAX_KNOTS:
        return None
    return np.union1d(knots.knots(path, first, last), knots.knots(path, first + window, last + window) - window)


def _slack(path: Signal, time: Array, window: float) -> Array:
    """The drop between neighbouring times (s), from bounds of the path's snap and its rate."""
    middle = (time[1:] + time[:-1]) / 2
    ends = (middle, middle + window)
    return drop_between(
        time, *((knots.bounds_between(path, 4, end), knots.bounds_between(path, 5, end)) for end in ends)
    )


def _refinements(time: Array, least: Array, slack: Array) -> Array:
    """Times to add to the grid: between two neighbours as many as their λ_min and their drop require."""
    low = np.minimum(least[1:], least[:-1])
    aim, spare = (1 - BOUND_SHARE) * least.min(), BOUND_SHARE * least.min()
    loose = low - slack < aim
    if spare <= 0 or not loose.any() or not np.isfinite(slack).all():
        return np.zeros(0)
    parts = np.maximum(2, np.ceil(np.sqrt(slack[loose] / np.maximum(low[loose] - aim, spare))))
    parts = np.floor(parts * min(1.0, max(0, MAX_GRID - len(time)) / parts.sum())).astype(int)
    added = np.maximum(parts - 1, 0)
    number = np.arange(added.sum()) - np.repeat(np.cumsum(added) - added, added) + 1
    return np.repeat(time[:-1][loose], added) + number * np.repeat(np.diff(time)[loose] / np.maximum(parts, 1), added)


def sampled_eigenvalues(
    signal: Float[Array, "n 3"], time: Float[Array, "n"], start: Float[Array, "w"], window: float
) -> Float[Array, "w 3"]:
    """Eigenvalues of ∫ signal signalᵀ for an evenly sampled signal (trapezoidal rule), for the printed forms of φ.

    Raises ValueError for arrays of other shapes, stamps that do not increase, and windows outside the samples.
    """
    time = increasing_array("time", time, ("n",))
    signal = finite_array("signal", signal, (len(time), 3))
    start, window = finite_array("start", start, ("w",)), number("window", window)
    require(len(time) >= 2, f"a sampled signal needs at least two samples, got {len(time)}")
    fits = len(start) > 0 and time[0] <= start.min() and start.max() <= time[-1] and window > 0
    require(bool(fits), f"windows must start within the samples, {time[0]:g} to {time[-1]:g} s, and be longer than 0 s")
    h = time[1] - time[0]
    first = np.rint((start - time[0]) / h).astype(int)
    last = np.minimum(first + round(window / h), len(time) - 1)
    integral = np.empty((len(start), 3, 3))
    for i in range(3):
        for j in range(i + 1):
            product = signal[:, i] * signal[:, j]
            total = np.cumsum(product) * h - (product[0] + product) * (h / 2)
            integral[:, i, j] = integral[:, j, i] = total[last] - total[first]
    return np.linalg.eigvalsh(integral)


def chosen_signal(motion: Motion, *, printed_formula: bool, body_axes: bool) -> Float[Array, "n 3"]:
    """φ by the derived or the printed formula, in inertial or body axes: the four combinations of the two misprints."""
    signal = phi_printed(motion) if printed_formula else phi(motion)
    return signal if body_axes else to_inertial(motion.rotation, signal)
