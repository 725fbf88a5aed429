"""How every kernel is compiled: cached on disk, without the interpreter lock, with IEEE arithmetic kept in order."""

import importlib
from collections.abc import Callable
from typing import Any

import numba

from rangenav.kernels import cache

config: Any = importlib.import_module("numba.core.config")


def kernel(function: Callable[..., Any]) -> Any:
    """Compile on first call; error_model "numpy" lets a division give inf or NaN, whose checks stop vectorisation."""
    return _compiled(function, inlined=False)


def inlined(function: Callable[..., Any]) -> Any:
    """The same for a function that loops over lanes call: they become vector code only where no call is left."""
    return _compiled(function, inlined=True)


def _compiled(function: Callable[..., Any], *, inlined: bool) -> Any:
    previous, config.CACHE_DIR = config.CACHE_DIR, str(cache.folder())  # read while decorating, and only then
    try:
        return numba.njit(cache=True, nogil=True, error_model="numpy", forceinline=inlined)(function)
    finally:
        config.CACHE_DIR = previous
