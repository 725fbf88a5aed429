"""The clock that all playing pages of a server share: it draws their frames while their sessions rest.

    clock's thread    at each tick: every player's frame          one wake of a thread, however many play
    viser's loop      all frames that were made are written       one wake of the loop for several frames

A session that is busy with a picture gets no frame meanwhile: frames are dropped, never queued. The thread ends when
nobody plays.
"""

import threading
import time
from typing import Protocol

from explorer.model.pace import Pace
from explorer.web.frames import Flight, post

TOGETHER = 8
"""Frames that leave with one wake of viser's loop."""


class Player(Protocol):
    """A page whose run may play."""

    @property
    def plays(self) -> bool:
        """Whether it is to be drawn at the next tick."""
        ...

    def frame(self, now: float) -> Flight | None:
        """Its frame at a time (s, monotonic); None if nothing is to be sent, or the page is busy."""
        ...


class Clock:
    """The clock of one server. Safe for threads."""

    def __init__(self) -> None:
        self._pace, self._lock = Pace(), threading.Lock()
        self._players: tuple[Player, ...] = ()
        self._runs = False

    def follow(self, player: Player) -> None:
        """Draw the frames of a page from now on, as long as it plays."""
        if not player.plays:
            return
        with self._lock:
            if player not in self._players:
                self._players = (*self._players, player)
            if not self._runs:
                self._runs = True
                threading.Thread(target=self._run, name="clock", daemon=True).start()

    def _run(self) -> None:
        due = time.monotonic()
        while True:
            with self._lock:
                self._players = tuple(player for player in self._players if player.plays)
                self._runs = bool(self._players)
                if not self._runs:
                    return
            due = max(due + self._pace.period, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))
            self._tick(due)

    def _tick(self, due: float) -> None:
        late = time.monotonic() - due
        players = self._players
        for first in range(0, len(players), TOGETHER):
            frames = (player.frame(time.monotonic()) for player in players[first : first + TOGETHER])
            post([frame for frame in frames if frame is not None], late, self._pace.observe)
