"""Singular values of the weighted rows H of many windows and of their inverses, several side by side, from triangles.

H U = R M U and (H U)⁻¹ = U⁻¹ M⁻¹ R⁻¹, with R and M of `gramian_rank` and units U
"""

import numpy as np

from rangenav.kernels.jit import kernel
from rangenav.kernels.remainder_rows import CUBIC, invert
from rangenav.kernels.singular_values import LANES, MOST, WORK, decompose
from rangenav.kernels.vectors import at

R_AT, M_AT, K_AT = WORK, WORK + MOST * MOST, WORK + 2 * MOST * MOST
LENGTH = K_AT + 3 * CUBIC


@kernel
def run(triangles, departure, constant, of_departure, units, inverted, values, found):
    """values[k] ← singular values of H U of window k, or of its inverse, descending; found[k] ← whether there are any.

    triangles (w, 13, 13): R. departure (w, 12): K. constant (13, 13), of_departure (12, 36): of M, or of M⁻¹. units
    (13): U.
    """
    n, w = len(units), np.empty(LANES * LENGTH)
    A, R, M, K = at(w, 0, LANES), at(w, LANES * R_AT, LANES), at(w, LANES * M_AT, LANES), at(w, LANES * K_AT, LANES)
    for first in range(0, len(triangles), LANES):
        count = min(LANES, len(triangles) - first)
        for c in range(LANES):
            own = first + min(c, count - 1)
            for i in range(n):
                for j in range(n):
                    w[LANES * (R_AT + n * i + j) + c] = triangles[own, i, j]
            for i in range(3 * CUBIC):
                w[LANES * (K_AT + i) + c] = departure[own, i]
        if inverted:
            invert(R, M, n)
            for i in range(n * n):
                R[i] = M[i]
        _transformation(M, K, n, constant, of_departure)
        for i in range(n):
            for j in range(n):
                if inverted:
                    A[n * i + j] = _row_by_column(M, R, n, i, j) / units[i]
                else:
                    A[n * i + j] = _row_by_column(R, M, n, i, j) * units[j]
        decompose(w, n, first, count, values, found)


@kernel
def _transformation(M, K, n, constant, of_departure):
    """M or M⁻¹: the block of the polynomials by the unknowns is linear in K."""
    for i in range(n):
        for j in range(n):
            M[n * i + j] = K[0] * 0.0 + constant[i, j]
    for i in range(CUBIC):
        for j in range(n - CUBIC):
            total = K[0] * of_departure[0, (n - CUBIC) * i + j]
            for k in range(1, 3 * CUBIC):
                total += K[k] * of_departure[k, (n - CUBIC) * i + j]
            M[n * i + CUBIC + j] = total


@kernel
def _row_by_column(left, right, n, i, j):
    total = left[n * i] * right[j]
    for k in range(1, n):
        total += left[n * i + k] * right[n * k + j]
    return total
