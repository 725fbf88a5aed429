"""The places for long work on one server, shared fairly: whoever has had the least time goes next.

    turn = share.turn(cancelled, moved)
    turn.wait()                        until there is a place
    turn.go_on()                       now and then: gives the place to somebody who has had less, and waits again
    turn.end()

A job asks whether it was cancelled many times a second (`explorer.model.jobs`), and that is when it may have to wait.
So a short job of one visitor waits for no more than a slice of the long jobs of the others.
"""

import itertools
import os
import threading
import time
from collections.abc import Callable

from rangenav.progress import CancelledError

PLACES = os.cpu_count() or 1
"""Jobs that work at the same time on one server."""
SLICE = 1.0
"""s that a job may work before it gives its place to a visitor who has had less."""


class Places:
    """The places of one server."""

    def __init__(self, count: int = PLACES, clock: Callable[[], float] = time.monotonic) -> None:
        self.count, self.clock = count, clock
        self.changed = threading.Condition()
        self.working: set[Turn] = set()
        self.waiting: set[Turn] = set()
        self.numbers = itertools.count()

    def share(self) -> "Share":
        """The share of one more visitor."""
        return Share(self)

    def next(self) -> "Turn":
        """Who of those who wait gets the next place: the visitor with the fewest places and the least time; of these
        the one who has waited longest."""
        return min(self.waiting, key=lambda turn: turn.rank)


class Share:
    """What one visitor has of the places: the jobs at work, and the time (s) that they have worked since the visitor
    last had none."""

    def __init__(self, places: Places) -> None:
        self.places = places
        self.working, self.jobs, self.used = 0, 0, 0.0

    def turn(self, cancelled: Callable[[], bool], moved: Callable[[], None]) -> "Turn":
        """A turn for one more job, which does not wait for a place yet. `moved` is called when its place in the queue
        may have changed, from a thread of the job."""
        with self.places.changed:
            self.used = self.used if self.jobs else 0.0
            self.jobs += 1
            return Turn(self, cancelled, moved)

    def wake(self) -> None:
        """Let waiting jobs look whether they were cancelled."""
        with self.places.changed:
            self.places.changed.notify_all()


class Turn:
    """The turn of one job."""

    def __init__(self, share: Share, cancelled: Callable[[], bool], moved: Callable[[], None]) -> None:
        self.share, self._places, self._cancelled, self._moved = share, share.places, cancelled, moved
        self._number, self._since = next(self._places.numbers), 0.0

    @property
    def ahead(self) -> int:
        """How many jobs work or wait before this one; 0 while it has a place."""
        places = self._places
        with places.changed:
            if self in places.working:
                return 0
            return len(places.working) + sum(turn.rank < self.rank for turn in places.waiting)

    @property
    def rank(self) -> tuple[int, float, int]:
        """The order of those who wait; the smallest is first."""
        return self.share.working, self.share.used, self._number

    def wait(self) -> None:
        """Wait for a place. Raises CancelledError if the job is cancelled meanwhile; its turn has then ended."""
        places = self._places
        with places.changed:
            self._number = next(places.numbers)
            places.waiting.add(self)
            while not self._cancelled():
                if len(places.working) < places.count and places.next() is self:
                    self._take()
                    return
                self._moved()
                places.changed.wait()
            places.waiting.discard(self)
            self.share.jobs -= 1
            places.changed.notify_all()
        raise CancelledError

    def go_on(self) -> None:
        """Give the place to a visitor who has had less, if the slice is over, and wait for the next one."""
        places = self._places
        if not places.waiting or places.clock() - self._since < SLICE:
            return
        with places.changed:
            if self not in places.working:  # a thread of the same job has given it away a moment ago
                return
            self._give_back()
            if not places.waiting or places.next().rank >= self.rank:
                self._take()
                return
            places.changed.notify_all()
        self.wait()

    def end(self) -> None:
        """Give the place back: the job has ended."""
        with self._places.changed:
            if self in self._places.working:
                self._give_back()
                self.share.jobs -= 1
            self._places.changed.notify_all()

    def _take(self) -> None:
        self._places.waiting.discard(self)
        self._places.working.add(self)
        self.share.working += 1
        self._since = self._places.clock()
        self._places.changed.notify_all()  # there may be a place for the next one

    def _give_back(self) -> None:
        self._places.working.discard(self)
        self.share.working -= 1
        self.share.used += self._places.clock() - self._since
