"""Curves as a browser can draw them: fewer points that keep every extreme, and axes in whole decades. Pure functions.

A browser plot cannot draw NaN, ±∞ or, on a log axis, zero. Such values are moved just outside the axes, never inside.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.number_format import power_of_ten, significant

BUCKETS = 200
"""Each bucket gives two points: about one point for every pixel across a plot."""
MAX_LABELS = 6
OUTSIDE = 10.0
"""Factor beyond the last decade to which values outside a log axis are moved."""
FIXED_EXPONENTS = range(-2, 4)
"""Decades that are written in full (0.01 … 1000); the others are written as powers of ten."""
Range = tuple[float, float]


def decimate(
    time: Float[Array, "n"], values: Float[Array, "n k"], buckets: int = BUCKETS
) -> tuple[Float[Array, "m"], Float[Array, "m k"]]:
    """At most two points for each bucket: the least and the greatest value of each column, in their order.

    All columns share one time axis, so an extreme may move within its bucket, which is about one pixel wide.
    """
    size = -(-len(time) // buckets)
    if size <= 2:
        return time, values
    count = -(-len(time) // size)
    padded = np.concatenate([values, np.repeat(values[-1:], count * size - len(time), axis=0)])
    blocks = padded.reshape(count, size, -1)
    least, greatest = blocks.argmin(axis=1), blocks.argmax(axis=1)
    order = np.stack([np.minimum(least, greatest), np.maximum(least, greatest)], axis=1)
    ends = np.minimum(np.arange(count)[:, None] * size + [0, size - 1], len(time) - 1)
    points = np.take_along_axis(blocks, order, axis=1).reshape(2 * count, -1)
    later = np.diff(time[ends].ravel(), prepend=-np.inf) > 0
    return time[ends].ravel()[later], points[later]


def end_at_first_nan(values: Float[Array, "n k"]) -> Float[Array, "n k"]:
    """Each column becomes NaN from its first NaN on: a plot would draw a line across a gap, but ends a curve there."""
    return np.where(np.maximum.accumulate(np.isnan(values), axis=0), np.nan, values)


def onto_log_axis(values: Float[Array, "n k"], axis: Range) -> Float[Array, "n k"]:
    """Values for a log axis: zero and below are moved under its lower end, +∞ above its upper end."""
    return np.clip(values, axis[0] / OUTSIDE, axis[1] * OUTSIDE)


def decades(values: Float[Array, "..."], *, low_quantile: float = 0.0) -> Range:
    """The whole decades that hold the positive finite values, but for a share `low_quantile` of the smallest."""
    positive = values[np.isfinite(values) & (values > 0)]
    if not len(positive):
        return 1e-3, 1.0
    low = math.floor(math.log10(_at_least(positive, low_quantile)))
    high = math.ceil(math.log10(float(positive.max())))
    return 10.0**low, 10.0 ** max(high, low + 1)


def _at_least(values: Float[Array, "n"], share: float) -> float:
    """The value that this share of the values does not exceed: a third of the time that np.quantile takes."""
    k = int(share * (len(values) - 1))
    return float(np.partition(values, k)[k])


def even_range(values: Float[Array, "..."], *, symmetric: bool) -> Range:
    """A linear range with a round end: symmetric about zero, or from zero up."""
    finite = np.abs(values[np.isfinite(values)])
    largest = float(finite.max()) if len(finite) else 0.0
    if largest < 1e-12:
        return (-1.0, 1.0) if symmetric else (0.0, 1.0)
    power = 10.0 ** math.floor(math.log10(largest))
    top = next(step * power for step in (1, 1.5, 2, 3, 5, 7, 10) if largest <= step * power * (1 + 1e-9))
    return (-top, top) if symmetric else (0.0, top)


def even_ticks(axis: Range) -> tuple[list[float], list[str]]:
    """Positions and labels of a linear axis: its ends and the middles between them and zero."""
    low, high = axis
    positions = [low, low / 2, 0.0, high / 2, high] if low < 0 else [0.0, high / 2, high]
    return positions, [significant(position) for position in positions]


def decade_ticks(axis: Range) -> tuple[list[float], list[str]]:
    """Positions and labels of at most six decades of a log axis."""
    low, high = (round(math.log10(end)) for end in axis)
    stride = max(1, math.ceil((high - low) / (MAX_LABELS - 1)))
    exponents = range(math.ceil(low / stride) * stride, high + 1, stride)
    return [10.0**exponent for exponent in exponents], [decade_label(exponent) for exponent in exponents]


def decade_label(exponent: int) -> str:
    """0.01, 1, 100 or 10⁻⁶."""
    return f"{10.0**exponent:g}" if exponent in FIXED_EXPONENTS else power_of_ten(exponent)
