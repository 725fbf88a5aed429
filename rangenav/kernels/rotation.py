"""Small rotations as tuples of nine numbers, row by row: they live in registers and never allocate."""

import math

import numpy as np

from rangenav.kernels.jit import inlined, kernel
from rangenav.kernels.vectors import choose, everywhere, mostly

SMALL_SQUARE = 0.06
"""rad²; below it sin θ/θ and (1 − cos θ)/θ² are series whose first dropped term is under 1e-17."""
SIN = tuple((-1) ** k / math.factorial(2 * k + 1) for k in range(1, 6))
COS = tuple((-1) ** k / math.factorial(2 * k + 2) for k in range(1, 6))
"""Their coefficients from the second on: products, since a division takes as long as ten of them."""
ATAN = tuple((-1) ** k / (2 * k + 1) for k in range(1, 12))
ARCS = (math.tan(math.pi / 16), math.tan(math.pi / 8), math.tan(3 * math.pi / 16))
"""Of arctan; the numbers where one centre ends and the next begins, and the centre between them."""


@inlined
def exp(x, y, z):
    """exp([w]x) of w = (x, y, z), by Rodrigues' formula."""
    s = x * x + y * y + z * z
    s2, small = s * s, s < SMALL_SQUARE
    a = 1 + s * ((SIN[0] + s * SIN[1]) + s2 * ((SIN[2] + s * SIN[3]) + s2 * SIN[4]))
    b = 0.5 + s * ((COS[0] + s * COS[1]) + s2 * ((COS[2] + s * COS[3]) + s2 * COS[4]))
    if not mostly(everywhere(small)):
        a, b = _of_large(s, small, a, b)
    return _rodrigues(x, y, z, a, b)


@kernel
def _of_large(s, small, a, b):
    angle = np.sqrt(s)
    half = np.sin(angle / 2)
    return choose(small, a, np.sin(angle) / angle), choose(small, b, 2 * half * half / s)


@inlined
def _rodrigues(x, y, z, a, b):
    xx, yy, zz, bx, by, ax, ay, az = x * x, y * y, z * z, b * x, b * y, a * x, a * y, a * z
    return (
        1 - b * (yy + zz), bx * y - az, bx * z + ay,
        bx * y + az, 1 - b * (xx + zz), by * z - ax,
        bx * z - ay, by * z + ax, 1 - b * (xx + yy),
    )  # fmt: skip


@inlined
def angle(r, e):
    """The angle of r eᵀ (rad), accurate at both ends."""
    return angle_at(sine_square(r, e), cosine(r, e))


@inlined
def cosine(r, e):
    """2 cos θ of the angle θ of r eᵀ."""
    trace = r[0] * e[0] + r[1] * e[1] + r[2] * e[2] + r[3] * e[3] + r[4] * e[4] + r[5] * e[5]
    trace += r[6] * e[6] + r[7] * e[7] + r[8] * e[8]
    return trace - 1


@inlined
def sine_square(r, e):
    """(2 sin θ)² of the same angle."""
    x = r[6] * e[3] + r[7] * e[4] + r[8] * e[5] - (r[3] * e[6] + r[4] * e[7] + r[5] * e[8])
    y = r[0] * e[6] + r[1] * e[7] + r[2] * e[8] - (r[6] * e[0] + r[7] * e[1] + r[8] * e[2])
    z = r[3] * e[0] + r[4] * e[1] + r[5] * e[2] - (r[0] * e[3] + r[1] * e[4] + r[2] * e[5])
    return x * x + y * y + z * z


@inlined
def angle_at(square, cosine):
    """The angle (rad) of a point at (2 cos θ, 2 sin θ), from `sine_square` and `cosine`.

    tan ½θ, or cot ½θ beyond a right angle, is t ≤ 1; arctan t is that of the nearest of 0, tan π/8 and 1 and a series,
    whose first dropped term is under 1e-17. Unlike numpy's arctan2 it becomes vector code.
    """
    far = 1 + (square + cosine * cosine) / 4 + abs(cosine)  # a root of nearly 4, by one Newton step, and |2 cos θ|
    near = np.sqrt(square)
    centre = choose(near < ARCS[0] * far, 0.0, choose(near < ARCS[2] * far, ARCS[1], 1.0))
    arc = choose(near < ARCS[0] * far, 0.0, choose(near < ARCS[2] * far, math.pi / 8, math.pi / 4))
    u = (near - centre * far) / (far + centre * near)
    s = u * u
    series = ATAN[8] + s * (ATAN[9] + s * ATAN[10])
    series = ATAN[4] + s * (ATAN[5] + s * (ATAN[6] + s * (ATAN[7] + s * series)))
    series = ATAN[0] + s * (ATAN[1] + s * (ATAN[2] + s * (ATAN[3] + s * series)))
    theta = 2 * (arc + (u + u * (s * series)))
    return choose(cosine < 0, math.pi - theta, theta)


