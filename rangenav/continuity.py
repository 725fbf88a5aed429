"""Where a path made of pieces jumps inside its flight: no vehicle follows a jump of position or velocity."""

from dataclasses import dataclass

import numpy as np

from rangenav.signals import Signal, knots, piecewise
from rangenav.signals.polynomials import COMPLAINTS, Polynomials, complaints

SAME_TIME = 1e-9
"""Share of the flight. A knot nearer than that to the flight's beginning or end counts as its beginning or end."""


@dataclass(frozen=True, kw_only=True)
class FlightJumps:
    """The largest jumps at knots strictly inside a flight, each to three digits."""

    knots: int
    """How many knots lie inside the flight."""
    sizes: tuple[float, float, float, float, float]
    """Of position (m), velocity (m/s), acceleration (m/s²), jerk (m/s³) and snap (m/s⁴)."""


def flight_jumps(path: Signal, duration: float) -> FlightJumps:
    """The largest jump of each derivative within (0, duration) seconds; 0 where a jump is rounding."""
    largest, count = np.zeros(len(piecewise.JUMP_ORDERS)), 0
    for pieces in knots.pieces(path):
        once, steps = pieces.knots, piecewise.jumps(pieces)
        if pieces.repeats:
            once = np.mod(once, pieces.duration)
        end = duration * (1 - SAME_TIME)
        inside = (once < end) & ((once > SAME_TIME * end) | (pieces.repeats & (pieces.duration < end)))
        if inside.any():
            sizes = np.linalg.norm(steps[inside], axis=-1).max(axis=0)
            rounding = [piecewise.JUMP_ROUNDING * piecewise.hull(pieces, order) for order in piecewise.JUMP_ORDERS]
            largest = np.maximum(largest, np.where(sizes > rounding, sizes, 0.0))
            count += int(inside.sum())
    position, velocity, acceleration, jerk, snap = (float(f"{size:.3g}") for size in largest)
    return FlightJumps(knots=count, sizes=(position, velocity, acceleration, jerk, snap))


def unflyable_jump(position: float, velocity: float) -> str | None:
    """One clause if the largest jump of position (m) or of velocity (m/s) is one that nothing can follow."""
    sizes = {0: position, 1: velocity}
    for order, (name, least, unit) in COMPLAINTS.items():
        if sizes[order] >= least:
            return f"the {name} jumps by {sizes[order]:.2g} {unit}, which nothing can follow"
    return None


def discontinuity(path: Signal, duration: float) -> str | None:
    """One clause if the path jumps in a way that nothing can follow, with the time where that is known; else None."""
    position, velocity = flight_jumps(path, duration).sizes[:2]
    jump = unflyable_jump(position, velocity)
    if jump is None:
        return None
    located = complaints(path, inside=(0, duration)) if isinstance(path, Polynomials) else ()
    return f"{located[0]}, which nothing can follow" if located else jump
