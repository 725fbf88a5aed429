"""How every kernel is compiled: cached on disk, without the interpreter lock, with IEEE arithmetic kept in order.

numba's cache looks at the file of a function only, not at the kernels inlined into it: after an edit it would go on
running the old ones. So the cache lives in a folder named after the content of all kernel files.
"""

import hashlib
import importlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

config: Any = importlib.import_module("numba.core.config")
SOURCES = sorted(Path(__file__).parent.glob("*.py"))


def cache_folder() -> Path:
    """Where compiled kernels of exactly these sources are kept: below NUMBA_CACHE_DIR, or the user's cache folder."""
    content = hashlib.sha256(b"\0".join(source.read_bytes() for source in SOURCES)).hexdigest()
    users = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rangenav"
    return Path(config.CACHE_DIR or users) / f"kernels-{content[:16]}"


FOLDER = cache_folder()


def kernel(function: Callable[..., Any]) -> Any:
    """Compile on first call; error_model "numpy" lets a division give inf or NaN, whose checks stop vectorisation."""
    previous, config.CACHE_DIR = config.CACHE_DIR, str(FOLDER)  # read while decorating, and only then
    try:
        return numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    finally:
        config.CACHE_DIR = previous
