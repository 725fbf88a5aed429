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

    def wait(self, now: float, amount: float = 1.0) -> float:
        """s until there is an amount, by default one; 0 if it is there now."""
        self.level = min(self.size, self.level + self.rate * max(0.0, now - self.at))
        self.at = now
        return max(0.0, (amount - self.level) / self.rate)

    def take(self, amount: float = 1.0) -> None:
        """Take an amount, by default one."""
        self.level -= amount

    def charge(self, amount: float, now: float) -> float:
        """Take an amount, also one that is not there. Returns the s until the debt is paid; 0 without one."""
        self.wait(now)
        self.level -= amount
        return max(0.0, -self.level / self.rate)
