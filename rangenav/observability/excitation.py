"""Persistency of excitation: ∫_t^{t+δ} (Rφ)(Rφ)ᵀ ds = ∫ p⁗ p⁗ᵀ ds ≥ μ I₃ for all t (paper, Proposition 1).

    φ = ä + 2ω×ȧ + ω̇×a + ω×(ω×a) = Rᵀ p⁗      (snap, seen in body axes)
The printed paper has φ = ä − ω×ȧ − 2ω×(ω×a), integrated in body axes: it certifies a hovering, turning vehicle.
Excitation is necessary on each window and not sufficient on one: p⁗ = (τ, τ², τ³) excites all three directions of a
rank-10 window. Running the same path s times slower scales μ over one period by s⁻⁷.
"""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.motion import Motion, to_body, to_inertial
from rangenav.observability import rows
from rangenav.signals import Signal

MIN_GRID, MAX_GRID, MAX_EVALUATIONS = 64, 4000, 150_000
"""Windows on which the bound for all t looks at least and at most, and snaps it may evaluate: 30 ms."""
UNEXCITED = 1e-12
"""An excitation below this share of what the path's snap could give is none; a finer grid would not change that."""
CELL_NODES, CELLS_PER_RADIAN = 4, 2.0
"""Cells of half a radian of the fastest tone, which 4 Gauss nodes integrate to 1e-11 of it."""
BOUND_SHARE = 0.05
"""The grid for the statement "for all t" is refined until what lies between its points costs this share of μ."""


def phi(motion: Motion) -> Float[Array, "n 3"]:
    """φ = Rᵀp⁗ (m/s⁴), body axes."""
    return to_body(motion.rotation, motion.snap)


def phi_printed(motion: Motion) -> Float[Array, "n 3"]:
    """The printed φ = ä − ω×ȧ − 2ω×(ω×a), body axes, with the true derivatives of a = Rᵀ(p̈ − g)."""
    w = motion.angular_velocity
    rate, second = apparent_derivatives(motion)
    return second - np.cross(w, rate) - 2 * np.cross(w, np.cross(w, motion.apparent_acceleration))


def apparent_derivatives(motion: Motion) -> tuple[Float[Array, "n 3"], Float[Array, "n 3"]]:
    """ȧ and ä in body axes: Rᵀp⃛ = ȧ + ω×a, and Rᵀp⁗ as in the module's formula."""
    w, a = motion.angular_velocity, motion.apparent_acceleration
    rate = to_body(motion.rotation, motion.jerk) - np.cross(w, a)
    turning = 2 * np.cross(w, rate) + np.cross(motion.angular_acceleration, a) + np.cross(w, np.cross(w, a))
    return rate, phi(motion) - turning


def eigenvalues(path: Signal, start: Float[Array, "w"], window: float) -> Float[Array, "w 3"]:
    """Eigenvalues (m²/s⁷, ascending) of ∫p⁗p⁗ᵀ over [t, t + δ], from singular values of the weighted snap."""
    return _singular(path, start, window)[0]


def directions(path: Signal, start: float, window: float) -> tuple[Float[Array, "3"], Float[Array, "3 3"]]:
    """Eigenvalues (ascending) and eigenvectors (columns) of the excitation of one window."""
    values, right = _singular(path, np.array([start]), window)
    return values[0], right[0, ::-1].T


def _singular(path: Signal, start: Array, window: float) -> tuple[Array, Array]:
    tau, weight = rows.nodes(path, start, window)
    snap = path(start[:, None] + tau, 4) * np.sqrt(weight * window)[:, None]
    _, singular, right = np.linalg.svd(np.linalg.qr(snap, mode="r"))
    return singular[:, ::-1] ** 2, right


def floor(values: Float[Array, "w 3"]) -> float:
    """Of the excitation's eigenvalues (m²/s⁷) those below this are rounding: no snap lies along their direction."""
    return UNEXCITED * float(values.max())


