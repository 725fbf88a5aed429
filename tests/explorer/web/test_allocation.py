"""The memory of freed arrays goes back to the system, also where others are still in use between them."""

import subprocess
import sys

import pytest

PROGRAM = """
import pathlib, re
import numpy as np
from explorer.web.allocation import give_back

def resident():
    return int(re.search(r"VmRSS:\\s+(\\d+)", pathlib.Path("/proc/self/status").read_text())[1]) / 1024

give_back()
np.ones(4 * 2**20, dtype=np.uint8)  # freed at once: else glibc would take smaller ones from its pools from now on
arrays = [np.ones(2**18, dtype=np.uint8) for _ in range(200)]
full = resident()
del arrays[::2]
print(full - resident())
"""


@pytest.mark.skipif(sys.platform != "linux", reason="another system has another allocator")
def test_every_second_of_many_freed_arrays_goes_back() -> None:
    """In a process of its own: what other tests have freed would be taken first."""
    done = subprocess.run([sys.executable, "-c", PROGRAM], check=True, capture_output=True, text=True)
    assert float(done.stdout) > 12  # of 25 MB that are freed
