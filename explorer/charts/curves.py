"""What may be sent to a plot: fewer points that keep every extreme, and axes in whole decades. Pure functions.

A browser plot cannot draw NaN, ±∞ or, on a log axis, zero: those are moved just outside the axes here, never into them.
"""

import math

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

BUCKETS = 200
"""Two points each: about one point for every pixel of a plot column."""
MAX_LABELS = 6
OUTSIDE = 10.0
"""How far beyond the last decade a value is put that has no place on a log axis."""
PLAIN_EXPONENTS = range(-2, 4)
"""Decades written out (0.01 … 1000); the others as powers of ten."""
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
Range = tuple[float, float]


def decimate(
    time: Float[Array, "n"], values: Float[Array, "n k"], buckets: int = BUCKETS
) -> tuple[Float[Array, "m"], Float[Array, "m k"]]:
    """At most two points for each bucket: the least and the greatest value of each column, in the order they came.

    All columns of a plot share one time axis, so an extreme may move within its bucket, which is one pixel wide.
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
    keep = np.diff(time[ends].ravel(), prepend=-np.inf) > 0
    return time[ends].ravel()[keep], points[keep]


def end_at_first_nan(values: Float[Array, "n k"]) -> Float[Array, "n k"]:
    """Each column is NaN from its first NaN on: a plot ends a curve there, but would bridge a gap by a line."""
    return np.where(np.maximum.accumulate(np.isnan(values), axis=0), np.nan, values)


def onto_log_axis(values: Float[Array, "n k"], axis: Range) -> Float[Array, "n k"]:
    """Values for a log axis: zero and below leave it at the bottom, +∞ at the top."""
    return np.clip(values, axis[0] / OUTSIDE, axis[1] * OUTSIDE)


def decades(values: Float[Array, "..."], *, low_quantile: float = 0.0) -> Range:
    """The whole decades that hold the positive finite values; a share of the smallest may fall below."""
    kept = values[np.isfinite(values) & (values > 0)]
    if not len(kept):
        return 1e-3, 1.0
    low = math.floor(math.log10(float(np.quantile(kept, low_quantile))))
    high = math.ceil(math.log10(float(kept.max())))
    return 10.0**low, 10.0 ** max(high, low + 1)


def even_range(values: Float[Array, "..."], *, symmetric: bool) -> Range:
    """A round linear range, 1, 2 or 5 times a power of ten: about zero, or from zero up."""
    finite = np.abs(values[np.isfinite(values)])
    largest = float(finite.max()) if len(finite) else 0.0
    if largest < 1e-12:
        return (-1.0, 1.0) if symmetric else (0.0, 1.0)
    power = 10.0 ** math.floor(math.log10(largest))
    top = next(step * power for step in (1, 1.5, 2, 3, 5, 7, 10) if largest <= step * power * (1 + 1e-9))
    return (-top, top) if symmetric else (0.0, top)


def even_ticks(axis: Range) -> tuple[list[float], list[str]]:
    """Both ends of a linear axis, and what halves it."""
    low, high = axis
    places = [low, low / 2, 0.0, high / 2, high] if low < 0 else [0.0, high / 2, high]
    return places, [number(place) for place in places]


def decade_ticks(axis: Range) -> tuple[list[float], list[str]]:
    """Positions and labels of at most six decades of a log axis."""
    low, high = (round(math.log10(end)) for end in axis)
    stride = max(1, math.ceil((high - low) / (MAX_LABELS - 1)))
    exponents = range(math.ceil(low / stride) * stride, high + 1, stride)
    return [10.0**exponent for exponent in exponents], [decade_label(exponent) for exponent in exponents]


def decade_label(exponent: int) -> str:
    """0.01, 1, 100 or 10⁻⁶."""
    return f"{10.0**exponent:g}" if exponent in PLAIN_EXPONENTS else f"10{str(exponent).translate(SUPERSCRIPTS)}"


def number(value: float) -> str:
    """Three digits: 0.0123, 12.3, 1.23e-6; a dash for NaN."""
    if math.isnan(value):
        return "–"
    if value == 0 or 1e-3 <= abs(value) < 1e4:
        return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"
