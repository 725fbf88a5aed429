"""Checks of a signal that need the flight: is the signal finite there, and is it not too much work?"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.inputs import Vec3, require
from rangenav.signals.families import Signal
from rangenav.signals.multirotor import Flown, refuse_undefined

MAX_WORK = 5e7
"""Most operations of a formula × times at which it is evaluated: a second on a small machine, at 20 ns each."""
CHECK_SAMPLES = 4001
"""Times at which derivatives are checked before a run; every evaluation checks its own times again."""
CACHED = 64


def refuse_work(signal: Signal, *, moments: float) -> None:
    """Raise ValueError, before anything is evaluated, if the signal's formulas are too long for so many moments."""
    count = signal.operations()
    rule = f"a formula of {count} operations at {moments:.0f} moments is too much work: shorten it, flight or window"
    require(count * moments <= MAX_WORK, rule)


@lru_cache(maxsize=CACHED)
def refuse_wild(signal: Signal, *, duration: float, rate: float, highest: int) -> None:
    """Raise ValueError naming axis and time where a formula or a derivative, up to the highest, is not finite."""
    if signal.operations() == 0:
        return
    time = _moments(duration, rate)
    for order in range(highest + 1):
        signal(time, order)


@lru_cache(maxsize=CACHED)
def refuse_fallen(flown: Flown, path: Signal, *, gravity: Vec3, duration: float, rate: float) -> None:
    """Raise ValueError naming the time if flying the path has no attitude somewhere."""
    refuse_undefined(flown, path, gravity, _moments(duration, rate))


def _moments(duration: float, rate: float) -> Float[Array, "n"]:
    return np.linspace(0, duration, min(CHECK_SAMPLES, int(duration * rate) + 1))
