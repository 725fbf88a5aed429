"""Where compiled kernels are kept on disk, and whether all of them are there; this does not import the compiler.

numba's cache looks at the file of a function only, not at the kernels inlined into it: after an edit it would go on
running the old ones. So the cache lives in a folder named after the content of all kernel files.
"""

import contextlib
import functools
import hashlib
import importlib.metadata
import os
import platform
from pathlib import Path

SOURCES = sorted(Path(__file__).parent.glob("*.py"))
COMPLETE = "complete.txt"
"""In the folder once every kernel was compiled: for which compiler, interpreter and processor."""


@functools.cache
def folder() -> Path:
    """Where compiled kernels of exactly these sources are kept: below NUMBA_CACHE_DIR, or the user's cache folder."""
    content = hashlib.sha256(b"\0".join(source.read_bytes() for source in SOURCES)).hexdigest()
    users = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rangenav"
    return Path(os.environ.get("NUMBA_CACHE_DIR") or users) / f"kernels-{content[:16]}"


def complete() -> bool:
    """Whether all kernels were compiled for this machine before. They are then loaded in a second."""
    try:
        return (folder() / COMPLETE).read_text(encoding="utf-8") == _machine()
    except (OSError, UnicodeDecodeError):
        return False


def note_complete() -> None:
    """Note that all kernels have been compiled; where the folder cannot be written, they are compiled at each start."""
    with contextlib.suppress(OSError):
        (folder() / COMPLETE).write_text(_machine(), encoding="utf-8")


def _machine() -> str:
    compiler = "/".join(importlib.metadata.version(name) for name in ("numba", "llvmlite", "numpy"))
    return f"{compiler} {platform.python_version()} {platform.machine()} {platform.node()}\n"
