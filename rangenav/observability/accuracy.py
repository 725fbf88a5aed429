"""Predicted accuracy: how well a window of noisy ranges could tell position, velocity and gravity, without IMU noise.

y = ½d² has variance d²σ² + ½σ⁴, so the lifted information is Σ hᵀh/(d²σ² + ½σ⁴): the weighted least-squares
covariance. The nonlinear one, rows/(dσ), is a Cramér–Rao bound. Results are 1-σ as sqrt(trace) of each block.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.motion import World
from rangenav.observability import rows
from rangenav.observability.spectrum import LIFTED_TIME_POWERS, NONLINEAR_TIME_POWERS, RANK_TOLERANCE
from rangenav.signals import Signal

NULL_SHARE = 1e-6
"""A block whose share in every unseen direction is below this is determined although the whole state is not."""
NEAREST = 1e-9
"""m; at the anchor itself a range has no direction: its row is zero, and is divided by this instead of by nothing."""
Kind = Literal["lifted", "nonlinear"]
LIFTED_BLOCKS = (slice(4, 7), slice(7, 10), slice(10, 13))
NONLINEAR_BLOCKS = (slice(0, 3), slice(3, 6), slice(6, 9))


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """1-σ as sqrt(trace); NaN where the window does not determine the block."""

    position: float
    """m"""
    velocity: float
    """m/s"""
    gravity: float
    """m/s²"""


def predict(
    path: Signal,
    world: World,
    start: float,
    window: float,
    *,
    sigma: float,
    rate: float,
    kind: Kind,
    at: Literal["start", "end"],
    share: float = 1.0,
) -> Accuracy:
    """Accuracy at the start or the end of one window, from its ranges at `rate` (Hz) with noise sigma (m).

    Where only a share of them arrives, now this one and now that, it is the accuracy of the expected information.
    """
    tau = np.arange(int(window * rate + 1e-9) + 1) / rate
    if at == "end":
        start, tau = start + window, tau - window
    count = np.full(len(tau), share)
    values = sigmas(path, world, np.array([start]), tau, count, window, sigma=sigma, kind=kind)[0]
    return Accuracy(position=float(values[0]), velocity=float(values[1]), gravity=float(values[2]))


def end_sigmas(
    path: Signal,
    world: World,
    start: Float[Array, "w"],
    window: float,
    *,
    sigma: float,
    rate: float,
    kind: Kind,
    share: float = 1.0,
) -> Float[Array, "w 3"]:
    """Accuracy at the end of many windows. The sum over ranges is Euler–Maclaurin's: rate · ∫ and half of both ends.

    34 nodes instead of hundreds of ranges: the same as `predict` to a percent, to seven where the path passes within
    decimetres of the anchor and 1/d² has a peak narrower than the nodes. For curves; verdicts use `predict`.
    """
    nodes, weight = rows.nodes(path, start, window)
    tau = np.concatenate([[0.0], nodes, [window]])
    count = share * np.concatenate([[0.5], weight * (window * rate), [0.5]])
    return sigmas(path, world, start + window, tau - window, count, window, sigma=sigma, kind=kind)


def sigmas(
    path: Signal,
    world: World,
    reference: Float[Array, "w"],
    tau: Float[Array, "k"],
    count: Float[Array, "k"],
    window: float,
    *,
    sigma: float,
    kind: Kind,
) -> Float[Array, "w 3"]:
    """sqrt(trace) of the position, velocity and gravity blocks at each reference time; `count` ranges at each τ."""
    distance2 = np.sum((path(reference[:, None] + tau) - np.asarray(world.anchor)) ** 2, axis=-1)
    noise = sigma if sigma > 0 else 1.0  # without noise every determined block is exact: computed for 1 m, then zero
    if kind == "lifted":
        matrix, powers, blocks = rows.lifted(path, world.gravity, reference, tau), LIFTED_TIME_POWERS, LIFTED_BLOCKS
        variance = distance2 * noise**2 + noise**4 / 2
    else:
        matrix, powers, blocks = (
            rows.nonlinear(path, world.anchor, reference, tau),
            NONLINEAR_TIME_POWERS,
            NONLINEAR_BLOCKS,
        )
        variance = np.maximum(distance2, NEAREST**2) * noise**2
    weighted = matrix * np.sqrt(count / variance)[..., None]
    result = _block_sigmas(weighted, window ** -powers.astype(float), blocks)
    return result if sigma > 0 else result * 0.0


def _block_sigmas(weighted: Array, scale: Array, blocks: tuple[slice, ...]) -> Array:
    """Row norms of S V Σ⁻¹ over each block; NaN where the null space reaches into the block."""
    missing = max(0, weighted.shape[-1] - weighted.shape[-2])  # fewer ranges than unknowns: rows of zeros tell nothing
    weighted = np.pad(weighted, ((0, 0), (0, missing), (0, 0)))
    R = np.linalg.qr(weighted, mode="r") * scale
    _, singular, right = np.linalg.svd(R)
    seen = singular > RANK_TOLERANCE * singular[:, :1]
    inverse = np.where(seen, 1 / np.where(seen, singular, 1.0), 0.0)
    result = np.empty((len(weighted), len(blocks)))
    for j, block in enumerate(blocks):
        part = right[:, :, block]
        unseen = np.max(np.linalg.norm(part, axis=-1) * ~seen, axis=-1) > NULL_SHARE
        trace = np.sum((part * scale[block] * inverse[:, :, None]) ** 2, axis=(1, 2))
        result[:, j] = np.where(unseen, np.nan, np.sqrt(trace))
    return result
