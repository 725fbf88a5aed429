"""The spline of odd degree 2m − 1 through timed points: among all curves through them the one of least ∫|p⁽ᵐ⁾|².

It starts and ends at rest, or is free there, or closes. One banded solve is exact.
"""

import math
from functools import lru_cache
from typing import Literal

import numpy as np
import scipy
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.results import result
from rangenav.signals import piecewise
from rangenav.signals.piecewise import Pieces

UNEVEN = "no smooth curve can be found through these waypoints: their times are too uneven"
MISS = 1e-7
"""Largest distance of a curve from its points, as a share of their spread; a larger one shows uneven times."""


def fitted(
    time: Float[Array, "n"], value: Float[Array, "n 3"], *, degree: int, ends: Literal["rest", "free", "closed"]
) -> Pieces:
    """The spline of odd degree through (time, value): closed, or with half its derivatives zero at either end.

    At rest these are the lower ones, up to (degree − 1)/2. At free ends they are the others, below the degree.
    """
    time, value = np.asarray(time, dtype=float), np.asarray(value, dtype=float)
    shape = _fit(time.tobytes(), (value - value[0]).tobytes(), degree, ends)
    coefficients = shape.coefficients.copy()
    coefficients[0] += value[0]  # left out of the fit: a far-off place costs no digits, and standing still is exact
    curve = piecewise.pieces(time, coefficients, repeats=ends == "closed")
    spread = float(np.ptp(value, axis=0).max())
    miss = max(shape.miss, float(np.abs(piecewise.jumps(curve, range(1))).max()))
    if not miss <= MISS * spread + 1e-12 * float(np.abs(value).max()):
        raise ValueError(UNEVEN)
    return curve


@result
class _Fit:
    """A spline through points relative to the first one."""

    coefficients: Float[Array, "d m 3"]
    miss: float
    """How far it passes from its points."""


@lru_cache(maxsize=4)
def _fit(times: bytes, values: bytes, degree: int, ends: Literal["rest", "free", "closed"]) -> _Fit:
    """The same curve elsewhere is not fitted again: an analysis moves each curve to begin at 0."""
    time, value = np.frombuffer(times), np.frombuffer(values).reshape(-1, 3)
    scale = (time[-1] - time[0]) / (len(time) - 1)
    s = (time - time[0]) / scale  # unit gaps: the same condition number whatever the seconds
    half = (degree + 1) // 2
    zero = [(order, np.zeros(3)) for order in (range(half, degree) if ends == "free" else range(1, half))]
    try:
        if ends == "closed":
            spline = _closed(s, value, degree)
        else:
            spline = scipy.interpolate.make_interp_spline(s, value, k=degree, bc_type=(zero, zero))
    except (ValueError, np.linalg.LinAlgError):
        raise ValueError(UNEVEN) from None
    coefficients = np.stack([spline(s[:-1], nu=j) / (math.factorial(j) * scale**j) for j in range(degree + 1)])
    return _Fit(coefficients=coefficients, miss=float(np.abs(spline(s) - value).max()))


def _closed(s: Float[Array, "n"], value: Float[Array, "n 3"], degree: int) -> "scipy.interpolate.BSpline":
    """The periodic spline whose last point is its first, by one banded solve.

    Its matrix has a band and two corners; with the unknowns in the order first, last, second, last but one … the
    corners join the band, which becomes twice as wide. scipy's own periodic spline solves for the corners apart, with
    threads that wait for each other: 0.5 ms alone, 3 to 11 ms on two cores with other work, and this 0.2 ms.
    """
    count, half = len(s) - 1, (degree - 1) // 2
    knots, band, folded = _closed_band(s.tobytes(), degree)
    right = np.empty((count, 3))
    right[folded] = value[:-1]
    width = len(band) // 2
    solution = scipy.linalg.solve_banded((width, width), band, right)[folded]
    return scipy.interpolate.BSpline(knots, solution[(np.arange(count + degree) - half) % count], degree)


@lru_cache(maxsize=4)
def _closed_band(times: bytes, degree: int) -> tuple[Array, Array, Array]:
    """The knots, the band of the matrix, and the place of each unknown in it: points that move keep all three."""
    s = np.frombuffer(times)
    count, half = len(s) - 1, (degree - 1) // 2
    around = np.arange(-degree, count + degree + 1)
    knots = s[around % count] + (s[-1] - s[0]) * (around // count)
    matrix = scipy.interpolate.BSpline.design_matrix(s[:-1], knots, degree)
    row = np.repeat(np.arange(count), degree + 1)
    column = (matrix.indices - half) % count  # the splines that reach a point are those about its own number
    k = np.arange(count)
    folded = np.where(2 * k < count, 2 * k, 2 * (count - k) - 1)
    row, column = folded[row], folded[column]
    width = int(np.abs(row - column).max())
    band = np.zeros((2 * width + 1, count))
    np.add.at(band, (width + row - column, column), matrix.data)
    return knots, band, folded
