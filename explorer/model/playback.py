"""The clock of the timeline: the time in the run that is shown, and whether it advances. Callers pass the time."""

import math

STEP = 0.05
"""s by which an arrow key moves the playhead."""
SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)


class Playback:
    """A playhead between 0 and `duration` (s)."""

    def __init__(self, duration: float) -> None:
        self.duration = duration
        self.time = 0.0
        self.speed = 1.0
        self.playing = False
        self.loop = True
        self._last = 0.0

    def advance(self, now: float) -> None:
        """Move the playhead on to the clock time `now` (s, monotonic)."""
        elapsed, self._last = now - self._last, now
        if not self.playing:
            return
        self.time += elapsed * self.speed
        if self.time <= self.duration:
            return
        if self.loop:
            self.time = math.fmod(self.time, self.duration)
        else:
            self.time, self.playing = self.duration, False

    def toggle(self, now: float) -> None:
        """Play or pause; at the end, play again from the start."""
        self.playing, self._last = not self.playing, now
        if self.playing and self.time >= self.duration:
            self.time = 0.0

    def seek(self, time: float) -> None:
        """Stop at a moment (s), at most at an end of the run. Raises ValueError if it is not finite."""
        if not math.isfinite(time):
            raise ValueError(f"time must be a finite number, got {time}")
        self.time, self.playing = min(max(time, 0.0), self.duration), False

    def restore(self, time: float, speed: float, *, loop: bool) -> None:
        """Take over the time (s), the speed and the loop of an earlier visit; an unknown speed is ignored."""
        self.duration = max(self.duration, time)
        self.seek(time)
        self.speed, self.loop = speed if speed in SPEEDS else self.speed, loop

    def change_speed(self, by: int) -> None:
        """The next slower (-1) or faster (+1) speed."""
        index = SPEEDS.index(self.speed) + by
        self.speed = SPEEDS[min(max(index, 0), len(SPEEDS) - 1)]

    def fit(self, duration: float) -> None:
        """Take over the duration (s) of another run."""
        self.duration, self.time = duration, min(self.time, duration)

    def toggle_loop(self) -> None:
        """Switch between looping and stopping at the end."""
        self.loop = not self.loop
