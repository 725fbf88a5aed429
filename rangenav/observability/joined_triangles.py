"""Triangles R of sets of rows that grow by a block at a time, joined in pairs, and their inverses: compiled, or LAPACK.

    R of rows A and B = R of [R_A; R_B]
LAPACK takes most of its time for each call. Loading the compiled code takes as long as LAPACK takes for 20 flights, so
a program that judges one motion does without it. Both agree to rounding.
"""

import math

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

from rangenav.progress import stop_if_unwanted


def grown(rows: Float[Array, "p k n"], size: int, *, compiled: bool) -> Array:
    """R of none, of the first, of the first two … blocks of so many rows of each list, as `joined` takes it."""
    stop_if_unwanted()
    p, k, n = rows.shape
    if compiled:
        from rangenav.kernels import triangles as kernels

        packed = np.empty((p, k // size + 1, n * (n + 1) // 2))
        kernels.grow(rows.copy(), size, packed)
        return packed
    grown = np.zeros((p, k // size + 1, n, n))
    for m in range(k // size):
        stop_if_unwanted()
        block = rows[:, m * size : (m + 1) * size]
        grown[:, m + 1] = np.linalg.qr(np.concatenate([grown[:, m], block], axis=1), mode="r")
    return grown


def joined(
    one: Array, i: Int[Array, "w"], other: Array, j: Int[Array, "w"], own: Int[Array, "w"]
) -> Float[Array, "w n n"]:
    """R of the rows of the list `own` in the first i blocks of one, and in the first j of another, for each window."""
    if one.ndim == 4:
        return np.asarray(np.linalg.qr(np.concatenate([one[own, i], other[own, j]], axis=1), mode="r"))
    from rangenav.kernels import triangles as kernels

    n = math.isqrt(2 * one.shape[-1])
    result = np.empty((len(own), n, n))
    kernels.join(one, i, other, j, own, result)
    return result


def inverses(triangle: Float[Array, "w n n"], *, compiled: bool) -> Float[Array, "w n n"]:
    """The inverse of each upper triangle; not finite where one is singular."""
    result = np.full(triangle.shape, np.nan)
    if compiled:
        from rangenav.kernels import triangles as kernels

        kernels.invert(np.ascontiguousarray(triangle), result)
        return result
    regular = (np.diagonal(triangle, axis1=1, axis2=2) != 0).all(axis=1)
    result[regular] = np.linalg.inv(triangle[regular])
    return result
