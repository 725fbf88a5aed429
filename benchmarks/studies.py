"""Studies on dask, compared with an ensemble in threads and with a plain loop in a multiprocessing pool.

    python benchmarks/studies.py            runs per second of each, efficiency of two workers, overhead, bytes per run
    python benchmarks/studies.py --long     10⁵ empty tasks through the scheduler, and memory over 10⁵ runs
All make runs of paper-slow, 20 s at 200 Hz, in parts as `study run` divides the study.

    overhead = 1 − share of the study / share of a plain pool that computes the same parts and keeps nothing
    share    = CPU time of the points / Σ over workers of the time from making the store to the end of its last part
The CPU time is of the threads that compute, as each part's receipt has it, and the workers are there before. How long
one worker waits for the last part of another is chance, in the pool as in the study: it counts in the rates and in the
efficiency, but is no overhead. The start of a study is a row of its own. Two workers need two free cores: figures from
a busy machine mean nothing.
"""

import argparse
import contextlib
import multiprocessing
import os
import statistics
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from timing import Target, report, versions

from rangenav import ensemble, preset, record
from rangenav.studies import blocks, cluster, creation, evaluation, plan, running, store, study, tally, trial
from rangenav.studies.parameters import Linear
from rangenav.studies.study_file import StudyFile

WORKERS = 2
POINTS, RUNS = 1000, 40
"""40,000 runs of 3 ms: 125 s of work, in parts of some three seconds."""
FEWER = 300
"""Points for one worker, in parts of the same size."""
TURNS = 2
"""Of the study with two workers and the pool, one after the other: the machine may change in the minutes between."""
PEER_RUNS = 400
ROUNDS = 3
LONG_POINTS = 2500
"""Times RUNS: 10⁵."""
EMPTY = 100_000
AT_ONCE = 1000
"""Empty tasks that the scheduler holds."""
Figures = tuple[list[tuple[str, str]], list[Target], dict[str, Any]]


def main() -> None:
    """Time everything and report."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--long", action="store_true", help="10⁵ empty tasks and 10⁵ runs: some eight minutes")
    long = arguments.parse_args().long
    with tempfile.TemporaryDirectory() as folder:
        rows, targets, figures = (_long if long else _usual)(Path(folder))
    report(
        "studies",
        title="Studies at length" if long else "Studies beside an ensemble and a plain pool",
        columns=("what", "measured"),
        rows=rows,
        targets=targets,
        notes=[f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"],
        figures={**figures, "versions": versions("numpy", "numba", "distributed", "zarr")},
    )


def _usual(folder: Path) -> Figures:
    began = time.perf_counter()
    parts = plan.divided(_of(POINTS), trial.cost(_of(POINTS)), workers=WORKERS)
    tried = time.perf_counter() - began
    starts, turns, used_by_pool, path = [], [], [], folder / "two-0.zarr"
    for number in range(TURNS):
        began = time.perf_counter()
        with workers(WORKERS) as two:
            _study(folder / f"warm-{number}.zarr", two, points=WORKERS, part=1)
            starts.append(time.perf_counter() - began)
            turns.append(_turn(folder / f"two-{number}.zarr", two, parts))
        used_by_pool.append(_used_by_pool(parts))
    wall, computed, used, span = np.mean(turns, axis=0).tolist()
    with workers(1) as one:
        _study(folder / "warm.zarr", one, points=1, part=1)
        alone = _timed(_study, folder / "one.zarr", one, FEWER, parts.chunk[0])
    loop = statistics.median(_timed(ensemble.seeds, preset.load("paper-slow"), PEER_RUNS) for _ in range(ROUNDS))
    pool = _timed_pool()
    rates = {
        "study, 2 workers": POINTS * RUNS / wall,
        "study, 1 worker": FEWER * RUNS / alone,
        "ensemble.seeds, threads": PEER_RUNS / loop,
        "multiprocessing pool, 2 processes": PEER_RUNS / pool,
    }
    efficiency = rates["study, 2 workers"] / (WORKERS * rates["study, 1 worker"])
    used_by_study, size = computed / span, _bytes(path) / (POINTS * RUNS)
    used_by_plain, start = statistics.mean(used_by_pool), tried + statistics.mean(starts)
    overhead = 1 - used_by_study / used_by_plain
    rows = [
        *((name, f"{rate:.0f} runs/s") for name, rate in rates.items()),
        ("parts", f"{parts.count} of {computed / parts.count:.1f} s"),
        ("cores used by points: study", f"{100 * used_by_study:.1f} %"),
        ("cores used by points: a pool that keeps nothing", f"{100 * used_by_plain:.1f} %"),
        ("CPU time that is not of points", f"{100 * (1 - computed / used):.1f} %"),
        ("start: trial, workers, kernels", f"{start:.1f} s"),
        ("store", f"{size:.0f} bytes per run"),
    ]
    targets = [
        Target(name="efficiency of 2 workers", value=efficiency, bound=0.9, at_least=True),
        Target(name="overhead", value=overhead, bound=0.02, at_least=False),
    ]
    figures = {"rates": rates, "efficiency": efficiency, "overhead": overhead, "bytes_per_run": size, "start": start}
    return rows, targets, {**figures, "cpu_not_of_points": 1 - computed / used}


def _turn(path: Path, client: Any, parts: blocks.Blocks) -> tuple[float, float, float, float]:
    """The study once: its wall time, the CPU time of its points and of all processes, and how long all workers
    together had something to do (s)."""
    from distributed import get_task_stream

    before, began = _cpu(), time.time()
    ends: dict[str, float] = {}
    stream: Any = get_task_stream(client)
    with stream:
        wall = _timed(_study, path, client, POINTS, parts.chunk[0])
    for task in stream.data:
        ends[task["worker"]] = max(ends.get(task["worker"], 0.0), *(one["stop"] for one in task["startstops"]))
    return wall, _seconds(path), _cpu() - before, sum(end - began for end in ends.values())


def _long(folder: Path) -> Figures:
    with workers(WORKERS) as two:
        rate = EMPTY / _timed(_empty_tasks, two)
        memory = _memory(folder / "long.zarr", two)
    rows = [("empty tasks", f"{rate:.0f} tasks/s"), ("memory", f"{memory[0]:.0f} → {memory[-1]:.0f} MB")]
    name = "memory after 10⁵ runs / after a tenth"
    targets = [Target(name=name, value=memory[-1] / memory[0], bound=1.05, at_least=False)]
    return rows, targets, {"empty_tasks_per_second": rate, "memory_mb": memory}


@contextlib.contextmanager
def workers(count: int) -> Iterator[Any]:
    """A client of so many processes."""
    with cluster.connected(workers=count, scheduler=None, dashboard=False) as client:
        yield client


def _of(points: int) -> study.Study:
    """Runs of paper-slow from a row of anchors."""
    file = StudyFile(
        title="benchmark",
        presets=("paper-slow",),
        parameters=(Linear(path="world.anchor.x", low=-1.0, high=1.0, count=max(points, 2)),),
        metrics=("steady_position", "settle_position", "settle_attitude"),
        runs=RUNS,
    )
    return study.of_file(file, (preset.load("paper-slow"),))


def _study(path: Path, client: Any, points: int, part: int, shown: running.Shown = lambda state: None) -> None:
    of = _of(points)
    creation.created(path, of, blocks.divided(of.shape, part))
    running.run(of, path, client=client, shown=shown)


def _seconds(path: Path) -> float:
    return sum(one.seconds for one in store.opened(path).done().values())


def _cpu() -> float:
    """CPU time of this program and its workers so far, s."""
    family = [psutil.Process(), *psutil.Process().children(recursive=True)]
    return sum(sum(one.cpu_times()[:2]) for one in family)


def _bytes(path: Path) -> int:
    return sum(file.stat().st_size for file in path.rglob("*") if file.is_file())


def _used_by_pool(parts: blocks.Blocks) -> float:
    """The share of the cores that the points of the same parts take in a plain pool, which keeps no result. What is
    missing from 1 is the machine's: other programs."""
    context = multiprocessing.get_context("spawn")
    with context.Pool(WORKERS) as pool:
        pool.map(_seconds_of, [range(1)] * WORKERS, chunksize=1)
        some = [range(first, min(first + parts.chunk[0], POINTS)) for first in range(0, POINTS, parts.chunk[0])]
        began, ends, computed = time.time(), {}, 0.0
        for seconds, process, end in pool.imap_unordered(_seconds_of, some):
            computed, ends[process] = computed + seconds, max(ends.get(process, 0.0), end)
    return computed / sum(end - began for end in ends.values())


