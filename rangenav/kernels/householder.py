"""Householder's reflection of a vector to an axis: x − share · v (vᵀx) with v = a + sign(a₀) |a| e₀, share = 2/vᵀv."""

import numpy as np

from rangenav.kernels.jit import kernel
from rangenav.kernels.vectors import choose


@kernel
def reflector(first, square):
    """v₀, the share, a's squared length and its reflection, from a₀ and the sum of the other squares.

    The share of a zero vector is 0: nothing is reflected.
    """
    total = first * first + square
    length = np.sqrt(total)
    size = length * (length + abs(first))
    share = choose(size > 0.0, 1 / size, size * 0.0)
    negative = first < 0.0
    return choose(negative, first - length, first + length), share, total, choose(negative, length, -length)
