"""Running a study: parts are dealt out, each writes itself into the store, and what is done is never computed again.

Any number of workers and any order give the same store. If the program, a worker, all workers, the scheduler or the
machine ends at any moment, the same call goes on with the parts that are missing.
"""

import errno
import time
from collections.abc import Callable
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from rangenav.inputs import require, shortened
from rangenav.progress import Cancelled, CancelledError, never
from rangenav.studies import cluster, creation, differences, extra, plan, receipts, store, tasks, trial
from rangenav.studies.receipts import Receipt
from rangenav.studies.store import Store
from rangenav.studies.study import Study
from rangenav.studies.tally import State, Tally

AHEAD = 3
"""Tasks that the scheduler holds for each thread: enough that no worker waits for this program, and few to be dropped
at a stop."""
POLL = 0.25
"""s between two looks at `cancelled`."""
LATE = 30.0
"""s after which a receipt must be visible."""
RECOUNT = 5.0
"""s between two counts of the workers, which may come and go."""


class StoppedError(ValueError):
    """The study could not go on; what was done is kept."""


Shown = Callable[[State], None]


def run(
    study: Study,
    path: Path,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    dashboard: bool = False,
    client: Any = None,
    shown: Shown = lambda state: None,
    cancelled: Cancelled = never,
) -> State:
    """Compute a study into a store, or what is missing of it, in so many processes or on a dask scheduler.

    client: a dask client that is connected already, such as one of dask-jobqueue; it has its own workers.
    Raises ValueError if the store is of another study or is being computed, StoppedError if the disk is full or the
    scheduler is lost, and CancelledError when it is cancelled.
    """
    extra.distributed()
    if scheduler is not None and client is None:  # before a store is made
        with cluster.connected(workers=workers, scheduler=scheduler, dashboard=False):
            pass
    of = _opened(study, path, workers if client is None else cluster.threads(client))
    with of.locked():
        tally = Tally(of)
        shown(tally.state("workers"))
        if tally.missing:
            with cluster.connected(client, workers=workers, scheduler=scheduler, dashboard=dashboard) as connected:
                shown(tally.state("kernels"))
                _compile(connected, of, cancelled)
                tally.begin()
                _deal(connected, of, tally, shown, cancelled)
        return tally.state()


def _opened(study: Study, path: Path, workers: int) -> Store:
    """The store of this study, which is made if there is none."""
    if not path.exists():
        return creation.created(path, study, plan.divided(study, trial.cost(study), workers=max(1, workers)))
    of = store.opened(path)
    refused = refusal(of, study)
    require(refused is None, f"{refused}; -o OTHER.zarr chooses another store")
    return of


def refusal(of: Store, study: Study) -> str | None:
    """Why this study cannot go on in a store, as a sentence without its way out; None if it can."""
    if of.study.digest != study.digest:
        words = f"{of.study.file.title} ({differences.between(of.study, study)})"
        return f"{of.path}: holds another study, {words}"
    if of.source != store.SOURCE:
        return f"{of.path}: begun with {of.source}, which alone goes on with it"
    return None


def kept(path: Path, parts: int) -> str:
    """What is kept of a study that was stopped, as a clause for a person."""
    count = sum(1 for _ in receipts.written(path))
    return f"{count} of {parts} parts {'is' if count == 1 else 'are'} kept, and the same command goes on"


def stopped(path: Path) -> str:
    """What a person reads after a stop: what the store holds then, which is more than the program has counted."""
    if not path.exists():
        return "stopped before anything was computed"
    return f"stopped; {kept(path, store.opened(path).blocks.count)}"


def _compile(client: Any, of: Store, cancelled: Cancelled) -> None:
    """Compile the kernels once on every host. Raises StoppedError if the scheduler is lost."""
    try:
        cluster.compile_everywhere(client, str(of.path.resolve()), of.study.digest, cancelled)
    except (OSError, RuntimeError) as error:
        raise _stopped(of, f"no worker could begin ({type(error).__name__})") from None


def _deal(client: Any, of: Store, tally: Tally, shown: Shown, cancelled: Cancelled) -> None:
    """Keep the workers busy until every part has its receipt."""
    finished: SimpleQueue[Any] = SimpleQueue()
    waiting: dict[Any, int] = {}
    path = str(of.path.resolve())  # a worker has a folder of its own
    room, counted = 0, -RECOUNT
    try:
        while tally.missing or waiting:
            if time.monotonic() - counted >= RECOUNT:
                tally.workers, counted = cluster.threads(client), time.monotonic()
                room = AHEAD * max(1, tally.workers)
                shown(tally.state())
            while tally.missing and len(waiting) < room:
                part = tally.missing.popleft()
                future = client.submit(tasks.compute, path, of.study.digest, part, key=_key(of, part))
                waiting[future] = part
                future.add_done_callback(finished.put)
            if cancelled():
                raise CancelledError
            try:
                future = finished.get(timeout=POLL)
            except Empty:
                continue
            tally.take(_receipt(future, waiting.pop(future), of))
            future.release()
            shown(tally.state())
    except OSError as error:  # of the connection to the scheduler
        raise _stopped(of, f"the scheduler does not answer ({type(error).__name__})") from None
    finally:
        for future in waiting:
            future.cancel()


def _key(of: Store, part: int) -> str:
    """A task's name on the scheduler. The number tells the tasks of two programs apart."""
    return f"rangenav-study-{of.study.digest[:12]}-{part}-{time.monotonic_ns()}"


def _receipt(future: Any, part: int, of: Store) -> Receipt:
    """The receipt of a part that is finished. Raises StoppedError in one sentence if it could not be computed.

    It is read from the store: what a task returns is lost with its worker, which may have ended since.
    """
    if future.status == "cancelled":
        raise _stopped(of, "the scheduler was lost")
    if future.status != "error":
        return _read(part, of)
    error = future.exception()
    if isinstance(error, OSError):
        words = "no space is left on the disk" if error.errno == errno.ENOSPC else f"{error.strerror or error}"
        raise _stopped(of, words) from None
    if type(error).__name__ == "KilledWorker":
        raise _stopped(of, "one part ended every worker that computed it; is the memory enough?") from None
    if isinstance(error, ValueError):
        raise _stopped(of, str(error)) from None
    raise _stopped(of, shortened(f"a part failed ({type(error).__name__}: {error})")) from error


def _read(part: int, of: Store) -> Receipt:
    """The receipt of a part that is written; a file system that several machines share may show it late."""
    end = time.monotonic() + LATE
    while time.monotonic() < end:
        receipt = receipts.read(receipts.path(of.path, part))
        if receipt is not None:
            return receipt
        time.sleep(POLL)
    raise _stopped(of, f"part {part} is finished, but its receipt cannot be read here; is it the workers' folder?")


def _stopped(of: Store, words: str) -> StoppedError:
    return StoppedError(f"{of.path}: {words}; {kept(of.path, of.blocks.count)}")
