"""How fast the observer's error fades, a stage of a picture: the error without noise, its contraction, and its rate.

Like `details` it is computed at its first use; it takes 20 ms, and on blind motions 150 ms.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Complex
from numpy import ndarray as Array

from rangenav import error_dynamics, record
from rangenav.error_dynamics import ONLY_CONSTANT, ErrorDynamics
from rangenav.gains import Gains
from rangenav.number_format import quantity, significant
from rangenav.preset import Preset
from rangenav.record import SETTLED_POSITION, Summary, TruthInputs
from rangenav.sensors import Sensors

CACHED = 4
SAME = 0.005
"""Share by which two times may differ that count as equal."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Convergence:
    """The dynamics of the error of one run with constant gains."""

    dynamics: ErrorDynamics
    period: float | None
    """s, of the path."""
    multipliers: Complex[Array, "13"] | None
    reason: str
    """Why there are no multipliers."""


def convergence(preset: Preset) -> Convergence | None:
    """The error dynamics of a preset's run; None with noise-matched gains, whose error is not linear."""
    if preset.gains.mode != "constant":
        return None
    dynamics = _dynamics(preset)
    multipliers, reason = _multipliers(record.truth_inputs(preset), preset.sensors, preset.gains)
    return Convergence(dynamics=dynamics, period=preset.path.period, multipliers=multipliers, reason=reason)


def sentences(of: Convergence | None, summary: Summary) -> tuple[str, ...]:
    """The settling time that follows from the gains beside the one of this run, and the rate in the long run."""
    if of is None:
        return (f"{ONLY_CONSTANT[0].upper()}{ONLY_CONSTANT[1:]}: their error is not linear.",)
    limit = quantity(SETTLED_POSITION, "m")
    return (
        f"Without noise the position error {_since(of.dynamics.settle_s, limit)}."
        f" In this run it {_since(summary.settle_position_s, limit)}.",
        _rate(of),
    )


def _since(time: float | None, limit: str) -> str:
    return f"does not settle below {limit}" if time is None else f"stays below {limit} from {quantity(time, 's')} on"


def _rate(of: Convergence) -> str:
    if of.multipliers is None:
        return f"There is no rate in the long run: {of.reason}."
    slowest = float(np.abs(of.multipliers).max())
    return (
        f"In the long run the slowest part of an error falls to 1/e in {quantity(_constant(of), 's')}: each period of"
        f" {quantity(_period(of), 's')} multiplies it by {significant(slowest)} (the largest Floquet multiplier)."
        " The position may settle earlier, where the initial error has little of that part."
    )


def _period(of: Convergence) -> float:
    return of.period or error_dynamics.ANY_PERIOD


def _constant(of: Convergence) -> float:
    """s; infinite where an error does not fade, or where nothing is known."""
    return math.inf if of.multipliers is None else error_dynamics.time_constant(of.multipliers, _period(of))


def which_is_faster(a: Convergence | None, b: Convergence | None) -> tuple[str, ...]:
    """Sentences on which of two runs settles sooner without noise, and whose error fades faster in the long run."""
    if a is None or b is None:
        return ()
    settling, fading = (a.dynamics.settle_s, b.dynamics.settle_s), (_constant(a), _constant(b))
    return (
        f"Without noise {_sooner(settling[0], settling[1])}.",
        f"In the long run the slowest part of an error fades {_faster(*fading)}.",
    )


def _sooner(a: float | None, b: float | None) -> str:
    if a is None or b is None:
        alone = "A" if a is not None else "B"
        return "neither A nor B settles" if a is b else f"{alone} settles and the other one does not"
    if abs(a - b) <= SAME * max(a, b):
        return "A and B settle at the same time"
    return f"{'B' if b < a else 'A'} settles {quantity(abs(a - b), 's')} sooner"


def _faster(a: float, b: float) -> str:
    if math.isinf(a) or math.isinf(b):
        return "in neither" if a == b else f"in {'A' if b > a else 'B'} only"
    if abs(a - b) <= SAME * max(a, b):
        return "equally fast in A and B"
    return f"{significant(max(a, b) / min(a, b))} times as fast in {'B' if b < a else 'A'}"


@lru_cache(maxsize=CACHED)
def _dynamics(preset: Preset) -> ErrorDynamics:
    return error_dynamics.of(preset)


@lru_cache(maxsize=CACHED)
def _multipliers(inputs: TruthInputs, sensors: Sensors, gains: Gains) -> tuple[Complex[Array, "13"] | None, str]:
    return error_dynamics.multipliers(inputs.path, inputs.world, sensors, gains)
