"""Studies on dask, compared with an ensemble in threads and with a plain loop in a multiprocessing pool.

    python benchmarks/studies.py            runs per second of each, efficiency of two workers, overhead, bytes per run
    python benchmarks/studies.py --long     also 10⁵ empty tasks through the scheduler, and memory over 10⁵ runs
All make runs of paper-slow, 20 s at 200 Hz. Two workers need two free cores: figures from a busy machine mean nothing.
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

import psutil
from timing import Target, report, versions

from rangenav import ensemble, preset, record
from rangenav.studies import blocks, cluster, creation, running, store, study
from rangenav.studies.parameters import Linear
from rangenav.studies.study_file import StudyFile

WORKERS = 2
POINTS, RUNS, PART = 160, 40, 10
"""6400 runs of 4.3 ms: 28 s of work, in parts of 1.7 s."""
PEER_RUNS = 400
ROUNDS = 3
LONG_POINTS = 2500
"""Times RUNS: 10⁵."""
EMPTY = 100_000
AT_ONCE = 1000
"""Empty tasks that the scheduler holds."""


def main() -> None:
    """Time everything and report."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--long", action="store_true", help="10⁵ empty tasks and 10⁵ runs: some ten minutes")
    long = arguments.parse_args().long
    rows, figures, targets = [], {}, []
    with tempfile.TemporaryDirectory() as folder, workers(1) as one, workers(WORKERS) as two:
        _study(Path(folder) / "warm.zarr", two, points=WORKERS)
        _study(Path(folder) / "warm1.zarr", one, points=1)
        times: dict[str, list[float]] = {"one": [], "two": [], "ensemble": [], "pool": []}
        overheads, others, sizes = [], [], []
        for k in range(ROUNDS):
            before = _cpu()
            times["two"].append(_timed(_study, Path(folder) / f"two{k}.zarr", two))
            others.append(1 - _seconds(Path(folder) / f"two{k}.zarr") / (_cpu() - before))
            overheads.append(1 - _seconds(Path(folder) / f"two{k}.zarr") / (WORKERS * times["two"][-1]))
            sizes.append(_bytes(Path(folder) / f"two{k}.zarr") / (POINTS * RUNS))
            times["one"].append(_timed(_study, Path(folder) / f"one{k}.zarr", one))
            times["ensemble"].append(_timed(ensemble.seeds, preset.load("paper-slow"), PEER_RUNS))
            times["pool"].append(_timed_pool())
        median = {name: statistics.median(values) for name, values in times.items()}
        rates = {
            "study, 2 workers": POINTS * RUNS / median["two"],
            "study, 1 worker": POINTS * RUNS / median["one"],
            "ensemble.seeds, threads": PEER_RUNS / median["ensemble"],
            "multiprocessing pool, 2 processes": PEER_RUNS / median["pool"],
        }
        rows += [(name, f"{rate:.0f} runs/s") for name, rate in rates.items()]
        efficiency, overhead = median["one"] / (WORKERS * median["two"]), statistics.median(overheads)
        rows.append(("store", f"{statistics.median(sizes):.0f} bytes per run"))
        targets += [
            Target(name="efficiency of 2 workers", value=efficiency, bound=0.9, at_least=True),
            Target(name="overhead", value=overhead, bound=0.02, at_least=False),
        ]
        rows.append(("CPU time that is not of points", f"{100 * statistics.median(others):.1f} %"))
        figures |= {
            "cpu_not_of_points": others,
            "rates": rates,
            "efficiency": efficiency,
            "overhead": overhead,
            "bytes_per_run": sizes,
        }
        if long:
            rate = EMPTY / _timed(_empty_tasks, two)
            memory = _memory(Path(folder) / "long.zarr", two)
            rows += [("empty tasks", f"{rate:.0f} tasks/s"), ("memory", f"{memory[0]:.0f} → {memory[-1]:.0f} MB")]
            growth = memory[-1] / memory[0]
            targets.append(
                Target(name="memory after 10⁵ runs / after a tenth", value=growth, bound=1.05, at_least=False)
            )
            figures |= {"empty_tasks_per_second": rate, "memory_mb": memory}
    report(
        "studies",
        title="Studies beside an ensemble and a plain pool",
        columns=("what", "measured"),
        rows=rows,
        targets=targets,
        notes=[f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; overhead is the share of the workers' wall time"
               " that is not CPU time of points"],
        figures={**figures, "versions": versions("numpy", "numba", "distributed", "zarr")},
    )  # fmt: skip


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


def _study(path: Path, client: Any, points: int = POINTS, shown: running.Shown = lambda state: None) -> None:
    of = _of(points)
    creation.created(path, of, blocks.divided(of.shape, PART))
    running.run(of, path, client=client, shown=shown)


def _seconds(path: Path) -> float:
    return sum(one.seconds for one in store.opened(path).done().values())


def _cpu() -> float:
    """CPU time of this program and its workers so far, s."""
    family = [psutil.Process(), *psutil.Process().children(recursive=True)]
    return sum(sum(one.cpu_times()[:2]) for one in family)


def _bytes(path: Path) -> int:
    return sum(file.stat().st_size for file in path.rglob("*") if file.is_file())


def _timed_pool() -> float:
    """The same runs by what a person writes first: a pool of processes and the library's single run."""
    context = multiprocessing.get_context("spawn")
    with context.Pool(WORKERS) as pool:
        pool.map(_one, range(WORKERS), chunksize=1)  # so that no timed run waits for imports
        return _timed(lambda: pool.map(_one, range(PEER_RUNS), chunksize=PEER_RUNS // (4 * WORKERS)))


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

    def shown(state: running.State) -> None:
        tenth = 10 * state.done // state.parts
        if tenth and tenth not in taken:
            family = [psutil.Process(), *psutil.Process().children(recursive=True)]
            taken[tenth] = sum(one.memory_info().rss for one in family) / 1e6

    _study(path, client, LONG_POINTS, shown)
    return [taken[tenth] for tenth in sorted(taken)]


def _timed(call: Any, *arguments: object) -> float:
    began = time.perf_counter()
    call(*arguments)
    return time.perf_counter() - began


if __name__ == "__main__":
    main()
