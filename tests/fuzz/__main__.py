"""`python -m tests.fuzz`: run all targets, one of them, or each reader by itself, until the time is up.

--target importers     the readers of all formats take turns     --target tum     one reader
--target all           every target                              --target each    every reader, one after the other
"""

import argparse
import resource
import sys
import time
import warnings
from random import Random

from rangenav.motion import DirectionWarning
from tests.fuzz.targets import LEAST_CASES, READERS, TARGETS, prepare

ALL, EACH = "all", "each"
DEADLINE = 1.0
"""s; a case that takes longer hangs, as far as somebody typing is concerned."""
MEMORY = 2**29
"""Bytes of address space that all cases together may take beyond what the seeds take."""


class ExecutionError(Exception):
    """Something asked Python to run text."""


def run(target: str, *, seconds: float, cases: int | None = None, seed: int = 0) -> int:
    """Run a target until the time is up or the cases are done; returns how many were run. Raises what a case raised."""
    names = TARGETS.get(target, (target,))
    began, count = time.perf_counter(), 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", DirectionWarning)  # a direction that is nearly a unit vector is used as one
        while time.perf_counter() - began < seconds and count != cases:
            random = Random(seed + count)
            name = random.choice(names)
            started = time.thread_time()
            _watch["on"] = True
            try:
                READERS[name](random)
            except BaseException:
                print(f"{target} ({name}): case --seed {seed + count} --cases 1 failed", file=sys.stderr)
                raise
            finally:
                _watch["on"] = False
            took = time.thread_time() - started
            assert took < DEADLINE, f"{target} ({name}): case --seed {seed + count} took {took:.2f} s"
            count += 1
    return count


_watch = {"on": False}


def _refuse_execution(event: str, arguments: tuple[object, ...]) -> None:
    if _watch["on"] and event == "exec":
        raise ExecutionError(f"Python was asked to run {arguments!r}")


def _limit_memory() -> None:
    """A case that takes too much fails with a MemoryError, and does not take the machine with it."""
    with open("/proc/self/statm", "rb") as file:
        taken = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + MEMORY, resource.RLIM_INFINITY))


def main() -> None:
    """Parse the command line, run what was chosen, say how far it came."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", choices=(ALL, EACH, *TARGETS, *READERS), default=ALL, metavar="TARGET")
    parser.add_argument("--seconds", type=float, default=60.0, help="of each target, or of each reader")
    parser.add_argument("--cases", type=int, default=None)
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    prepare()
    _limit_memory()
    sys.addaudithook(_refuse_execution)
    for target in {ALL: tuple(TARGETS), EACH: tuple(READERS)}.get(chosen.target, (chosen.target,)):
        began = time.perf_counter()
        count = run(target, seconds=chosen.seconds, cases=chosen.cases, seed=chosen.seed)
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        took = time.perf_counter() - began
        print(f"{target}: {count} cases in {took:.1f} s, none failed; at most {most:.0f} MB so far", flush=True)
        least = 0 if chosen.target == EACH else LEAST_CASES.get(target, 0)
        if chosen.cases is None and chosen.seconds >= 60 and count < least:
            sys.exit(f"{target}: a run must reach {least} cases")


if __name__ == "__main__":
    main()
