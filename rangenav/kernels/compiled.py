"""How every kernel is compiled: cached on disk, without the interpreter lock, with IEEE arithmetic kept in order."""

import numba

kernel = numba.njit(cache=True, nogil=True, error_model="numpy")
"""error_model "numpy" lets a division give inf or NaN as in numpy; the check before each would stop vectorisation."""