def worst(path: Signal, start: Float[Array, "w"], window: float) -> tuple[float, float]:
    """The least excitation μ over the windows, and the start time of the window that has it."""
    least = eigenvalues(path, start, window)[:, 0]
    k = int(np.argmin(least))
    return float(least[k]), float(start[k])


def bound_for_all_t(path: Signal, window: float) -> float | None:
    """A lower bound (≥ 0) of μ over every window, at every t ≥ 0.

    None if the path has no period, so that no grid covers it, or if nothing bounds its snap and the rate of that.

    λ_min is concave, and |Ẅ| ≤ 4 sup|p⁗| sup|p⁽⁵⁾|, so between grid points Δ apart it stays above
    min(λᵢ, λᵢ₊₁) − (Δ²/8) · 4 sup|p⁗| sup|p⁽⁵⁾|.
    """
    period = path.period
    if period is None:
        return None
    if period == 0:
        return 0.0
    curvature = path.bound(4) * path.bound(5) / 2
    if not np.isfinite(curvature):
        return None
    least, count = worst(path, np.linspace(0, period, MIN_GRID + 1), window)[0], MIN_GRID
    evaluations = CELL_NODES * CELLS_PER_RADIAN * path.bandwidth * (period + window)
    if least > UNEXCITED * window * path.bound(4) ** 2 and evaluations <= MAX_EVALUATIONS:
        count = int(np.clip(period * np.sqrt(curvature / (BOUND_SHARE * least)), MIN_GRID, MAX_GRID)) + 1
        least = min(least, _least_on_grid(path, window, period, count))
    return max(0.0, least - curvature * (period / count) ** 2)


def _least_on_grid(path: Signal, window: float, period: float, count: int) -> float:
    """The least eigenvalue over `count` windows or more, at most period/count apart: from sums over small cells.

    Neighbouring windows share nearly all their cells, so thousands of them cost one pass over the path. A difference of
    sums has the rounding of the whole sum, which is taken off; the spectra shown never come from here.
    """
    per_window = int(np.ceil(max(count / period, CELLS_PER_RADIAN * path.bandwidth) * window))
    step = window / per_window
    cells = int(np.ceil(period / step)) + per_window
    nodes, weight = np.polynomial.legendre.leggauss(CELL_NODES)
    snap = path(step * (np.arange(cells)[:, None] + (nodes + 1) / 2), 4) * np.sqrt(weight * step / 2)[:, None]
    total = np.concatenate([np.zeros((1, 3, 3)), np.cumsum(snap.transpose(0, 2, 1) @ snap, axis=0)])
    windows = total[per_window:] - total[:-per_window]
    rounding = cells * np.finfo(float).eps * float(np.trace(total[-1]))
    return float(np.linalg.eigvalsh(windows)[:, 0].min()) - rounding


def sampled_eigenvalues(
    signal: Float[Array, "n 3"], time: Float[Array, "n"], start: Float[Array, "w"], window: float
) -> Float[Array, "w 3"]:
    """Eigenvalues of ∫ signal signalᵀ for any sampled signal (trapezoid); the printed forms, which need R, use it."""
    h = time[1] - time[0]
    first = np.rint((start - time[0]) / h).astype(int)
    count = round(window / h)
    outer = signal[:, :, None] * signal[:, None, :]
    total = np.concatenate([np.zeros((1, 3, 3)), np.cumsum((outer[1:] + outer[:-1]) * (h / 2), axis=0)])
    last = np.minimum(first + count, len(time) - 1)
    return np.linalg.eigvalsh(total[last] - total[first])


def chosen_signal(motion: Motion, *, printed_formula: bool, body_axes: bool) -> Float[Array, "n 3"]:
    """φ by either formula, in either axes: all four combinations of the two misprints."""
    signal = phi_printed(motion) if printed_formula else phi(motion)
    return signal if body_axes else to_inertial(motion.rotation, signal)
