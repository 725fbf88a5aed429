"""Long work of one panel: one job at a time, in a thread of its own. The page stays usable while the job runs.

    jobs.start("100 seeds", work, done, failed)     work(progress, cancelled) -> result, in the job's thread
    jobs.deliver()                                  done(result) or failed(sentence), in the session's loop

This is the only way from a thread to the page: a job never writes to the page, and `deliver` drops the result of a job
that was cancelled or replaced. The jobs of all visitors take turns (`explorer.model.turns`).
"""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from explorer.model.turns import Places, Share, Turn
from rangenav.progress import Cancelled, CancelledError, Progress

T = TypeVar("T")
Work = Callable[[Progress, Cancelled], T]
REPORT_PERIOD = 0.1
"""s between two wake-ups of the session's loop by a running job, to show its progress."""


@dataclass(eq=False)
class Job:
    """One piece of long work."""

    name: str
    work: Work[Any]
    done: Callable[[Any], None]
    failed: Callable[[str], None]
    turn: Turn | None = None
    fraction: float = 0.0
    cancelled: bool = False
    finished: bool = False
    result: Any = None
    error: Exception | None = None

    @property
    def ahead(self) -> int:
        """How many jobs of all visitors work or wait before this one; 0 while it works."""
        return 0 if self.turn is None or self.finished else self.turn.ahead


class Jobs:
    """At most one job; starting another cancels it."""

    def __init__(self, wake: Callable[[], None], share: Share | None = None) -> None:
        """`wake` wakes the session's loop; it is called from the job's thread. `share`: the visitor's share of the
        places of the server; None for places of its own."""
        self._wake, self._share = wake, share or Places().share()
        self._job: Job | None = None
        self._reported_at = float("-inf")

    @property
    def running(self) -> Job | None:
        """The job that is running, or whose result has not been delivered yet."""
        return self._job

    def start(self, name: str, work: Work[T], done: Callable[[T], None], failed: Callable[[str], None]) -> Job:
        """Start a job. `deliver` calls `done` with the result, or `failed` with a sentence if the work raised
        ValueError. For a cancelled job it calls neither."""
        self.cancel()
        job = self._job = Job(name, work, done, failed)
        turn = job.turn = self._share.turn(lambda: job.cancelled, self._wake)
        threading.Thread(target=self._run, args=(job, turn), name=f"job {name}", daemon=True).start()
        return job

    def cancel(self) -> None:
        """Ask the running job to stop, and drop its result."""
        if self._job is not None:
            self._job.cancelled = True
            self._job = None
            self._share.wake()
            self._wake()

    def drop(self, job: Job | None) -> None:
        """Cancel a job, unless it has ended or another one runs by now."""
        if job is not None and self._job is job:
            self.cancel()

    def deliver(self) -> None:
        """Hand over the result of a finished job. Raises what the work raised, except ValueError and CancelledError."""
        job = self._job
        if job is None or not job.finished:
            return
        self._job = None
        match job.error:
            case None:
                job.done(job.result)
            case ValueError() as error:
                job.failed(str(error))
            case CancelledError():
                return
            case error:
                raise error

    def _run(self, job: Job, turn: Turn) -> None:
        def progress(fraction: float) -> None:
            job.fraction = min(max(fraction, 0.0), 1.0)
            now = time.monotonic()
            if now - self._reported_at > REPORT_PERIOD:
                self._reported_at = now
                self._wake()

        def cancelled() -> bool:
            turn.go_on()
            return job.cancelled

        try:
            turn.wait()
            self._wake()
            job.result = job.work(progress, cancelled)
        except (ValueError, CancelledError) as error:
            job.error = error.with_traceback(None)  # which would hold this frame, and with it the job
        except Exception as error:
            job.error = error
        finally:
            turn.end()
        job.finished, job.turn = True, None  # the turn holds the job: what it has worked on goes with its last user
        self._wake()
