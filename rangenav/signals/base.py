"""What the library asks of a signal. Every family answers for itself, or names an equivalent signal of another family.

A new family is one file with a Struct derived from `SignalBase`, and one line in `families.Family`. It defines either
`equivalent`, whose answers then serve for every question, or answers of its own.
"""

from typing import Any

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import fields
from rangenav.inputs import Input, Vec3
from rangenav.signals.piecewise import Pieces

ROUNDING_MARGIN = 1 + 1e-12
"""Factor on a bound: rounding in the bound's own arithmetic takes away less."""


class SignalBase(Input, frozen=True):
    """Base of every signal in R³: each method answers as the equivalent signal does, unless a family overrides it."""

    def __post_init__(self) -> None:
        super().__post_init__()
        fields.check(self)

    def equivalent(self) -> "SignalBase":
        """The same function of time as a signal of another family, no Sum."""
        raise NotImplementedError(f"{type(self).__name__} must define equivalent(), or every method of SignalBase")

    def __call__(self, t: Float[Array, "*n"], order: int = 0) -> Float[Array, "*n 3"]:
        """The derivative of the given order at times t (s), exact and not differenced."""
        return self.equivalent()(t, order)

    @property
    def bandwidth(self) -> float:
        """The highest frequency present (rad/s); infinite where there is none for all time."""
        return self.equivalent().bandwidth

    @property
    def period(self) -> float | None:
        """s after which all but the straight part repeats; 0 if there is only that part, None if nothing repeats."""
        return self.equivalent().period

    @property
    def bound_stretches(self) -> int:
        """Equal stretches of a flight, on each of which derivatives are bounded by themselves; 1 if one bound does."""
        return self.equivalent().bound_stretches

    def bandwidth_until(self, time: float) -> float:
        """The highest frequency present (rad/s) from 0 to a time (s): finite even for a chirp."""
        return self.equivalent().bandwidth_until(time)

    def bound(self, order: int) -> float:
        """A bound on the norm of the derivative at every t ≥ 0, no sample; infinite if none is known."""
        return self.equivalent().bound(order)

    def derivative_bounds(self, edges: Float[Array, "k"], orders: range) -> Float[Array, "o m"]:
        """Bounds on the norms of derivatives (order 2 or more) on the open stretches between neighbouring edges (s).

        No knot may lie inside a stretch. Infinite where none is known.
        """
        return self.equivalent().derivative_bounds(edges, orders)

    def rounding_bound(self, edges: Float[Array, "k"]) -> float:
        """How far a computed value may be from the exact one at that time, between the first and the last edge (s).

        In the signal's unit, divided by the rounding ε of one number; infinite where no bound is known.
        """
        return self.equivalent().rounding_bound(edges)

    def jet(self, t: Float[Array, "n"], highest: int) -> Float[Array, "o n 3"]:
        """The signal and its derivatives up to the highest order (1 at least) at times t (s), in one pass."""
        return self.equivalent().jet(t, highest)

    def operations(self) -> int:
        """How many operations of formulas one evaluation costs; 0 without formulas."""
        return self.equivalent().operations()

    def parts(self) -> tuple["SignalBase", ...]:
        """The signals whose sum it is, apart from a straight line: the signal itself, or both parts of a Sum."""
        return (self,)

    def piecewise(self) -> Pieces | None:
        """The polynomials between knots that the signal is made of; None if it is no piecewise polynomial."""
        return self.equivalent().piecewise()

    def slowed(self, factor: float) -> Any:
        """The signal s(t / factor)."""
        return self.equivalent().slowed(factor)

    def mapped(self, matrix: Float[Array, "3 3"], shift: Float[Array, "3"]) -> Any:
        """matrix · signal + shift."""
        return self.equivalent().mapped(matrix, shift)

    def curved_part(self) -> Any:
        """The signal without its straight part, which second and higher derivatives do not see.

        A signal without offset and drift of its own is moved to begin at 0, so that far-off places cost no digits.
        """
        return self.mapped(np.eye(3), -self(np.zeros(())))


def vector(values: Float[Array, "3"]) -> Vec3:
    """Three numbers of Python."""
    x, y, z = (float(value) for value in values)
    return x, y, z


def divided(values: Vec3, factor: float) -> Vec3:
    """A vector divided by a number."""
    x, y, z = values
    return x / factor, y / factor, z / factor


def add_line(every: Float[Array, "o n 3"], t: Float[Array, "n"], *, offset: Vec3, drift: Vec3) -> None:
    """Add offset + drift t to a signal and its derivatives, in place."""
    every[0] += np.asarray(offset) + t[:, None] * np.asarray(drift)
    every[1] += np.asarray(drift)
