"""How often playing pages are drawn: less often while the server is late, so that no picture waits for a frame.

    period = 1 / RATE + GAIN max(0, lateness - USUAL),     at most 1 / LEAST_RATE

All pages of a server share one pace, because they share its processor. The lateness is a running mean over frames: the
time from when a frame was due to when it left.
"""

RATE, LEAST_RATE = 20.0, 4.0
"""Frames per second of a server that has time, and of one that has none."""
USUAL, GAIN = 0.005, 4.0
"""s by which frames may be late at the full rate, and how much a lateness beyond it lengthens the period."""
WEIGHT = 1 / 16
"""The weight of one frame in the running mean."""


class Pace:
    """The pace of one server. Safe for threads: a lost update is one frame that does not count."""

    def __init__(self) -> None:
        self.lateness = 0.0
        """s; running mean."""

    def observe(self, lateness: float) -> None:
        """Take in how late (s) a frame was."""
        self.lateness += WEIGHT * (lateness - self.lateness)

    @property
    def period(self) -> float:
        """s from one frame to the next."""
        return min(1.0 / RATE + GAIN * max(0.0, self.lateness - USUAL), 1.0 / LEAST_RATE)
