"""Acquisition: how noise-matched gains start from anywhere, and how a false solution is noticed.

The noise-matched gains depend on the estimate, so that from a far start they can lock into a false solution. They start
from the prior x̂(0), P(0), and their innovations are watched from the first range on:

    NIS = (y − ŷ)²/(P₁₁ + R);   NIS > 36: an outlier, corrects nothing;   Σ NIS > 132.79 within 64 ranges: an alarm

An alarm has probability 1e-6 in each window of a consistent observer. If the mean NIS of its window is below 9, the
noise may be up to three times the stated one, or the IMU may have a bias: gate and alarm are multiplied by that mean,
and the gains go on. Up to a mean of 36 the alarm is mild: the gains go on with P multiplied by that mean, and with gate
and alarm multiplied by 9, for constant gains would follow the bias of a gyro. Above 36 the gains are given up, and
constant gains, which converge from anywhere, run in their place.
Ranges are collected, from t0 on, which is the start of the record or the time of an alarm, to determine the state
without a prior. With the transition Φ(s, t0), the response r(s) to the inputs alone, τ = s − t0, and D(s, t0) of the
row 𝒞Φ = [1, τ, τ²/2, τ³/6, Dᵀ, τDᵀ, ½τ²Dᵀ], the twice integrated specific force,

    ½d_k² − ½σ² = 𝒞Φ(s_k, t0) x(t0) + 𝒞r(s_k) + η_k
    var η_k = d²σ² + ½σ⁴ + d²c(s_k),   c(s) = q_a τ³/3 + q_ω ∫|D(s, r)|² dr,   d² smoothed over the ranges before
    x̂ = Φ x̂(t0) + r,   P = 2 (1 + Σ_k d²c(s_k)/var η_k) max(1, χ²/(m − 13)) ΦΛ⁻¹Φᵀ + 2τ V(x̂)

c(s) is what the noise of accelerometer and gyro has added to a range since t0. x̂(t0) is the weighted least squares
of the m ranges, Λ = HᵀH its information, χ² its misfit. The factor in brackets holds for any correlation of the IMU's
part: where C is the covariance of that part in units of √var η, the covariance of x̂(t0) is at most
Λ⁻¹Hᵀ(I + C)HΛ⁻¹, and no eigenvalue of C exceeds its trace. The factor 2 is for the noise between t0 and now, which is
correlated with x̂(t0): cov(a + b) ≤ 2 cov a + 2 cov b. The ranges determine the state as soon as the rank is 13 and
√tr P_pp, without the first two factors and V, is below the distance. The matched gains then start from this x̂ and P.
Where they are already running, they go on instead, unless their position contradicts that of the ranges:

    eᵀ(P_pp + P̂_pp)⁻¹e > 30.66,   e the difference of the two positions; probability 1e-6 where both are right

A range that the collected ones exclude at 6 σ is left out. A collection whose IMU noise outweighs its ranges begins
anew. If no matched gains are running and few ranges were outliers, they then start from x̂ = (½d², 0, …) and a P that
excludes no place at the distance d and no speed below σ_v, 10 σ_v or 100 σ_v of P(0), at the first, second and third
time. Alarms begin a collection, unless one is going on. At most three times may a collection begin by an alarm or gains
start in this way; gains given up after that are lost, and constant gains stay. The collection of a mild alarm counts
only if gains are given up in it. The numbers and their reasons stand in `kernels.layout`. The functions below are the
reference implementation, which is meant to be read and tests the compiled one.
"""

from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import model
from rangenav.kernels import layout
from rangenav.results import result

PHASES: tuple[Literal["constant", "collecting", "matched", "lost"], ...] = ("constant", "collecting", "matched", "lost")
"""What the numbers in `Estimate.phase` mean: constant gains by choice; constant gains until the collected ranges
determine the state, after an alarm; noise-matched gains; constant gains because the matched ones were alarmed once too
often."""
CONSTANT, COLLECTING, MATCHED, LOST = range(len(PHASES))


