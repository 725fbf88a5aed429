"""A foreign file is read in a process of its own, with limits of memory and of time: no file can end or stall the page.

    page    read(…)                                       starts the process, waits, ends it if that takes too long
    child   python -m explorer.storage.import_process     limits itself, reads one file, answers, and ends

The child imports the readers and nothing of the page, which takes half a second. What it answers is a frozen value, or
the sentence why the file is refused.
"""

import contextlib
import logging
import math
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from explorer.storage import import_file
from explorer.storage.import_file import ImportFile, Interpretation
from rangenav.inputs import Vec3
from rangenav.progress import Cancelled, CancelledError

CLOCK = 3
"""Times as long as a process may compute, it may take on the clock: the machine may have other work."""
POLL = 0.02
"""s between two looks at the child."""
NICE = 5
"""The child gives way to the page."""
UNKNOWN_SPACE = 2**29
"""Bytes of address space that the readers take, where the system does not say."""
MAX_COMPLAINT = 4000
"""Bytes of a child's traceback that are logged."""
log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What reading one file may take. The largest file that is uploaded (20 MB of text) takes 100 MB and 3 s."""

    memory: int = 300_000_000
    """Bytes, beyond what the readers themselves take."""
    seconds: int = 10
    """s of computing."""
    answer: int = 150_000_000
    """Bytes of what was read."""

    @property
    def sentence(self) -> str:
        """Why a file that exceeds them is refused."""
        return (
            f"reading it takes more than {self.memory / 1e6:.0f} MB of memory or {self.seconds} s, "
            "the limits of the page: rangenav import and rangenav log read larger files"
        )


def read(
    file: ImportFile,
    format_name: str,
    confirm: Mapping[str, str],
    anchor: Vec3 | None,
    *,
    cancelled: Cancelled,
    limits: Limits | None = None,
) -> Interpretation:
    """`import_file.interpret` in a process of its own.

    Raises ValueError with the sentence of the reader or of the limits, and CancelledError.
    """
    limits = limits or Limits()
    with tempfile.TemporaryFile() as request, tempfile.TemporaryFile() as answer, tempfile.TemporaryFile() as complaint:
        pickle.dump((limits, file, format_name, dict(confirm), anchor), request)
        request.seek(0)
        code = _run(request, answer, complaint, limits, cancelled)
        if code != 0:
            complaint.seek(0)
            text = complaint.read(MAX_COMPLAINT).decode("utf-8", "replace")
            log.warning("the process that read %s ended with %s: %s", file.name, code, text)
            failed = "its reader failed, and the log of the server says how"
            raise ValueError(f"{file.name}: {limits.sentence if code < 0 else failed}")
        answer.seek(0)
        understood, result = pickle.load(answer)
    if not understood:
        raise ValueError(result)
    return result


def _run(request: IO[bytes], answer: IO[bytes], complaint: IO[bytes], limits: Limits, cancelled: Cancelled) -> int:
    """The exit code of the child; negative if a signal has ended it, also that of its own limits or of this program."""
    command = [sys.executable, "-P", "-m", __name__]
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
        "OPENBLAS_NUM_THREADS": "1",  # each thread takes address space
    }
    deadline = time.monotonic() + CLOCK * limits.seconds
    with subprocess.Popen(command, stdin=request, stdout=answer, stderr=complaint, env=environment) as child:
        try:
            while child.poll() is None and time.monotonic() < deadline:
                if cancelled():
                    raise CancelledError
                time.sleep(POLL)
        finally:
            child.kill()  # does nothing if it has ended
    return child.returncode


def main() -> None:
    """Read the file of the request, and answer: the child's program."""
    limits, file, *others = pickle.load(sys.stdin.buffer)
    _limit(limits)
    answer: tuple[bool, Any]
    try:
        answer = True, import_file.interpret(file, *others)
    except ValueError as error:
        answer = False, str(error)
    except MemoryError:
        answer = False, f"{file.name}: {limits.sentence}"
    pickle.dump(answer, sys.stdout.buffer, protocol=pickle.HIGHEST_PROTOCOL)


def _limit(limits: Limits) -> None:
    """Limit what this process may take from now on. Windows has no such limits; there the clock limits it alone."""
    try:
        import resource
    except ImportError:
        return
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)  # an answer that is too large ends the process
    os.nice(NICE)
    for kind, most in (
        (resource.RLIMIT_AS, _address_space() + limits.memory),
        (resource.RLIMIT_CPU, math.ceil(time.process_time()) + limits.seconds),
        (resource.RLIMIT_FSIZE, limits.answer),
        (resource.RLIMIT_CORE, 0),
    ):
        _, hard = resource.getrlimit(kind)
        lowest = most if hard == resource.RLIM_INFINITY else min(most, hard)
        with contextlib.suppress(ValueError, OSError):  # macOS does not limit the address space
            resource.setrlimit(kind, (lowest, lowest))


def _address_space() -> int:
    """Bytes of address space that this process has taken so far."""
    try:
        return int(Path("/proc/self/statm").read_bytes().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return UNKNOWN_SPACE


if __name__ == "__main__":
    main()
