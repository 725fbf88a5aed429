"""Where a study runs: workers of one thread on this machine, or those of a dask scheduler that runs already."""

import logging
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any
from urllib.parse import urlsplit

from rangenav.progress import Cancelled, CancelledError, never
from rangenav.studies import extra, tasks

DASHBOARD, NO_DASHBOARD = "127.0.0.1:8787", "127.0.0.1:0"
"""The scheduler listens there for a browser; without a dashboard on any free port, which nobody is told."""
POLL = 0.1
"""s between two looks at `cancelled`."""
CONNECT = "10s"
"""How long a scheduler may take to answer."""
QUIET = logging.CRITICAL
LOCAL: dict[str, Any] = {
    # A worker on this machine is lost when its connection breaks. Without this a jump of the clock would end them all.
    "distributed.scheduler.worker-ttl": None,
    "distributed.admin.tick.limit": "1h",
    "distributed.logging.distributed": "critical",
    "distributed.worker.profile.enabled": False,
    # What dask does all the time took 6 % of a core with two workers, and takes 1 %.
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.scheduler.active-memory-manager.start": False,
    "distributed.client.scheduler-info-interval": "10s",
    # A worker that has nothing left takes a part that waits at another one.
    "distributed.scheduler.work-stealing-interval": "250ms",
}


@contextmanager
def connected(client: Any = None, *, workers: int, scheduler: str | None, dashboard: bool) -> Iterator[Any]:
    """A client of a new cluster on this machine, or of the scheduler at an address such as tcp://10.0.0.1:8786.

    A client that is connected already is handed on, and stays connected.

    Raises ValueError in one sentence if that scheduler does not answer.
    """
    distributed = extra.distributed()
    if client is not None:
        yield client
        return
    if scheduler is not None:
        try:
            reached = distributed.Client(scheduler, timeout=CONNECT)
        except ValueError:
            raise ValueError(f"--scheduler {scheduler}: is no address such as tcp://10.0.0.1:8786") from None
        except OSError:
            raise ValueError(f"--scheduler {scheduler}: does not answer within {CONNECT}") from None
        with reached:
            yield reached
        return
    from dask import config

    from rangenav.studies.worker_plugin import IgnoreInterrupt

    with config.set(LOCAL):
        logging.getLogger("distributed").setLevel(QUIET)
        cluster = _aside(
            lambda: distributed.LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                memory_limit=0,
                dashboard_address=DASHBOARD if dashboard else NO_DASHBOARD,
                silence_logs=QUIET,
            )
        )
        with cluster, distributed.Client(cluster) as own:
            own.register_plugin(IgnoreInterrupt())
            yield own


def _aside(start: Callable[[], Any]) -> Any:
    """What `start` returns or raises; it runs in a thread in which interrupts are held, so that this one, the main one,
    answers Ctrl+C meanwhile."""

    def held() -> Any:
        with _interrupts_held():
            return start()

    with ThreadPoolExecutor(1) as pool:
        future = pool.submit(held)
        while not future.done():
            time.sleep(POLL)  # in which signals are handled
        return future.result()


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Workers that start meanwhile do not see the Ctrl+C of their terminal, not even while they import.

    A process inherits the mask of the thread that starts it, and a thread the mask of its maker. The tracker of
    multiprocessing clears the mask when it starts, so it is started before.
    """
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def threads(client: Any) -> int:
    """How many tasks run at once."""
    return sum(client.ncores().values())


def compile_everywhere(client: Any, path: str, digest: str, cancelled: Cancelled = never) -> None:
    """Compile the kernels of a store's study once on every host, before work is dealt out.

    Raises CancelledError when it is cancelled.
    """
    hosts = {urlsplit(address).hostname: address for address in client.ncores()}
    futures = [
        client.submit(tasks.compile_kernels, path, digest, workers=[one], allow_other_workers=True, pure=False)
        for one in hosts.values()
    ]
    while not all(future.done() for future in futures):
        if cancelled():
            raise CancelledError
        time.sleep(POLL)
    for future in futures:
        future.result()