@result
class Noise:
    """What the observer knows of the noise."""

    range: float
    """m, 1 σ."""
    accel_density: float
    """(m/s²)²/Hz, q_a."""
    gyro_density: float
    """(rad/s)²/Hz, q_ω."""


@result
class Collection:
    """Ranges since t0, in axes that the gyro has turned since then."""

    turned: Float[Array, "3 3"]
    """From body axes to those at t0."""
    elapsed: float
    """s, τ."""
    transition: Float[Array, "13 13"]
    """Φ(now, t0)."""
    response: Float[Array, "13"]
    """r(now)."""
    squares: Float[Array, "3"]
    """∫|D|² dr, ∫D·W dr, ∫|W|² dr."""
    vectors: Float[Array, "2 3"]
    """∫D dr, ∫W dr."""
    triangle: Float[Array, "14 14"]
    """Of the rows [𝒞Φ, ½d² − ½σ² − 𝒞r]/√var η; its last entry is χ, the root of the misfit."""
    count: int
    """m, ranges in it."""
    refused: int
    """Outliers."""
    weight: float
    """Σ d²c/var η."""
    mean_square: float
    """m², the smoothed d²; NaN before the first range."""
    next_check: float
    """s, the least τ at which it is solved again."""


@result
class Watch:
    """A window of innovations."""

    count: int
    total: float
    """What the alarm judges: outliers count layout.OUTLIER in it."""
    size: float
    """As `total`, but outliers count layout.GATE."""
    scale: float
    """By which gate and alarm are larger than for noise as stated."""


def collection() -> Collection:
    """A collection that begins now."""
    return Collection(
        turned=np.eye(3),
        elapsed=0.0,
        transition=np.eye(model.STATES),
        response=np.zeros(model.STATES),
        squares=np.zeros(3),
        vectors=np.zeros((2, 3)),
        triangle=np.zeros((model.STATES + 1, model.STATES + 1)),
        count=0,
        refused=0,
        weight=0.0,
        mean_square=np.nan,
        next_check=0.0,
    )


def moved(
    of: Collection,
    turn: Float[Array, "3 3"],
    accel: Float[Array, "3"],
    h: float,
    *,
    gravity_norm: float,
    form: model.ModelForm,
) -> Collection:
    """The collection h seconds later. turn: by the gyro. accel: the mean over h, m/s², body axes at its start."""
    a = of.turned @ accel
    phi, integral = model.transition(a, h, gravity_norm=gravity_norm, form=form)
    (dd, dw, ww), (d, w), aa, t = of.squares, of.vectors, a @ a, of.elapsed
    squares = (
        dd + 2 * h * dw + h**2 * (ww + a @ d) + h**3 * (a @ w) + h**4 * aa * t / 4,
        dw + h * (ww + a @ d) + 1.5 * h**2 * (a @ w) + h**3 * aa * t / 2,
        ww + 2 * h * (a @ w) + h**2 * aa * t,
    )
    return replace(
        of,
        turned=of.turned @ turn,
        elapsed=t + h,
        transition=phi @ of.transition,
        response=phi @ of.response + integral,
        squares=np.array(squares),
        vectors=np.array([d + h * w + h**2 * t * a / 2, w + h * t * a]),
    )


def collected(of: Collection, y: float, noise: Noise) -> Collection:
    """The collection with one more y = ½d² − ½σ²."""
    square, s2 = max(2 * y, 0.0), max(noise.range**2, layout.LEAST_VARIANCE)
    mean = square if np.isnan(of.mean_square) else of.mean_square
    imu = mean * (noise.accel_density * of.elapsed**3 / 3 + noise.gyro_density * of.squares[0])
    variance = mean * s2 + s2**2 / 2 + imu
    row = np.append(of.transition[0], y - of.response[0]) / np.sqrt(variance)
    if _is_outlier(of, row):
        return replace(of, refused=of.refused + 1)
    triangle = np.asarray(np.linalg.qr(np.vstack([of.triangle, row]), mode="r"))
    return replace(
        of,
        triangle=triangle,
        count=of.count + 1,
        weight=of.weight + imu / variance,
        mean_square=mean + layout.SMOOTHING * (square - mean),
    )


