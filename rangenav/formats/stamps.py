"""Clocks that begin again: a counter of 32 bits that overflows, and seconds of the week or of the day at midnight.

Such a clock goes back once by its period less the usual step, and goes on at the usual step. The period is added to
every later stamp, once it is confirmed.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy import ndarray as Array

PERIODS = {"32 bits": 2.0**32, "a week in seconds": 604_800.0, "a day in seconds": 86_400.0}
"""In counts, or in seconds."""
FACTORS = (1.0, 1e-3, 1e3, 1e-6, 1e6, 1e-9, 1e9)
"""A counter may have been converted to another unit, and a week may be counted in ms."""
SLACK = 50.0
"""Usual steps by which the step over the wrap may differ from the period: samples are lost there, too."""
UNWRAP = ("unwrap",)


@dataclass(frozen=True, kw_only=True, eq=False)
class Wraps:
    """The rows before which a clock began again."""

    rows: Int[Array, "k"]
    period: float
    """In the unit of the stamps."""
    name: str

    def unwrapped(self, time: Float[Array, "n"]) -> Float[Array, "n"]:
        """Stamps with the period added from each row on."""
        begun = np.zeros(len(time))
        begun[self.rows] = self.period
        return time + np.cumsum(begun)


def wraps(time: Float[Array, "n"]) -> Wraps | None:
    """Where the clock began again, by the period that explains every step back of that size; None if there is none."""
    steps = np.diff(time)
    forward = steps[steps > 0]
    if len(forward) == 0:
        return None
    usual = float(np.median(forward))
    for name, size in PERIODS.items():
        for factor in FACTORS:
            period = size * factor
            rows = np.flatnonzero(np.abs(steps + period - usual) <= SLACK * usual)
            if len(rows) and period > 2 * SLACK * usual:
                return Wraps(rows=rows + 1, period=period, name=name)
    return None
