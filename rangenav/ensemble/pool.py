"""A pool of threads for long work: as many as there are cores, with progress, a way to stop it, and a limit.

The kernels release the interpreter lock. Results stand in the order of the items, whichever thread was faster.
"""

import contextlib
import os
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from queue import Empty, SimpleQueue
from typing import TypeVar

from rangenav.inputs import require
from rangenav.preset import Preset
from rangenav.progress import Cancelled, CancelledError, Progress

MAX_RUNS = 10_000
MAX_STEPS = 200_000_000
"""IMU samples in all runs together: some five minutes of one core."""
MAX_AT_ONCE = 4_000_000
"""IMU samples in all runs that are worked on at once; each takes 0.4 kB while it is."""
IN_HAND = 2
"""Items for each thread that are handed out: one at work, one ready."""
POLL = 0.1
"""s between two calls of `cancelled`."""
Item = TypeVar("Item")
Result = TypeVar("Result")


def each(
    work: Callable[[Item], Result], items: Sequence[Item], *, samples: int, progress: Progress, cancelled: Cancelled
) -> list[Result]:
    """work(item) for every item, in as many threads as there are cores; results in the order of the items.

    samples: those of the IMU in one item; of items with long records fewer are worked on at once. The first error of a
    job is raised, and CancelledError as soon as `cancelled()`; jobs not yet begun are then dropped. While `cancelled`
    does not return, the threads end what they have in hand, and then rest."""
    threads = max(1, min(os.cpu_count() or 1, MAX_AT_ONCE // samples))
    with ThreadPoolExecutor(threads) as pool:
        finished: SimpleQueue[Future[Result]] = SimpleQueue()  # `wait` would look at every job after every job
        jobs: list[Future[Result]] = []

        def hand_out(count: int) -> None:
            for item in items[len(jobs) : len(jobs) + count]:
                jobs.append(pool.submit(work, item))
                jobs[-1].add_done_callback(finished.put)

        hand_out(IN_HAND * threads)
        try:
            for count in range(1, len(items) + 1):
                _next(finished, cancelled).result()
                hand_out(1)
                progress(count / len(items))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [job.result() for job in jobs]


def _next(finished: SimpleQueue[Future[Result]], cancelled: Cancelled) -> Future[Result]:
    while not cancelled():
        with contextlib.suppress(Empty):
            return finished.get(timeout=POLL)
    raise CancelledError


def refuse_work(preset: Preset, count: int, times: int = 1) -> None:
    """Raise ValueError unless 1 ≤ count ≤ 10 000 and all runs, so many times, stay below the limit of samples."""
    require(1 <= count <= MAX_RUNS, f"the number of runs must lie between 1 and {MAX_RUNS}, got {count}")
    samples = times * count * preset.duration * preset.sensors.imu_rate
    require(samples <= MAX_STEPS, f"runs × duration × IMU rate must not exceed {MAX_STEPS} samples, got {samples:.0f}")
