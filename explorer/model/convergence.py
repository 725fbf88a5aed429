"""How fast the observer's error fades, a stage of a picture: the error without noise, its contraction, and its rate.

Like `details` it is computed at its first use; it takes 20 ms, and on blind motions 150 ms.
"""

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
    """The settling time that follows from the gains beside the one of this run, and the rate for good."""
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
        return f"No rate for good: {of.reason}."
    period = of.period or error_dynamics.ANY_PERIOD
    constant, slowest = error_dynamics.time_constant(of.multipliers, period), float(np.abs(of.multipliers).max())
    return (
        f"For good, the slowest error falls to 1/e in {quantity(constant, 's')}: each period of"
        f" {quantity(period, 's')} multiplies it by {significant(slowest)} (the largest Floquet multiplier)."
    )


@lru_cache(maxsize=CACHED)
def _dynamics(preset: Preset) -> ErrorDynamics:
    return error_dynamics.of(preset)


@lru_cache(maxsize=CACHED)
def _multipliers(inputs: TruthInputs, sensors: Sensors, gains: Gains) -> tuple[Complex[Array, "13"] | None, str]:
    return error_dynamics.multipliers(inputs.path, inputs.world, sensors, gains)