@inlined
def row(matrix, k):
    """Row k of an n × 3 array as a tuple."""
    return matrix[k, 0], matrix[k, 1], matrix[k, 2]


@kernel
def load(matrix):
    """The tuple of a 3 × 3 array."""
    return (
        matrix[0, 0], matrix[0, 1], matrix[0, 2],
        matrix[1, 0], matrix[1, 1], matrix[1, 2],
        matrix[2, 0], matrix[2, 1], matrix[2, 2],
    )  # fmt: skip


@kernel
def store(r, matrix):
    """Write a tuple into a 3 × 3 array."""
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = r[0], r[1], r[2]
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = r[3], r[4], r[5]
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = r[6], r[7], r[8]


@kernel
def load_at(flat, at):
    """The tuple of nine numbers that stand in a flat array from `at` on."""
    return (
        flat[at], flat[at + 1], flat[at + 2],
        flat[at + 3], flat[at + 4], flat[at + 5],
        flat[at + 6], flat[at + 7], flat[at + 8],
    )  # fmt: skip


@kernel
def store_at(r, flat, at):
    """Write a tuple into a flat array from `at` on."""
    flat[at], flat[at + 1], flat[at + 2] = r[0], r[1], r[2]
    flat[at + 3], flat[at + 4], flat[at + 5] = r[3], r[4], r[5]
    flat[at + 6], flat[at + 7], flat[at + 8] = r[6], r[7], r[8]


@inlined
def multiply(r, s):
    """r s."""
    return (
        r[0] * s[0] + r[1] * s[3] + r[2] * s[6],
        r[0] * s[1] + r[1] * s[4] + r[2] * s[7],
        r[0] * s[2] + r[1] * s[5] + r[2] * s[8],
        r[3] * s[0] + r[4] * s[3] + r[5] * s[6],
        r[3] * s[1] + r[4] * s[4] + r[5] * s[7],
        r[3] * s[2] + r[4] * s[5] + r[5] * s[8],
        r[6] * s[0] + r[7] * s[3] + r[8] * s[6],
        r[6] * s[1] + r[7] * s[4] + r[8] * s[7],
        r[6] * s[2] + r[7] * s[5] + r[8] * s[8],
    )  # fmt: skip


@inlined
def apply(r, x, y, z):
    """r u."""
    return r[0] * x + r[1] * y + r[2] * z, r[3] * x + r[4] * y + r[5] * z, r[6] * x + r[7] * y + r[8] * z


@inlined
def apply_inverse(r, x, y, z):
    """rᵀ u."""
    return r[0] * x + r[3] * y + r[6] * z, r[1] * x + r[4] * y + r[7] * z, r[2] * x + r[5] * y + r[8] * z


@inlined
def orthonormal(r):
    """One Newton step to the nearest rotation, r(3I − rᵀr)/2: squares the drift that rounding left."""
    xx = (1 - r[0] * r[0] - r[3] * r[3] - r[6] * r[6]) / 2
    yy = (1 - r[1] * r[1] - r[4] * r[4] - r[7] * r[7]) / 2
    zz = (1 - r[2] * r[2] - r[5] * r[5] - r[8] * r[8]) / 2
    xy = -(r[0] * r[1] + r[3] * r[4] + r[6] * r[7]) / 2
    xz = -(r[0] * r[2] + r[3] * r[5] + r[6] * r[8]) / 2
    yz = -(r[1] * r[2] + r[4] * r[5] + r[7] * r[8]) / 2
    return (
        r[0] + r[0] * xx + r[1] * xy + r[2] * xz,
        r[1] + r[0] * xy + r[1] * yy + r[2] * yz,
        r[2] + r[0] * xz + r[1] * yz + r[2] * zz,
        r[3] + r[3] * xx + r[4] * xy + r[5] * xz,
        r[4] + r[3] * xy + r[4] * yy + r[5] * yz,
        r[5] + r[3] * xz + r[4] * yz + r[5] * zz,
        r[6] + r[6] * xx + r[7] * xy + r[8] * xz,
        r[7] + r[6] * xy + r[7] * yy + r[8] * yz,
        r[8] + r[6] * xz + r[7] * yz + r[8] * zz,
    )  # fmt: skip
