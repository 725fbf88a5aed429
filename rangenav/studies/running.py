"""Running a study: parts are dealt out, each writes itself into the store, and what is done is never computed again.

Any number of workers and any order give the same store. If the program, a worker, all workers, the scheduler or the
machine ends at any moment, the same call goes on with the parts that are missing.
"""

import errno
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

import numpy as np

from rangenav.inputs import require
from rangenav.progress import Cancelled, CancelledError, never
from rangenav.studies import cluster, extra, plan, receipts, store, tasks
from rangenav.studies.receipts import Receipt
from rangenav.studies.store import Store
from rangenav.studies.study import Study

AHEAD = 3
"""Tasks that the scheduler holds for each thread: no worker waits for this program, and a stop drops few."""
POLL = 0.25
"""s between two looks at `cancelled`."""
RECOUNT = 5.0
"""s between two counts of the workers, which may come and go."""


class StoppedError(ValueError):
    """The study could not go on; what was done is kept."""


@dataclass(frozen=True, kw_only=True)
class State:
    """How far a study is."""

    parts: int
    done: int
    """Parts in the store."""
    computed: int
    """Parts of them that this call computed."""
    points: int
    """Points of the parts that are done."""
    invalid: int
    runs: int
    rate: float
    """Runs per second of this call, or points per second if no metric is of a run."""
    left: float | None
    """s until the end, at this rate; None before the first part."""
    width: float | None
    """The median over the parts of the relative half width of the watched metric's interval; None without."""


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
    of = _opened(study, path)
    with of.locked():
        tally = _Tally(of, of.done())
        shown(tally.state())
        if tally.missing:
            with cluster.connected(client, workers=workers, scheduler=scheduler, dashboard=dashboard) as connected:
                cluster.compile_everywhere(connected, str(of.path), study.digest)
                tally.begin()
                _deal(connected, of, tally, shown, cancelled)
        return tally.state()


def _opened(study: Study, path: Path) -> Store:
    """The store of this study, which is made if there is none."""
    if not path.exists():
        return store.created(path, study, plan.divided(study, plan.cost(study)))
    of = store.opened(path)
    rule = f"{path}: holds another study, {of.study.file.title!r}; choose another store"
    require(of.study.digest == study.digest, rule)
    return of


def kept(path: Path, parts: int) -> str:
    """What is kept of a study that was stopped, as a clause for a person."""
    return f"{sum(1 for _ in receipts.written(path))} of {parts} parts are kept, and the same command goes on"


class _Tally:
    """The receipts so far."""

    def __init__(self, of: Store, done: dict[int, Receipt]) -> None:
        self._of, self.done, self._before = of, done, len(done)
        self.missing = deque(part for part in range(of.blocks.count) if part not in done)
        self._runs_before = sum(self._work(one) for one in done.values())
        self.begin()

    def begin(self) -> None:
        """The time from which on rates are counted."""
        self._began = time.monotonic()

    def take(self, receipt: Receipt) -> None:
        """Count a part, once."""
        self.done[receipt.part] = receipt

    def state(self) -> State:
        """How far the study is."""
        count, done = self._of.blocks.count, self.done.values()
        computed = len(self.done) - self._before
        seconds = max(time.monotonic() - self._began, 1e-9)
        work = sum(self._work(one) for one in done) - self._runs_before
        widths = [one.width for one in done if one.width is not None]
        return State(
            parts=count,
            done=len(self.done),
            computed=computed,
            points=sum(one.points for one in done),
            invalid=sum(one.invalid for one in done),
            runs=sum(one.runs for one in done),
            rate=work / seconds if computed else 0.0,
            left=seconds / computed * (count - len(self.done)) if computed else None,
            width=float(np.median(widths)) if widths else None,
        )

    def _work(self, receipt: Receipt) -> int:
        return receipt.runs if self._of.study.file.run_metrics else receipt.points


def _deal(client: Any, of: Store, tally: _Tally, shown: Shown, cancelled: Cancelled) -> None:
    """Keep the workers busy until every part has its receipt."""
    finished: SimpleQueue[Any] = SimpleQueue()
    waiting: set[Any] = set()
    room, counted = 0, -RECOUNT
    try:
        while tally.missing or waiting:
            if time.monotonic() - counted >= RECOUNT:
                room, counted = AHEAD * max(1, cluster.threads(client)), time.monotonic()
            while tally.missing and len(waiting) < room:
                part = tally.missing.popleft()
                future = client.submit(tasks.compute, str(of.path), of.study.digest, part, key=_key(of, part))
                waiting.add(future)
                future.add_done_callback(finished.put)
            if cancelled():
                raise CancelledError
            try:
                future = finished.get(timeout=POLL)
            except Empty:
                continue
            waiting.discard(future)
            tally.take(_receipt(future, of))
            future.release()
            shown(tally.state())
    except OSError as error:  # of the connection to the scheduler
        raise _stopped(of, f"the scheduler does not answer ({type(error).__name__})") from None
    finally:
        for future in waiting:
            future.cancel()


def _key(of: Store, part: int) -> str:
    """A task's name on the scheduler; its number makes a second program's task another one."""
    return f"rangenav-study-{of.study.digest[:12]}-{part}-{time.monotonic_ns()}"


def _receipt(future: Any, of: Store) -> Receipt:
    """The receipt of a part that is finished. Raises StoppedError in one sentence if it could not be computed."""
    if future.status == "cancelled":
        raise _stopped(of, "the scheduler was lost")
    if future.status == "finished":
        try:
            return future.result(timeout=60)
        except (OSError, RuntimeError) as error:
            raise _stopped(of, f"the scheduler was lost ({type(error).__name__})") from None
    error = future.exception()
    if isinstance(error, OSError):
        words = "no space is left on the disk" if error.errno == errno.ENOSPC else f"{error.strerror or error}"
        raise _stopped(of, words) from None
    if type(error).__name__ == "KilledWorker":
        raise _stopped(of, "one part ended every worker that computed it; is the memory enough?") from None
    if isinstance(error, ValueError):
        raise _stopped(of, str(error)) from None
    assert error is not None
    raise error


def _stopped(of: Store, words: str) -> StoppedError:
    return StoppedError(f"{of.path}: {words}; {kept(of.path, of.blocks.count)}")
