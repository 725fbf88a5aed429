"""Small rotations in place: R ← R exp([w]x), kept orthogonal over any number of steps."""

import numpy as np

from rangenav.kernels.compiled import kernel

SMALL_SQUARE = 1e-4
"""rad²; below it sin θ/θ and (1 − cos θ)/θ² are series whose first dropped term is under 1e-20."""


@kernel
def exp(wx, wy, wz, out):
    """out ← exp([w]x), by Rodrigues' formula."""
    square = wx * wx + wy * wy + wz * wz
    if square < SMALL_SQUARE:
        a = 1 - square / 6 * (1 - square / 20 * (1 - square / 42))
        b = 0.5 - square / 24 * (1 - square / 30 * (1 - square / 56))
    else:
        angle = np.sqrt(square)
        half = np.sin(angle / 2)
        a = np.sin(angle) / angle
        b = 2 * half * half / square
    out[0, 0] = 1 - b * (wy * wy + wz * wz)
    out[1, 1] = 1 - b * (wx * wx + wz * wz)
    out[2, 2] = 1 - b * (wx * wx + wy * wy)
    out[0, 1], out[1, 0] = b * wx * wy - a * wz, b * wx * wy + a * wz
    out[0, 2], out[2, 0] = b * wx * wz + a * wy, b * wx * wz - a * wy
    out[1, 2], out[2, 1] = b * wy * wz - a * wx, b * wy * wz + a * wx


@kernel
def turn(rotation, increment):
    """rotation ← rotation · increment."""
    for i in range(3):
        a, b, c = rotation[i, 0], rotation[i, 1], rotation[i, 2]
        for j in range(3):
            rotation[i, j] = a * increment[0, j] + b * increment[1, j] + c * increment[2, j]


@kernel
def orthonormalise(rotation):
    """One Newton step to the nearest rotation, R ← R(3I − RᵀR)/2: squares the drift that rounding left."""
    xx = yy = zz = xy = xz = yz = 0.0
    for i in range(3):
        a, b, c = rotation[i, 0], rotation[i, 1], rotation[i, 2]
        xx += a * a
        yy += b * b
        zz += c * c
        xy += a * b
        xz += a * c
        yz += b * c
    for i in range(3):
        a, b, c = rotation[i, 0], rotation[i, 1], rotation[i, 2]
        rotation[i, 0] = a + (a - a * xx - b * xy - c * xz) / 2
        rotation[i, 1] = b + (b - a * xy - b * yy - c * yz) / 2
        rotation[i, 2] = c + (c - a * xz - b * yz - c * zz) / 2
