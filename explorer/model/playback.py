"""The clock of the timeline: which moment of the run is shown, and whether it moves. It is told the time."""

import math

FRAME_RATE = 30.0
"""Frames per second while playing; a late frame is dropped, never made up for."""
STEP = 0.05
"""s: what an arrow key moves."""
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
        """Move on to the clock time `now` (s, monotonic)."""
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
        """Stop at a moment (s). Raises ValueError if it is not a number; beyond an end it is that end."""
        if not math.isfinite(time):
            raise ValueError(f"time must be a finite number, got {time}")
        self.time, self.playing = min(max(time, 0.0), self.duration), False

    def change_speed(self, by: int) -> None:
        """The next slower (-1) or faster (+1) speed."""
        place = SPEEDS.index(self.speed) + by
        self.speed = SPEEDS[min(max(place, 0), len(SPEEDS) - 1)]

    def fit(self, duration: float) -> None:
        """Another run is shown, of another length."""
        self.duration, self.time = duration, min(self.time, duration)

    def wait(self, now: float) -> float | None:
        """How long (s) the session may sleep before the next frame is due; None: until something happens."""
        return max(0.0, self._last + 1.0 / FRAME_RATE - now) if self.playing else None

    def toggle_loop(self) -> None:
        """Begin again at the end, or stop there."""
        self.loop = not self.loop
