"""A supply that fills up again, by which attempts, messages and bytes are limited.

level(t) = min(size, level(t₀) + rate·(t − t₀));  each use takes its amount
"""

from dataclasses import dataclass


@dataclass
class Bucket:
    """A supply of attempts, messages or bytes."""

    size: float
    rate: float
    """1/s."""
    level: float
    at: float
    """s, when the level was as stated."""

    def wait(self, now: float) -> float:
        """s until there is one; 0 if there is one now."""
        self.level = min(self.size, self.level + self.rate * max(0.0, now - self.at))
        self.at = now
        return max(0.0, (1.0 - self.level) / self.rate)

    def take(self) -> None:
        """Take one."""
        self.level -= 1.0

    def charge(self, amount: float, now: float) -> float:
        """Take an amount, also one that is not there. Returns the s until the debt is paid; 0 without one."""
        self.wait(now)
        self.level -= amount
        return max(0.0, -self.level / self.rate)
