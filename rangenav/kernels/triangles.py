"""Triangles R of rows that come one by one, and of two sets of rows together, by Givens rotations of R and a row h.

    ρ = √(R_ii² + h_i²),  c = R_ii/ρ,  s = h_i/ρ,     R_i ← cR_i + sh,  h ← ch − sR_i       for each i: h vanishes

A decomposition of a small matrix by LAPACK takes most of its time for the call; here all of them are one call.
"""

import math

import numpy as np

from rangenav.kernels.jit import kernel


@kernel
def add(R, h, first):
    """R of the rows of R and the row h, whose entries before `first` are 0, in place of R; h is lost."""
    for i in range(first, len(h)):
        rho = math.sqrt(R[i, i] * R[i, i] + h[i] * h[i])
        if rho > 0.0:
            c, s = R[i, i] / rho, h[i] / rho
            for j in range(i, len(h)):
                above, below = R[i, j], h[j]
                R[i, j] = c * above + s * below
                h[j] = c * below - s * above


@kernel
def grow(rows, size, grown):
    """R of none, of the first `size`, of the first 2·size … of p lists of rows (p, k, n), which are lost.

    `grown` (p, k/size + 1, n(n + 1)/2) takes the rows of each triangle from the diagonal on, one after the other.
    """
    n = rows.shape[2]
    R = np.empty((n, n))
    for p in range(len(rows)):
        R[:] = 0.0
        grown[p, 0] = 0.0
        for m in range(1, grown.shape[1]):
            for k in range((m - 1) * size, m * size):
                add(R, rows[p, k], 0)
            packed, at = grown[p, m], 0
            for i in range(n):
                for j in range(i, n):
                    packed[at] = R[i, j]
                    at += 1


@kernel
def join(one, i, other, j, own, joined):
    """R of the rows of one[own, i] and other[own, j], as `grow` gives them, for each of some own, i and j: `joined`
    (w, n, n)."""
    n = joined.shape[1]
    h = np.empty(n)
    for w in range(len(joined)):
        R, above, below, at = joined[w], one[own[w], i[w]], other[own[w], j[w]], 0
        for k in range(n):
            R[k, :k] = 0.0
            for column in range(k, n):
                R[k, column] = above[at]
                at += 1
        at = 0
        for k in range(n):
            for column in range(k, n):
                h[column] = below[at]
                at += 1
            add(R, h, k)


@kernel
def invert(R, inverse):
    """The inverses of upper triangles (w, n, n); not finite where one is singular."""
    n = R.shape[1]
    for w in range(len(R)):
        T, V = R[w], inverse[w]
        V[:] = 0.0
        for j in range(n):
            V[j, j] = 1.0 / T[j, j]
            for i in range(j - 1, -1, -1):
                total = 0.0
                for k in range(i + 1, j + 1):
                    total += T[i, k] * V[k, j]
                V[i, j] = -total / T[i, i]