def _seconds_of(points: range) -> tuple[float, int, float]:
    """CPU time of some points, the process, and when they were done (s)."""
    began = time.thread_time()
    evaluation.block(_of(POINTS), points)
    return time.thread_time() - began, os.getpid(), time.time()


def _timed_pool() -> float:
    """The same runs by what a person writes first: a pool of processes and the library's single run."""
    context = multiprocessing.get_context("spawn")
    with context.Pool(WORKERS) as pool:
        pool.map(_one, range(WORKERS), chunksize=1)  # so that no timed run waits for imports
        each = PEER_RUNS // (4 * WORKERS)
        return statistics.median(_timed(pool.map, _one, range(PEER_RUNS), each) for _ in range(ROUNDS))


def _one(seed: int) -> float:
    return record.run_seed(preset.load("paper-slow"), seed).summary.steady_position


def _empty_tasks(client: Any) -> None:
    """Tasks that do nothing, dealt out and counted as those of a study are."""
    from distributed import as_completed

    left = iter(range(EMPTY))
    finished = as_completed([client.submit(_nothing, next(left), pure=False) for _ in range(AT_ONCE)])
    for future in finished:
        future.release()
        following = next(left, None)
        if following is not None:
            finished.add(client.submit(_nothing, following, pure=False))


def _nothing(number: int) -> int:
    return number


def _memory(path: Path, client: Any) -> list[float]:
    """Resident MB of this program and its workers, after each tenth of 10⁵ runs."""
    taken: dict[int, float] = {}

    def shown(state: tally.State) -> None:
        tenth = 10 * state.done // state.parts
        if tenth and tenth not in taken:
            family = [psutil.Process(), *psutil.Process().children(recursive=True)]
            taken[tenth] = sum(one.memory_info().rss for one in family) / 1e6

    parts = plan.divided(_of(LONG_POINTS), trial.cost(_of(LONG_POINTS)), workers=WORKERS)
    _study(path, client, LONG_POINTS, parts.chunk[0], shown)
    return [taken[tenth] for tenth in sorted(taken)]


def _timed(call: Any, *arguments: object) -> float:
    began = time.perf_counter()
    call(*arguments)
    return time.perf_counter() - began


if __name__ == "__main__":
    main()
