"""What can only be said of a signal once the flight is known: is it finite on it, and is it not too much work?"""

from functools import lru_cache

import numpy as np

from rangenav.inputs import require
from rangenav.signals import expressions
from rangenav.signals.families import Signal, Sum
from rangenav.signals.formula import Formula
from rangenav.signals.multisine import AXES

MAX_WORK = 2e7
"""Operations × samples of a formula over a flight; about a second on a small machine."""
CHECK_SAMPLES = 4001
"""Times at which derivatives are looked at before a run; every evaluation looks again at its own."""
CACHED = 64


def operations(signal: Signal) -> int:
    """How many operations the signal's formulas have, 0 if it has none."""
    match signal:
        case Formula():
            return sum(expressions.size(expressions.parse(getattr(signal, axis))) for axis in AXES)
        case Sum():
            return operations(signal.base) + operations(signal.wiggle)
        case _:
            return 0


@lru_cache(maxsize=CACHED)
def refuse_wild(signal: Signal, *, duration: float, rate: float, highest: int) -> None:
    """Raise ValueError naming axis and time where a formula or a derivative, up to the highest, is not finite."""
    count = operations(signal)
    if count == 0:
        return
    samples = duration * rate
    rule = f"a formula of {count} operations over {samples:.0f} samples is too much work: shorten one of them"
    require(count * samples <= MAX_WORK, rule)
    time = np.linspace(0, duration, min(CHECK_SAMPLES, int(samples) + 1))
    for order in range(highest + 1):
        signal(time, order)
