"""Long work of one visitor: one job at a time in a thread of its own, with progress, a way to stop, and a result that
the session's loop takes over. The rest of the page stays usable.

    jobs.start("100 seeds", work, done)         work(progress, cancelled) -> result, in the job's thread
    jobs.deliver()                              done(result) in the session's loop; None if nothing is finished
"""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from rangenav.ensemble import Stopped

T = TypeVar("T")
Progress = Callable[[float], None]
"""Told how much is done, 0 to 1."""
Cancelled = Callable[[], bool]
Work = Callable[[Progress, Cancelled], T]
NEWS = 0.1
"""s between two looks of the session at how far a job is."""


@dataclass(eq=False)
class Job:
    """One piece of long work."""

    name: str
    work: Work[Any]
    done: Callable[[Any], None]
    failed: Callable[[str], None]
    fraction: float = 0.0
    cancelled: bool = False
    finished: bool = False
    result: Any = None
    error: Exception | None = None


class Jobs:
    """At most one job of one visitor; starting another cancels it."""

    def __init__(self, wake: Callable[[], None]) -> None:
        """`note` wakes the session's loop, from the job's thread."""
        self._wake = wake
        self._job: Job | None = None
        self._told = float("-inf")

    @property
    def running(self) -> Job | None:
        """The job at work, or whose result has not been taken over yet."""
        return self._job

    def start(self, name: str, work: Work[T], done: Callable[[T], None], failed: Callable[[str], None]) -> None:
        """Begin. `done` gets the result, `failed` a sentence if the work raised ValueError; both in the session's loop.
        A job that was cancelled reports to neither."""
        self.cancel()
        job = self._job = Job(name, work, done, failed)
        threading.Thread(target=self._run, args=(job,), name=f"job {name}", daemon=True).start()

    def cancel(self) -> None:
        """Stop the job at work, as soon as it looks; its result is not wanted any more."""
        if self._job is not None:
            self._job.cancelled = True
            self._job = None
            self._wake()

    def deliver(self) -> None:
        """Hand over what is finished. Raises what the work raised, but for ValueError and Stopped."""
        job = self._job
        if job is None or not job.finished:
            return
        self._job = None
        if isinstance(job.error, ValueError):
            job.failed(str(job.error))
        elif isinstance(job.error, Stopped):
            return
        elif job.error is not None:
            raise job.error
        else:
            job.done(job.result)

    def _run(self, job: Job) -> None:
        def progress(fraction: float) -> None:
            job.fraction = min(max(fraction, 0.0), 1.0)
            now = time.monotonic()
            if now - self._told > NEWS:
                self._told = now
                self._wake()

        try:
            job.result = job.work(progress, lambda: job.cancelled)
        except Exception as error:
            job.error = error
        job.finished = True
        self._wake()
