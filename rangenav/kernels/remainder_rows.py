"""R of the weighted columns of many windows, several side by side: those of `gramian_rank`, made where they are used.

    [L₀ … L₃ | P, uP + k₄L₄, u²P + d₄L₄ + d₅L₅],  P = p − Σ₀³ Cₖ Lₖ,  with weights √w

The rows of a window come in blocks. Each column of [R; block] is reflected to R's diagonal, which leaves R's other rows
alone: no row of zeros is ever multiplied.
"""

import numpy as np

from rangenav.kernels.householder import reflector
from rangenav.kernels.jit import kernel
from rangenav.kernels.vectors import at

LANES = 8
"""Windows side by side: R and a block of eight stay in the first cache."""
HEIGHT = 16
"""Rows of a block."""
N, CUBIC = 13, 4
POLYNOMIALS = 6
PER_WINDOW = 21
"""Numbers of a window: C of each polynomial and axis, then k₄, d₄ and d₅ of each axis."""
BLOCK_AT = N * N
ROW_AT = BLOCK_AT + N * HEIGHT
WINDOW_AT = ROW_AT + POLYNOMIALS + 4
LENGTH = WINDOW_AT + PER_WINDOW


@kernel
def run(curved, polynomials, root, known, triangles, inverses):
    """triangles[k] ← R of window k; inverses[k] ← that of its last 9 rows and columns, not finite where there is none.

    curved (w, 3, k): the path at the samples, m. polynomials (v, 6, k): L₀ … L₅ there. root (v, k): √w. v is 1 or w.
    known (w, 21): see PER_WINDOW.
    """
    w = np.empty(LANES * LENGTH)
    R, block, row = at(w, 0, LANES), at(w, LANES * BLOCK_AT, LANES), at(w, LANES * ROW_AT, LANES)
    window, nothing = at(w, LANES * WINDOW_AT, LANES), np.zeros(LANES)
    zero = at(nothing, 0, LANES)[0]
    for first in range(0, len(curved), LANES):
        count = min(LANES, len(curved) - first)
        for i in range(N * N):
            R[i] = zero
        for c in range(LANES):
            for i in range(PER_WINDOW):
                w[LANES * (WINDOW_AT + i) + c] = known[first + min(c, count - 1), i]
        for begin in range(0, curved.shape[2], HEIGHT):
            height = min(HEIGHT, curved.shape[2] - begin)
            for i in range(height):
                _take(w, curved, polynomials, root, first, count, begin + i)
                _columns(row, window, block, i)
            _absorb(R, block, height)
        _write(w, 0, 0, triangles, first, count)
        invert(R, block, N)
        _write(w, BLOCK_AT, CUBIC, inverses, first, count)


@kernel
def _take(w, curved, polynomials, root, first, count, k):
    """The numbers of sample k of each window."""
    for c in range(LANES):
        own = first + min(c, count - 1)
        v = min(own, len(polynomials) - 1)
        place = LANES * ROW_AT + c
        for i in range(POLYNOMIALS):
            w[place + LANES * i] = polynomials[v, i, k]
        for axis in range(3):
            w[place + LANES * (POLYNOMIALS + axis)] = curved[own, axis, k]
        w[place + LANES * (POLYNOMIALS + 3)] = root[min(own, len(root) - 1), k]


@kernel
def _columns(row, window, block, i):
    """Row i of the block."""
    weight, u = row[POLYNOMIALS + 3], row[1]
    for j in range(CUBIC):
        block[N * i + j] = row[j] * weight
    for axis in range(3):
        P = row[POLYNOMIALS + axis]
        for j in range(CUBIC):
            P -= window[3 * j + axis] * row[j]
        k4, d4, d5 = window[12 + axis], window[15 + axis], window[18 + axis]
        block[N * i + 4 + axis] = P * weight
        block[N * i + 7 + axis] = (u * P + k4 * row[4]) * weight
        block[N * i + 10 + axis] = (u * u * P + (d4 * row[4] + d5 * row[5])) * weight


@kernel
def _absorb(R, block, height):
    """R ← R of [R; block]."""
    for j in range(N):
        square = block[j] * block[j]
        for i in range(1, height):
            square += block[N * i + j] * block[N * i + j]
        first, share, _, R[(N + 1) * j] = reflector(R[(N + 1) * j], square)
        for k in range(j + 1, N):
            dot = first * R[N * j + k]
            for i in range(height):
                dot += block[N * i + j] * block[N * i + k]
            dot *= share
            R[N * j + k] -= first * dot
            for i in range(height):
                block[N * i + k] -= block[N * i + j] * dot


@kernel
def invert(R, inverse, n):
    """The inverse of a triangle of n rows, each by those below it."""
    for i in range(n - 1, -1, -1):
        reciprocal = 1 / R[(n + 1) * i]
        for j in range(i):
            inverse[n * i + j] = reciprocal * 0.0
        inverse[(n + 1) * i] = reciprocal
        for j in range(i + 1, n):
            total = R[n * i + i + 1] * inverse[n * (i + 1) + j]
            for k in range(i + 2, j + 1):
                total += R[n * i + k] * inverse[n * k + j]
            inverse[n * i + j] = -total * reciprocal


@kernel
def _write(w, place, skipped, out, first, count):
    """The matrices at a place of the work space, without their first rows and columns."""
    for c in range(count):
        for i in range(N - skipped):
            for j in range(N - skipped):
                out[first + c, i, j] = w[LANES * (place + N * (i + skipped) + j + skipped) + c]
