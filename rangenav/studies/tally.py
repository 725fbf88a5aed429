"""How far a study is: parts, points and runs that are done, the rate, the time left, counted from receipts.

rate = runs of this call / its seconds        left = its seconds / its parts · parts that are missing
"""

import time
from collections import deque
from dataclasses import dataclass
from typing import Literal

from rangenav.studies.receipts import Receipt
from rangenav.studies.store import Store

Stage = Literal["workers", "kernels", "points"]
"""Workers start, kernels compile or are loaded, points are computed."""


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
    workers: int
    """Threads that compute."""
    rate: float
    """Runs per second of this call, or points per second if no metric is of a run."""
    left: float | None
    """s until the end, at this rate; None before the first part."""
    width: float | None
    """The mean over the parts of the relative half width of the watched metric's interval; None without."""
    met: int | None
    """Points that meet the stopping rule; None without one."""
    seconds: float
    """CPU time of the parts that are done."""
    stage: Stage
    """What is done now."""


class Tally:
    """What is done so far, kept as sums: counting takes no time and no memory, however many parts the store has."""

    def __init__(self, of: Store) -> None:
        self._by_runs, self._parts = bool(of.study.file.run_metrics), of.blocks.count
        self._done = self._points = self._invalid = self._runs = self._work = self._computed = 0
        self._width, self._widths, self._seconds = 0.0, 0, 0.0
        self._met = None if of.study.file.stop is None else 0
        there = set()
        for part, receipt in of.done().items():
            there.add(part)
            self._count(receipt)
        self.missing = deque(part for part in range(self._parts) if part not in there)
        self.workers = 0
        self.begin()

    def begin(self) -> None:
        """The time from which on rates are counted."""
        self._began, self._work_before = time.monotonic(), self._work

    def take(self, receipt: Receipt) -> None:
        """Count a part that was computed now."""
        self._computed += 1
        self._count(receipt)

    def state(self, stage: Stage = "points") -> State:
        """How far the study is."""
        seconds, computed = max(time.monotonic() - self._began, 1e-9), self._computed
        return State(
            parts=self._parts,
            done=self._done,
            computed=computed,
            points=self._points,
            invalid=self._invalid,
            runs=self._runs,
            workers=self.workers,
            rate=(self._work - self._work_before) / seconds,
            left=seconds / computed * (self._parts - self._done) if computed else None,
            width=self._width / self._widths if self._widths else None,
            met=self._met,
            seconds=self._seconds,
            stage=stage,
        )

    def _count(self, receipt: Receipt) -> None:
        self._done += 1
        self._seconds += receipt.seconds
        self._points += receipt.points
        self._invalid += receipt.invalid
        self._runs += receipt.runs
        self._work += receipt.runs if self._by_runs else receipt.points
        if self._met is not None:
            self._met += receipt.met or 0
        if receipt.width is not None:
            self._width += receipt.width
            self._widths += 1
