"""The smallest θ that meets every requirement, or the best one within limits: rays, then a wide search, then polish.

Every look at a θ costs some 4 ms and is counted; when the evaluations are used up the best so far is kept. A violation
is the largest of all shortfalls and excesses, in logarithms, so that 0 is met with what margin was asked for.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from scipy.optimize import differential_evolution, minimize

from rangenav.certificate.figures import Figures, figures, shortfall
from rangenav.preset import Preset
from rangenav.progress import Cancelled, CancelledError, Progress
from rangenav.repair.path_changes import Change
from rangenav.results import result

RAY = (1 / 512, 1 / 256, 1 / 128, 1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 3 / 4, 1.0)
"""Shares of a ray that are looked at, outwards."""
HALVINGS = 6
POPULATION, SEED = 5, 1
"""Of differential evolution: members per unknown; the draw is always the same."""
WIDE_SHARE, POLISH = 0.6, 120
"""Of the evaluations a wide search may use this share, and a polish so many."""
WALL = 1e3
"""Violation of what cannot be had at all."""
EXCESS_MARGIN = 0.01
"""The vehicle's limits are looked at on fewer samples than the certificate does."""
PENALTY = 30.0
"""Weight of a violation against a logarithm of σ in a wide search."""


@dataclass(eq=False, kw_only=True)
class Budget:
    """Counts looks, tells how far the search is, and stops it. One per repair."""

    total: int
    most: int
    """What may be used so far, of the total."""
    progress: Progress
    cancelled: Cancelled
    used: int = 0

    def spend(self) -> None:
        """One more look. Raises CancelledError."""
        if self.cancelled():
            raise CancelledError
        self.used += 1
        self.progress(min(1.0, self.used / self.total))

    @property
    def left(self) -> int:
        return max(0, self.most - self.used)


@result
class Look:
    """What one θ gives."""

    figures: Figures | None
    violation: float


@dataclass(eq=False, kw_only=True)
class Search:
    """One change, looked at with memory: the optimiser asks for objective and constraint at the same θ."""

    change: Change
    budget: Budget
    margin: float
    """log; asked of μ and σ beyond what is required."""
    needs: tuple[str, ...] = ("excitation", "accuracy")
    """Shortfalls that count."""
    seen: dict[bytes, Look] = field(default_factory=dict)

    def look(self, theta: Float[Array, "n"]) -> Look:
        """The quick figures at θ; outside the box the walls are steep, not sudden."""
        theta = np.clip(theta, self.change.box[:, 0], self.change.box[:, 1])
        key = theta.tobytes()
        if key not in self.seen:
            self.budget.spend()
            self.seen[key] = self._look(theta)
        return self.seen[key]

    def _look(self, theta: Array) -> Look:
        try:
            made = self.change.make(theta)
            found = figures(made)
        except ValueError:
            return Look(figures=None, violation=WALL)
        return Look(figures=found, violation=self.violation(found, made))

    def violation(self, found: Figures, made: Preset) -> float:
        """The largest of what is missing and what is too much; met at 0."""
        missing = [value for name, value in shortfall(found, made, margin=self.margin).items() if name in self.needs]
        return min(WALL, max(*missing, found.worst_excess + EXCESS_MARGIN, -WALL))


def least(search: Search) -> Float[Array, "n"] | None:
    """The smallest θ found that violates nothing; None if none was found."""
    found = [theta for end in search.change.seeds if (theta := along(search, end)) is not None]
    if not found and search.budget.left > 0:
        wide = _anywhere(search)
        found = [] if wide is None else [wide]
    if not found:
        return None
    best = min(found, key=search.change.effort)
    return polished(search, best, lambda theta: math.log(max(search.change.effort(theta), 1e-9)))


def along(search: Search, end: Float[Array, "n"]) -> Float[Array, "n"] | None:
    """The first share of a ray from no change to `end` that violates nothing, to a few percent."""
    before = 0.0
    for share in RAY:
        if search.budget.left == 0:
            return None
        if search.look(search.change.ray(end, share)).violation <= 0:
            break
        before = share
    else:
        return None
    for _ in range(HALVINGS):
        middle = (before + share) / 2
        if search.look(search.change.ray(end, middle)).violation <= 0:
            share = middle
        else:
            before = middle
    return search.change.ray(end, share)


def polished(search: Search, theta: Float[Array, "n"], aim: Callable[[Array], float]) -> Float[Array, "n"]:
    """A local search for a smaller aim that still violates nothing; the start if it finds none."""
    span = search.change.box[:, 1] - search.change.box[:, 0]
    start = theta / span
    minimize(
        lambda u: aim(u * span),
        start,
        method="COBYLA",
        constraints=[{"type": "ineq", "fun": lambda u: -search.look(u * span).violation}],
        options={"rhobeg": 0.05, "maxiter": min(POLISH, search.budget.left), "tol": 1e-4},
    )
    met = [np.frombuffer(key) for key, look in search.seen.items() if look.violation <= 0]
    return min([theta, *met], key=aim)


def _anywhere(search: Search) -> Float[Array, "n"] | None:
    """Any θ in the box that violates nothing, by differential evolution."""
    box = search.change.box
    generations = int(WIDE_SHARE * search.budget.left / (POPULATION * len(box))) - 1
    if generations < 1:
        return None
    differential_evolution(
        lambda theta: search.look(theta).violation,
        box.tolist(),
        maxiter=generations,
        popsize=POPULATION,
        rng=SEED,
        polish=False,
        init="sobol",
        callback=lambda *_, **__: any(look.violation <= 0 for look in search.seen.values()),
    )
    met = [np.frombuffer(key) for key, look in search.seen.items() if look.violation <= 0]
    return min(met, key=search.change.effort) if met else None


def sharpest(search: Search, most_effort: float) -> Float[Array, "n"] | None:
    """The θ of least predicted σ whose effort stays below a limit and that breaks no limit of the vehicle."""

    def aim(theta: Array) -> float:
        look = search.look(theta)
        too_much = max(0.0, look.violation) + max(0.0, search.change.effort(theta) / most_effort - 1)
        return WALL if look.figures is None else math.log(max(look.figures.sigma, 1e-9)) + PENALTY * too_much

    tried = [search.change.ray(end, share) for end in search.change.seeds for share in RAY]
    tried = [theta for theta in tried if search.change.effort(theta) <= most_effort]
    scored = [(aim(theta), k) for k, theta in enumerate(tried) if search.budget.left > POLISH]
    if not scored:
        return None
    best = tried[min(scored)[1]]
    span = search.change.box[:, 1] - search.change.box[:, 0]
    minimize(
        lambda u: aim(u * span),
        best / span,
        method="COBYLA",
        options={"rhobeg": 0.05, "maxiter": search.budget.left, "tol": 1e-4},
    )
    met = [np.frombuffer(key) for key, look in search.seen.items() if look.violation <= 0]
    met = [theta for theta in met if search.change.effort(theta) <= most_effort]
    return min(met, key=aim) if met else None
