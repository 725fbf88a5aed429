"""A record averaged over blocks of ten milliseconds, and vectors that are fixed in inertia, in axes turned by the gyro.

A magnetic field, or gravity on the average, is constant in axes turned by the gyro, R' = R [ω]×, if gyro and sensor
have the same axes and units. Windows of a few seconds bound what the gyro's bias adds.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav import motion, so3
from rangenav.formats.recorded_flight import Flight
from rangenav.results import result

RATE = 100.0
"""Hz, of the blocks; a slower record has a block for each sample."""
WINDOW = 5.0
"""s. A gyro bias of 0.01 rad/s turns the axes by 3° in it."""
LEAST = 4
"""Blocks of a window on the average."""
KEPT = 4


@result
class Blocks:
    """A record averaged over blocks."""

    time: Float[Array, "b"]
    """s, the mean stamp of each block."""
    start: Int[Array, "b"]
    """The first sample of each block."""
    before: Float[Array, "b"]
    """The share of the block's turn before its mean stamp."""
    turn: Float[Array, "b 3"]
    """rad, ∫ω over the block."""
    accel: Float[Array, "b 3"]
    """m/s²"""
    mag: Float[Array, "b 3"] | None
    """NaN without a sample."""

    def turned(self, scale: float = 1.0) -> Float[Array, "b 3 3"]:
        """The rotation of the body in its first axes at each mean stamp, by the gyro times a factor."""
        turn = scale * self.turn
        ends = motion.cumulative_product(np.concatenate([np.eye(3)[None], so3.exp(turn[:-1])]))
        return ends @ so3.exp(self.before[:, None] * turn)

    def windows(self, length: float = WINDOW) -> tuple[Int[Array, "b"], int]:
        """The window of each block, of about `length` seconds, and the number of windows."""
        span = self.time[-1] - self.time[0]
        count = max(1, min(int(span // length), len(self.time) // LEAST))
        number = np.floor((self.time - self.time[0]) / (span / count or 1.0)).astype(int)
        return np.minimum(number, count - 1), count


@lru_cache(maxsize=KEPT)
def blocks(flight: Flight) -> Blocks:
    """The record in blocks."""
    step = float(np.median(np.diff(flight.time)))
    stride = max(1, min(round(1 / (RATE * step)), len(flight.time) // LEAST))
    start = np.arange(0, len(flight.time), stride)
    count = np.diff(np.append(start, len(flight.time)))
    h = np.diff(flight.time)[:, None]
    turned = np.concatenate([np.zeros((1, 3)), np.cumsum(h * (flight.gyro[1:] + flight.gyro[:-1]) / 2, axis=0)])
    ends = np.minimum(start + stride, len(flight.time) - 1)
    mag = flight.mag
    return Blocks(
        time=np.add.reduceat(flight.time, start) / count,
        start=start,
        before=(count - 1) / (2 * count),
        turn=turned[ends] - turned[start],
        accel=np.add.reduceat(flight.accel, start) / count[:, None],
        mag=None if mag is None else _mean(mag, start),
    )


def _mean(values: Float[Array, "n 3"], start: Int[Array, "b"]) -> Float[Array, "b 3"]:
    """The mean of the known samples of each block; NaN without one."""
    known = np.asarray(np.isfinite(values).all(axis=-1))
    number = np.add.reduceat(known.astype(float), start)[:, None]
    total = np.add.reduceat(np.where(known[:, None], values, 0.0), start)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)


def means(values: Float[Array, "b *k"], window: Int[Array, "b"], count: int) -> Float[Array, "w *k"]:
    """The mean of the values in each window; zero for an empty one."""
    total = np.zeros((count, *values.shape[1:]))
    np.add.at(total, window, values)
    number = np.maximum(np.bincount(window, minlength=count), 1)
    return total / number.reshape(-1, *([1] * (values.ndim - 1)))


def centred(values: Float[Array, "b *k"], window: Int[Array, "b"], count: int) -> Float[Array, "b *k"]:
    """The values less their mean in each window."""
    return values - means(values, window, count)[window]


def rms(values: Float[Array, "b 3"]) -> float:
    """The root mean square of the lengths of vectors."""
    return float(np.sqrt(np.mean(np.sum(values**2, axis=-1))))
