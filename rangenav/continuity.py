"""Where a path made of pieces jumps inside its flight: no vehicle follows a path that is not C²."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import Signal, knots, piecewise
from rangenav.signals.piecewise import Pieces
from rangenav.signals.polynomials import COMPLAINTS, Polynomials

DERIVATIVES = (("position", "m"), ("velocity", "m/s"), ("acceleration", "m/s²"), ("jerk", "m/s³"), ("snap", "m/s⁴"))
SNAP = 4
NOTED = 2e-3
"""Share of a derivative's bound: smaller jumps are rounding of printed coefficients."""
LISTED = 4
"""Most jumps of one derivative that a sentence lists; of more it says the largest and the number."""
JOIN = (
    "let position, velocity and acceleration of neighbouring pieces agree at their knots, or draw the path again "
    "through waypoints, which a minimum-snap curve joins"
)
"""What a person can do about a path that jumps."""
CACHED = 16
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
    for polynomial, _, sizes in _inside(path, duration):
        if len(sizes):
            for order, size in enumerate(sizes.max(axis=0).tolist()):
                if not piecewise.is_rounding(polynomial, order, size):
                    largest[order] = max(largest[order], size)
            count += len(sizes)
    position, velocity, acceleration, jerk, snap = (float(f"{size:.3g}") for size in largest)
    return FlightJumps(knots=count, sizes=(position, velocity, acceleration, jerk, snap))


def _inside(path: Signal, duration: float) -> Iterator[tuple[Pieces, Float[Array, "k"], Float[Array, "k 5"]]]:
    """The piecewise polynomials of a path, their knots strictly inside the flight (s), and the sizes of the jumps."""
    for polynomial in knots.pieces(path):
        once, steps = polynomial.knots, piecewise.jumps(polynomial)
        if polynomial.repeats:
            once = np.mod(once, polynomial.duration)
        end = duration * (1 - SAME_TIME)
        inside = (once < end) & ((once > SAME_TIME * end) | (polynomial.repeats & (polynomial.duration < end)))
        yield polynomial, once[inside], np.linalg.norm(steps[inside], axis=-1)


def jump_sentences(path: Signal, duration: float) -> tuple[str, ...]:
    """A sentence for each derivative, from position to snap, that jumps inside the flight: by how much, and when."""
    sentences = []
    for order, (name, unit) in enumerate(DERIVATIVES):
        for polynomial, time, sizes in _inside(path, duration):
            jumping = np.flatnonzero(sizes[:, order] > NOTED * piecewise.hull(polynomial, order))
            if len(jumping) == 0:
                continue
            largest = int(jumping[np.argmax(sizes[jumping, order])])
            shown = jumping if len(jumping) <= LISTED else [largest]
            places = ", ".join(f"{sizes[k, order]:.2g} {unit} at t = {time[k]:.4g} s" for k in shown)
            most = "" if len(jumping) <= LISTED else f" at {len(jumping)} knots, at most"
            sentences.append(f"{name} jumps{most} by {places}")
    return tuple(sentences)


@lru_cache(maxsize=CACHED)
def pieces_alone(path: Signal, duration: float) -> str | None:
    """Why the excitation is that of the pieces of a path alone, as one clause; None if nothing below the snap jumps.

    A jump of the jerk or of a lower derivative is no part of ∫p⁗p⁗ᵀ between the knots, although it does turn the
    functions of which the rank is made.
    """
    jumping = [
        name
        for order, (name, _) in enumerate(DERIVATIVES[:SNAP])
        for polynomial, _, sizes in _inside(path, duration)
        if (sizes[:, order] > NOTED * piecewise.hull(polynomial, order)).any()
    ]
    if not jumping:
        return None
    alone = f"the {jumping[-1]} jumps at knots, and μ counts the pieces between them alone"
    if any(piecewise.hull(polynomial, SNAP) > 0 for polynomial in knots.pieces(path)):
        return alone
    return f"{alone}: these have no snap, so μ is 0, although the jumps raise the rank"


def unflyable_jump(position: float, velocity: float, acceleration: float) -> str | None:
    """One clause if the largest jump of position (m), velocity (m/s) or acceleration (m/s²) is one that nothing can
    follow."""
    sizes = {0: position, 1: velocity, 2: acceleration}
    for order, (name, least, unit) in COMPLAINTS.items():
        if sizes[order] >= least:
            return f"the {name} jumps by {sizes[order]:.2g} {unit}, which nothing can follow"
    return None


@lru_cache(maxsize=CACHED)
def discontinuity(path: Signal, duration: float) -> str | None:
    """One clause if the path jumps in a way that nothing can follow, with the time where that is known; else None."""
    jump = unflyable_jump(*flight_jumps(path, duration).sizes[:3])
    if jump is None:
        return None
    located = _largest(path, duration) if isinstance(path, Polynomials) else None
    return jump if located is None else f"{located}, which nothing can follow"


def _largest(path: Signal, duration: float) -> str | None:
    """The largest jump of the lowest derivative that jumps too much, with its time, as one clause."""
    for order, (name, least, unit) in COMPLAINTS.items():
        jumping = [
            (float(sizes[k, order]), float(time[k]))
            for _, time, sizes in _inside(path, duration)
            for k in range(len(time))
            if sizes[k, order] >= least
        ]
        if jumping:
            size, at = max(jumping)
            return f"{name} jumps by {size:.2g} {unit} at t = {at:.4g} s"
    return None
