"""The least excitation μ over every window: bounded at every t ≥ 0, or over the flight, or sampled, and the reason.

The analysis, the certificates and the page take μ from here, so they name the same window.
"""

from functools import lru_cache
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav.observability import derivative_bounds, excitation, running_sums
from rangenav.observability.derivative_bounds import UnboundedDerivativeError
from rangenav.observability.excitation_bound import ExcitationBounds, excitation_bounds, oriented
from rangenav.observability.excitation_core import core_bounds
from rangenav.results import result
from rangenav.signals import Signal

Starts = Literal["every t >= 0", "every t in [0, duration - window]"]
EVERY: Starts = "every t >= 0"
FLIGHT: Starts = "every t in [0, duration - window]"
SAMPLED, MAX_EVENTS = 201, 100
"""Starts at which a figure is sampled; added are those at which a knot enters or leaves the window, at most so many."""
DENSE, ROUNDS = 4001, 2
"""Starts of a dense sample by running sums, and how often the neighbourhood of its least one is sampled again."""
CACHED = 8


@result
class WorstExcitation:
    """The least λ_min of ∫p⁗p⁗ᵀ (m²/s⁷) over the windows that start as `starts` says, and the window that has it."""

    starts: Starts
    reason: str | None
    """Why not at every t ≥ 0; None if it is."""
    mu: float
    """Of the worst window among those evaluated."""
    at: float
    """s, where that window starts."""
    direction: Float[Array, "3"]
    """Along it that window is excited least."""
    floor: float
    """A mu below this is rounding."""
    count: int
    """Windows evaluated."""
    bounds: ExcitationBounds | None
    """What holds for all windows; None if nothing is known to bound the path's derivatives: mu is then a sample."""

    @property
    def lower(self) -> float | None:
        """No window has less; None where mu is sampled."""
        return None if self.bounds is None else self.bounds.lower

    def proven(self, required: float) -> bool:
        """Whether anything is proven of μ: a lower bound above 0, or that the required μ is missed. One window proves
        that.
        """
        missed = self.mu + self.floor < required
        return missed or (self.bounds is not None and (self.bounds.lower > 0 or self.bounds.upper < required))

    def meets(self, required: float) -> bool | None:
        """Whether every window has at least the required μ; None where that is neither proven nor disproven."""
        if self.mu < required:
            return False
        return True if self.bounds is not None and self.bounds.lower >= required else None


@lru_cache(maxsize=CACHED)
def worst_excitation(path: Signal, window: float, duration: float, required: float) -> WorstExcitation:
    """The least excitation over windows (s) at any t ≥ 0 if the path is periodic, else over those of the flight (s)."""
    found = by_second_order(path, window, duration, required)
    if found.bounds is None or (found.mu > found.floor and found.meets(required) is not None):
        return found
    end = (path.period or duration - window) if found.starts == EVERY else duration - window
    by_cores = core_bounds(path, window, end)
    if by_cores is not None and by_cores.lower > found.bounds.lower:
        return _bounded(by_cores, found.starts, found.reason)
    if found.mu <= found.floor and found.floor >= required:  # neither 0 nor enough: the bounds say nothing
        why = f"its bounds have an error of {found.floor:.3g} m²/s⁷, no less than the required μ"
        return _sampled(path, window, duration - window, why)
    return found


def by_second_order(path: Signal, window: float, duration: float, required: float) -> WorstExcitation:
    """The same by `excitation_bounds` alone, which knows nothing of a μ below 1e-14 of the largest eigenvalue."""
    period, why, last = path.period, "the path does not repeat", duration - window
    of_period: ExcitationBounds | None = None
    if period is not None:
        try:
            of_period = excitation_bounds(path, window, period or last)  # a straight path's windows are all alike
            if of_period.lower >= required or of_period.least < required:
                return _bounded(of_period, EVERY, None)
            why = f"over the period of {period:.4g} s no less than {of_period.lower:.4g} m²/s⁷ can be shown"
        except UnboundedDerivativeError as error:
            why = str(error)
    try:
        of_flight = excitation_bounds(path, window, last)
    except UnboundedDerivativeError as error:
        return _sampled(path, window, last, str(error))
    if of_period is not None and of_flight.lower < required:
        return _bounded(of_period, EVERY, None)
    return _bounded(of_flight, FLIGHT, why)


def _bounded(bounds: ExcitationBounds, starts: Starts, why: str | None) -> WorstExcitation:
    return WorstExcitation(
        starts=starts,
        reason=why,
        mu=bounds.least,
        at=bounds.at,
        direction=bounds.direction,
        floor=bounds.floor,
        count=bounds.starts,
        bounds=bounds,
    )


def _sampled(path: Signal, window: float, last: float, why: str) -> WorstExcitation:
    start = _least_excited(path, window, last)
    every = excitation.eigenvalues(path, start, window)[:, 0]
    k = int(np.argmin(every))
    values, axes = excitation.directions(path, float(start[k]), window)
    return WorstExcitation(
        starts=FLIGHT,
        reason=why,
        mu=float(every[k]),
        at=float(start[k]),
        direction=oriented(axes[:, 0]),
        floor=excitation.floor(values[None]),
        count=DENSE + (ROUNDS + 1) * len(start),
        bounds=None,
    )


def _least_excited(path: Signal, window: float, last: float) -> Float[Array, "w"]:
    """Starts around the least of a dense sample, by running sums; sparse starts where these are too much work."""
    start, sums = sampled_starts(path, window, last), running_sums.between(path, 0.0, last + window)
    if sums is None:
        return start
    dense, step = np.linspace(0, last, DENSE), last / (DENSE - 1)
    for _ in range(ROUNDS):
        least = running_sums.least_eigenvalues(path, sums, dense, window)
        middle = float(dense[np.argmin(least)])
        dense = np.clip(np.linspace(middle - step, middle + step, SAMPLED), 0, last)
        step *= 2 / (SAMPLED - 1)
    return np.union1d(start, dense)


def sampled_starts(path: Signal, window: float, end: float) -> Float[Array, "w"]:
    """Starts in [0, end] (s): evenly spaced ones, and those at which a knot enters or leaves the window."""
    try:
        edges = derivative_bounds.knots_until(path, end + window)
    except UnboundedDerivativeError:
        edges = np.zeros(0)
    edges = edges[:: 1 + 2 * len(edges) // MAX_EVENTS]
    events = np.concatenate([edges, edges - window])
    return np.union1d(np.linspace(0, end, SAMPLED), events[(events > 0) & (events < end)])
