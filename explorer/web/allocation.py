"""Memory of a picture that nobody sees any more goes back to the system.

glibc takes large arrays from the system one by one, but at the first that is freed it raises the size from which it
does so, up to 32 MB, and each thread gets a pool of its own. With a thread a visitor the freed arrays of many pictures
then stay in many pools: a minute in which 10 visitors dragged a gain took 140 MB, and 55 MB with the settings below.
"""

import ctypes
import sys

ARENA_MAX, MMAP_THRESHOLD = -8, -3
"""glibc's names of the two settings (malloc.h)."""
POOLS, FROM_SYSTEM = 2, 128 * 1024
"""Pools of all threads together; and bytes from which memory is taken from the system, and given back when freed."""


def give_back() -> None:
    """Have glibc give freed arrays back at once; nothing is changed where there is no glibc."""
    if sys.platform != "linux":
        return
    library = ctypes.CDLL(None)
    if hasattr(library, "mallopt"):  # musl has none
        library.mallopt(ARENA_MAX, POOLS)
        library.mallopt(MMAP_THRESHOLD, FROM_SYSTEM)
