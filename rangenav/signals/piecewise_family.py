"""Base of the families that are one polynomial between neighbouring knots: a family says which polynomials they are."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.signals import piecewise
from rangenav.signals.base import ROUNDING_MARGIN, SignalBase
from rangenav.signals.piecewise import Pieces


class PiecewiseFamily(SignalBase, frozen=True):
    """A signal made of polynomials; a family defines `piecewise`, `bandwidth`, `bound`, `slowed` and `mapped`."""

    def piecewise(self) -> Pieces:
        """The polynomials that the signal is made of, in times since t = 0."""
        raise NotImplementedError

    def __call__(self, t: Float[Array, "*n"], order: int = 0) -> Float[Array, "*n 3"]:
        """The derivative of the given order at times t (s): at a knot that of the piece which begins there."""
        return piecewise.evaluate(self.piecewise(), t, order)

    def bandwidth_until(self, time: float) -> float:
        """The highest frequency present (rad/s), at any time."""
        return self.bandwidth

    @property
    def bound_stretches(self) -> int:
        """The knots are edges anyway."""
        return 1

    def derivative_bounds(self, edges: Float[Array, "k"], orders: range) -> Float[Array, "o m"]:
        """The hull of the Bernstein coefficients of the piece that each stretch lies in."""
        middle = (edges[:-1] + edges[1:]) / 2
        return np.stack([piecewise.hulls(self.piecewise(), order, middle) for order in orders]) * ROUNDING_MARGIN

    def rounding_bound(self, edges: Float[Array, "k"]) -> float:
        """Of Horner's rule, and of the time since the last knot."""
        latest = float(np.abs(edges[[0, -1]]).max())
        return piecewise.rounding(self.piecewise(), latest)

    def jet(self, t: Float[Array, "n"], highest: int) -> Float[Array, "o n 3"]:
        """The signal and its derivatives: one search for the piece, developed anew about each time."""
        return piecewise.jet(self.piecewise(), t, highest)

    def operations(self) -> int:
        """There is no formula."""
        return 0