def _is_outlier(of: Collection, row: Float[Array, "14"]) -> bool:
    """Whether the innovation of a row, divided by its variance 1 + hΛ⁻¹hᵀ and by the misfit, is above the gate."""
    R = of.triangle[: model.STATES, : model.STATES]
    if of.count <= model.STATES or not np.diag(R).all():
        return False
    u = np.linalg.solve(R.T, row[: model.STATES])
    innovation = row[-1] - u @ of.triangle[: model.STATES, -1]
    return bool(innovation**2 > layout.GATE * _misfit(of) * (1 + u @ u))


def _misfit(of: Collection) -> float:
    return max(1.0, of.triangle[-1, -1] ** 2 / (of.count - model.STATES))


def outweighed(of: Collection) -> bool:
    """Whether the IMU's noise outweighs the ranges: another collection should begin."""
    return of.weight > layout.IMU_SHARE * of.count


def refuted(of: Collection) -> bool:
    """Whether too many of the ranges are outliers: another collection should begin."""
    return of.refused > layout.MOST_REFUSED + of.count / 2


def clean(of: Collection) -> bool:
    """Whether the ranges fit a motion so well, and so few are outliers, that gains may start which exclude no place."""
    fits = bool(of.triangle[-1, -1] ** 2 <= layout.LOOSEST_SCALE * of.count)
    return fits and of.refused <= layout.CLEAN_SHARE * of.count


def anywhere(square: float, p0: Float[Array, "13 13"], tried: int) -> tuple[Array, Array]:
    """x̂ and P that exclude no place at a distance (square: m², its mean), and no speed below 10^tried times P(0)'s."""
    speed, gravity = np.sqrt(p0[7, 7]) * 10.0**tried, np.sqrt(p0[10, 10])
    x = np.zeros(model.STATES)
    x[0] = square / 2
    xi = [square, np.sqrt(square) * speed, speed**2 + np.sqrt(square) * gravity, 3 * speed * gravity]
    return x, np.diag(np.square(xi + 3 * [np.sqrt(square)] + 3 * [speed] + 3 * [gravity]))


def solved(of: Collection) -> tuple[Array, Array, float] | None:
    """x̂ (axes at t0), P without its last term, and the misfit; None if the ranges do not determine the position."""
    R, right = of.triangle[: model.STATES, : model.STATES], of.triangle[: model.STATES, -1]
    diagonal = np.abs(np.diag(R))
    if not (diagonal > layout.RANK_TOLERANCE * diagonal.max()).all():
        return None
    root, misfit = of.transition @ np.linalg.inv(R), _misfit(of)
    spread = misfit * np.sum(root[model.POSITION] ** 2)
    if not spread < layout.KNOWN_SHARE**2 * of.mean_square:
        return None
    return root @ right + of.response, 2 * (1 + of.weight) * misfit * (root @ root.T), misfit


def contradict(x: Float[Array, "13"], P: Float[Array, "13 13"], other: Array, other_P: Array) -> bool:
    """Whether two positions differ by more than both covariances allow."""
    e = (other - x)[model.POSITION]
    both = (P + other_P)[model.POSITION, model.POSITION]
    return not e @ np.linalg.solve(both, e) <= layout.CONTRADICTION


def watch(scale: float) -> Watch:
    """A window that begins. scale: the misfit of the collection that the gains started from, or what an alarm made."""
    return Watch(count=0, total=0.0, size=0.0, scale=min(scale, layout.LOOSEST_SCALE))


def size(of: Watch) -> float:
    """The mean square of a window's innovations, in units of the variances that the observer expects."""
    return of.scale * of.size / of.count


def watched(of: Watch, innovation: float, variance: float) -> tuple[Watch, bool]:
    """The window with one more innovation, and whether that innovation is an outlier."""
    square = innovation**2 / (variance * of.scale)
    outlier = not square <= layout.GATE
    total, size = (layout.OUTLIER, layout.GATE) if outlier else (square, square)
    return replace(of, count=of.count + 1, total=of.total + total, size=of.size + size), outlier
