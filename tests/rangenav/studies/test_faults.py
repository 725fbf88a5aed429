"""Processes are killed in the middle of a study: what is finished is kept and counted once, and the end is bit-equal.

One scheduler and two workers serve all faults, one after the other. All but the scheduler, whose clock is not the
machine's, are forked from a process that has imported the library.
"""

import itertools
import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest
from msgspec.structs import replace

from rangenav.studies import blocks, creation, store, study, study_file, tasks
from tests.support.forked import forked

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        find_spec("distributed") is None, reason="distributed is not installed (the extra studies has it)"
    ),
]

SECONDS = 60.0
"""The longest wait for anything here."""
POINTS, RUNS = 32, 24
PROGRAM, WORKER = "rangenav.__main__", "distributed.cli.dask_worker"
BEYOND = 3
"""Parts that show that a new client has dealt out work: the workers finish two more for one that is gone."""
JUMPING = """
import signal, time
real, ahead = time.time, [0.0]
time.time = lambda: real() + ahead[0]
signal.signal(signal.SIGUSR1, lambda *_: ahead.append(ahead.pop() + 86400.0))
signal.signal(signal.SIGUSR2, lambda *_: ahead.append(ahead.pop() - 172800.0))
from distributed.cli.dask_scheduler import main
main()
"""
"""A scheduler whose clock jumps by a day when it gets a signal, and back by two."""


@pytest.fixture(scope="module")
def heavy(small_file: Path) -> Path:
    """The file of a study with some seconds of work."""
    file = study_file.read(small_file)
    path = small_file.with_name("heavy.toml")
    anchors = replace(file.parameters[0], count=POINTS)
    path.write_text(study_file.dumps(replace(file, runs=RUNS, parameters=(anchors,), metrics=("steady_position",))))
    return path


def empty(heavy: Path, path: Path) -> store.Store:
    """A store of that study with a part for each point."""
    of = study.load(heavy)
    return creation.created(path, of, blocks.divided(of.shape, 1))


@contextmanager
def process(*command: object) -> Iterator[subprocess.Popen[str]]:
    """A process that is gone at the end."""
    started = subprocess.Popen(
        [str(part) for part in command],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: (
            signal.signal(signal.SIGINT, signal.SIG_DFL) and None
        ),  # a shell in the background ignores it
    )
    try:
        yield started
    finally:
        started.kill()
        started.communicate()


def until(holds: Callable[[], object]) -> None:
    """Wait until something holds."""
    end = time.monotonic() + SECONDS
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.01)


def receipts(of: Path) -> int:
    """How many parts are done."""
    return len(list((of / "receipts").glob("????????.json")))


def more(of: Path, count: int = 1) -> None:
    """Wait until so many more parts are done."""
    before = receipts(of)
    until(lambda: receipts(of) >= before + count)


def chunks(of: Path) -> dict[str, bytes]:
    """The bytes of all results."""
    return {
        str(file.relative_to(of)): file.read_bytes() for file in of.rglob("*") if "/c/" in str(file) and file.is_file()
    }


def test_workers_clients_scheduler_and_clock_fail_and_the_store_is_that_of_a_study_without_a_fault(
    heavy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT", "5s")
    path, address = tmp_path / "heavy.zarr", tmp_path / "scheduler.json"
    parts = empty(heavy, path).blocks.count
    folders = (tmp_path / f"{number}" for number in itertools.count())
    command = (sys.executable, "-c", JUMPING, "--port", 0, "--host", "127.0.0.1", "--scheduler-file", address)

    def worker():
        options = ("--nthreads", 1, "--no-nanny", "--no-dashboard", "--local-directory", tmp_path)
        return forked(WORKER, "--scheduler-file", address, *options, folder=next(folders))

    def client():
        there = json.loads(address.read_text())["address"]
        return forked(PROGRAM, "study", "run", heavy, "-o", path, "--scheduler", there, folder=next(folders))

    with process(*command, "--no-dashboard") as scheduler:
        until(address.exists)
        with worker() as first, worker() as second:
            with client() as one:
                more(path)
                one.kill()
            with client() as one:
                more(path, BEYOND)
                first.kill()
                scheduler.send_signal(signal.SIGUSR1)
                more(path, BEYOND)
                one.kill()
            with client() as one:
                more(path, BEYOND)
                second.kill()
                scheduler.send_signal(signal.SIGUSR2)
                with worker():
                    more(path, BEYOND)
                    one.kill()
                    with client() as one:
                        more(path, BEYOND)
                        scheduler.kill()
                        code, out, err = one.ended(SECONDS)
                    assert (code, out) == (2, "")
                    assert f"of {parts} parts are kept, and the same command goes on" in err.splitlines()[-1]
                    assert "Traceback" not in err
    of, untouched = store.opened(path), empty(heavy, tmp_path / "untouched.zarr")
    missing = set(range(parts)) - set(of.done())
    assert 0 < len(missing) < parts - 5 * BEYOND
    for part in missing:
        tasks.compute(str(path), of.study.digest, part)
    for part in range(parts):
        tasks.compute(str(untouched.path), of.study.digest, part)
    assert chunks(path) == chunks(untouched.path)
    assert sum(one.runs for one in of.done().values()) == RUNS * parts
