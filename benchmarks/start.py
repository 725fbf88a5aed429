"""Start and memory: how long the programs take to answer, what the server holds before and after the first visitor, and
where that memory goes.

Times are of processes of their own, with compiled kernels on the disk, the median of several. Memory is what the
operating system counts as resident: anonymous memory, which is the program's own, and pages of files, which programs
share. "Where it goes" loads one part after the other in one process.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from timing import Target, report, versions

from explorer.model.compute import compile_estimators, compile_kernels
from rangenav.kernels import cache
from tests.support.wire import Wire

RUNS = 5
REST, LATER = 3.0, 8.0
"""s after which the server is at rest before the first visitor, and has loaded everything after."""
VERDICT = "of 13"
IMPORT, HELP, ANSWER, BEFORE = 0.25, 0.4, 0.7, 200.0
"""s, s, s and MB."""
PARTS = (
    ("Python", ""),
    ("numpy", "import numpy"),
    (
        "scipy: interpolation, special functions, optimisation",
        "import scipy.interpolate, scipy.special, scipy.optimize",
    ),
    ("viser and websockets", "import viser"),
    ("page and library", "import explorer.server; from rangenav import preset; preset.shipped()"),
    ("numba and LLVM", "import numba"),
    ("compiled kernels", "from explorer.model import compute; compute.compile_kernels(lambda *_: None)"),
    ("python-control", "import control"),
    ("estimators to compare with", "compute.compile_estimators()"),
)
MEASURED = """
import json, re
found = []
for code in {codes!r}:
    exec(code)
    status = open("/proc/self/status").read()
    found.append([int(re.search(name + r":\\s+(\\d+)", status)[1]) / 1e3 for name in ("RssAnon", "RssFile")])
print(json.dumps(found))
"""


def main() -> None:
    """Measure, print."""
    compile_kernels(lambda share, words: None)
    compile_estimators()
    cache.note_complete()
    commands = {
        "import rangenav": [sys.executable, "-c", "import rangenav"],
        "import every module that the page needs": [sys.executable, "-c", "import explorer.server"],
        "rangenav --help": [sys.executable, "-m", "rangenav", "--help"],
        "rangenav --version": [sys.executable, "-m", "rangenav", "--version"],
    }
    times = {name: float(np.median([_seconds(command) for _ in range(RUNS)])) for name, command in commands.items()}
    starts = [_start() for _ in range(RUNS)]
    answer, rest, verdict, after = (float(np.median(column)) for column in zip(*starts, strict=True))
    parts = _parts()
    times |= {"the page answers": answer, "from asking for the page to its first verdict": verdict}
    memory = {"before the first visitor": rest, "with one visitor": after}
    report(
        "start",
        title="Start and memory",
        columns=("", "measured"),
        rows=[(name, f"{value:.2f} s") for name, value in times.items()]
        + [(f"server {name}", f"{value:.0f} MB") for name, value in memory.items()]
        + [(f"  {name}", f"{own:+.0f} MB, {shared:+.0f} MB of files") for name, (own, shared) in parts.items()],
        targets=[
            Target(name="import rangenav", value=times["import rangenav"], bound=IMPORT, at_least=False, unit=" s"),
            Target(name="rangenav --help", value=times["rangenav --help"], bound=HELP, at_least=False, unit=" s"),
            Target(name="the page answers", value=answer, bound=ANSWER, at_least=False, unit=" s"),
            Target(name="before the first visitor", value=rest, bound=BEFORE, at_least=False, unit=" MB"),
        ],
        notes=[],
        figures={
            "seconds": times,
            "megabytes": memory | {name: sum(both) for name, both in parts.items()},
            "versions": versions("numpy", "scipy", "numba", "viser"),
        },
    )


def _seconds(command: list[str]) -> float:
    began = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


def _start() -> tuple[float, float, float, float]:
    """s until the page answers, MB at rest, s from asking for the page to its first verdict, and MB some time later."""
    with tempfile.TemporaryDirectory() as folder, _served(Path(folder)) as (process, address, port, answered):
        time.sleep(REST)
        rest = _resident(process.pid)
        asked = time.perf_counter()
        with urllib.request.urlopen(address):
            tab = Wire(port)
        tab.wait_for_text(VERDICT)
        verdict = time.perf_counter() - asked
        time.sleep(LATER)
        tab.close()
        return answered, rest, verdict, _resident(process.pid)


@contextmanager
def _served(folder: Path) -> Iterator[tuple[subprocess.Popen[str], str, int, float]]:
    """A server whose saved work lies in a folder of its own: its process, address, port, and s until it answered."""
    began = time.perf_counter()
    environment = os.environ | {"XDG_STATE_HOME": str(folder), "XDG_DATA_HOME": str(folder)}
    command = [sys.executable, "-m", "explorer", "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        address = process.stdout.readline().split()[-1]  # printed once the page has answered a request
        answered = time.perf_counter() - began
        found = re.search(r":(\d+)", address.removeprefix("http:"))
        assert found is not None
        try:
            yield process, address, int(found[1]), answered
        finally:
            process.terminate()


def _parts() -> dict[str, tuple[float, float]]:
    """MB that each part adds: of its own, and of files."""
    program = MEASURED.format(codes=[code for _, code in PARTS])
    found = json.loads(subprocess.run([sys.executable, "-c", program], check=True, capture_output=True).stdout)
    added = np.diff(np.array([[0.0, 0.0], *found]), axis=0).tolist()
    return {name: (own, shared) for (name, _), (own, shared) in zip(PARTS, added, strict=True)}


def _resident(pid: int) -> float:
    """MB."""
    found = re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{pid}/status").read_text())
    assert found is not None
    return int(found[1]) / 1e3


if __name__ == "__main__":
    main()
