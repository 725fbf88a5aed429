"""The memory of freed arrays goes back to the system, also where others are still in use between them."""

import sys
from pathlib import Path

import numpy as np
import pytest

from explorer.web.allocation import give_back

MB = 2**20


def resident() -> float:
    """MB that this process has."""
    for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1024
    raise LookupError("VmRSS")


@pytest.mark.skipif(sys.platform != "linux", reason="another system has another allocator")
def test_every_second_of_many_freed_arrays_goes_back() -> None:
    give_back()
    np.ones(4 * MB, dtype=np.uint8)  # freed at once: else glibc would take smaller ones from its pools from now on
    arrays = [np.ones(MB // 4, dtype=np.uint8) for _ in range(200)]
    full = resident()
    del arrays[::2]
    assert full - resident() > 12
