"""Singular values of many windows: by compiled code where there are many, by LAPACK where there are few.

Both are off by some 1e-16 of a matrix's largest value. Loading the compiled code takes as long as LAPACK takes for
50,000 matrices, so that a program that judges one motion does without it.
"""

import numpy as np
from jaxtyping import Bool, Float
from numpy import ndarray as Array

from rangenav.observability import pseudoinverse
from rangenav.observability.coordinates import STATES
from rangenav.observability.gramian_rank import Remainders

MANY = 32


def of_rows(of: Remainders, units: Float[Array, "13"]) -> tuple[Float[Array, "w 13"], Float[Array, "w 13"]]:
    """Of the weighted rows of each window, descending, and of their pseudoinverse, ascending, zeros first.

    units: of the 13 coordinates, in units of 1 m and δ.
    """
    direct, small = np.empty((2, len(of.triangle), STATES))
    left = of.rank < STATES
    if np.sum(~left) >= MANY:
        some = of if not left.any() else of.some(~left)
        direct[~left], found = _compiled(some, units, inverted=False)
        small[~left], inverse_found = _compiled(some, units, inverted=True)
        left[~left] = ~(found & inverse_found)
    else:
        left[:] = True
    if left.any():
        direct[left], small[left] = _by_lapack(of.some(left), units)
    return direct, small


def _by_lapack(of: Remainders, units: Float[Array, "13"]) -> tuple[Float[Array, "w 13"], Float[Array, "w 13"]]:
    direct = np.linalg.svd(of.triangle @ of.columns * units, compute_uv=False)
    inverse = pseudoinverse.of_rows(of) / units[:, None]
    return direct, pseudoinverse.singular_values(inverse, pseudoinverse.unseen(of, units))


def _compiled(
    of: Remainders, units: Float[Array, "13"], *, inverted: bool
) -> tuple[Float[Array, "w 13"], Bool[Array, "w"]]:
    from rangenav.kernels import gramian_spectra as kernel

    known, departure = of.coordinates, of.departure.reshape(len(of.departure), -1)
    matrix, linear = (
        (known.states, known.states_of_departure) if inverted else (known.columns, known.columns_of_departure)
    )
    values, found = np.empty((len(of.triangle), STATES)), np.empty(len(of.triangle), dtype=bool)
    kernel.run(of.triangle, departure, matrix, linear, units, inverted, values, found)
    return values[:, ::-1] if inverted else values, found
