"""The search for the smallest θ that meets every requirement, or for the best θ within limits.

The search goes along rays, then through the whole box, and ends with a local polish. Every trial of a θ costs about
4 ms and is counted. When the budget is used up, the best θ so far is the result. The violation of a θ is the largest of
all shortfalls and excesses, as logarithms: at 0 or below, every requirement is met with its margin.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array
from scipy.optimize import differential_evolution, minimize

from rangenav.certificate.figures import Figures, figures, shortfall
from rangenav.progress import Cancelled, CancelledError, Progress
from rangenav.repair.path_changes import Change
from rangenav.results import result

RAY = (1 / 512, 1 / 256, 1 / 128, 1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 3 / 4, 1.0)
"""Shares of a ray that are tried, outwards."""
HALVINGS = 6
POPULATION, SEED = 5, 1
"""Differential evolution: members per unknown, and the seed, which makes every search repeatable."""
WIDE_SHARE, POLISH = 0.6, 120
"""The share of the remaining trials that a wide search may use, and the number of trials that a polish may use."""
POLISH_SHARE = 0.5
"""The most of the remaining trials that a polish may use, so that a certificate that refuses its result is heeded."""
WALL = 1e3
"""The violation of a θ for which there is no preset."""
EXCESS_MARGIN = 0.01
"""log; distance to be kept from the vehicle's limits, because a trial has fewer samples than a certificate."""
PENALTY = 30.0
"""Weight of a violation relative to log σ, where σ is minimised."""


@dataclass(eq=False, kw_only=True)
class Budget:
    """The number of motions that a repair may try. Reports the progress of the search and stops it when cancelled."""

    total: int
    most: int
    """The number of motions that may be tried up to the current stage, of the total."""
    progress: Progress
    cancelled: Cancelled
    used: int = 0

    def spend(self) -> None:
        """Count one more trial. Raises CancelledError."""
        if self.cancelled():
            raise CancelledError
        self.used += 1
        self.progress(min(1.0, self.used / self.total))

    @property
    def left(self) -> int:
        return max(0, self.most - self.used)


@result
class Trial:
    """The figures of one θ, and by how much it violates the requirements."""

    figures: Figures | None
    missing: float
    """log; the largest shortfall of what is required, without margin."""
    excess: float
    """How far the vehicle's limits are exceeded, or nearly so."""
    violation: float

    @property
    def meets(self) -> bool:
        """Whether everything is met on samples, without margin."""
        return max(self.missing, self.excess) <= 0


NOWHERE = Trial(figures=None, missing=WALL, excess=WALL, violation=WALL)
"""A θ for which there is no preset."""


@dataclass(eq=False, kw_only=True)
class Search:
    """One kind of change and every θ tried so far: an optimiser needs objective and constraint at the same θ."""

    change: Change
    budget: Budget
    margin: float
    """log; the margin by which μ and σ must exceed their requirements."""
    needs: tuple[str, ...] = ("excitation", "accuracy")
    """The shortfalls that count as violations."""
    trials: dict[bytes, Trial] = field(default_factory=dict)

    def evaluate(self, theta: Float[Array, "n"]) -> Trial:
        """The trial of θ, which is first clipped to the box."""
        theta = np.clip(theta, self.change.box[:, 0], self.change.box[:, 1])
        key = theta.tobytes()
        if key not in self.trials:
            self.budget.spend()
            self.trials[key] = self._evaluate(theta)
        return self.trials[key]

    def _evaluate(self, theta: Array) -> Trial:
        try:
            preset = self.change.make(theta)
            reached = figures(preset)
        except ValueError:
            return NOWHERE
        missing = max(value for name, value in shortfall(reached, preset).items() if name in self.needs)
        return self._trial(reached, missing, reached.worst_excess + EXCESS_MARGIN)

    def _trial(self, reached: Figures, missing: float, excess: float) -> Trial:
        """The violation is the largest shortfall or excess; the requirements are met at 0 or below."""
        violation = min(WALL, max(missing + self.margin, excess, -WALL))
        return Trial(figures=reached, missing=missing, excess=excess, violation=violation)

    def require(self, margin: float) -> None:
        """Ask for another margin, of what was tried already, too."""
        self.margin = margin
        for key, trial in self.trials.items():
            if trial.figures is not None:
                self.trials[key] = self._trial(trial.figures, trial.missing, trial.excess)


def least(search: Search) -> Float[Array, "n"] | None:
    """The θ of least effort that violates nothing; None if the search has no such θ."""
    met = [theta for end in search.change.rays if (theta := along(search, end)) is not None]
    if not met and search.budget.left > 0:
        wide = _anywhere(search)
        met = [] if wide is None else [wide]
    if not met:
        return None
    best = min(met, key=search.change.effort)
    return polished(search, best, lambda theta: math.log(max(search.change.effort(theta), 1e-9)))


def along(search: Search, end: Float[Array, "n"]) -> Float[Array, "n"] | None:
    """The first θ on the ray from no change to `end` that violates nothing, to a few percent; None if there is none."""
    before = 0.0
    for share in RAY:
        if search.budget.left == 0:
            return None
        if search.evaluate(search.change.ray(end, share)).violation <= 0:
            break
        before = share
    else:
        return None
    for _ in range(HALVINGS):
        middle = (before + share) / 2
        if search.evaluate(search.change.ray(end, middle)).violation <= 0:
            share = middle
        else:
            before = middle
    return search.change.ray(end, share)


def polished(search: Search, theta: Float[Array, "n"], aim: Callable[[Array], float]) -> Float[Array, "n"]:
    """The θ of least `aim` that violates nothing, from a local search (COBYLA) that starts at `theta`."""
    span = search.change.box[:, 1] - search.change.box[:, 0]
    start = theta / span
    minimize(
        lambda u: aim(u * span),
        start,
        method="COBYLA",
        constraints=[{"type": "ineq", "fun": lambda u: -search.evaluate(u * span).violation}],
        options={"rhobeg": 0.05, "maxiter": min(POLISH, int(POLISH_SHARE * search.budget.left)), "tol": 1e-4},
    )
    met = [np.frombuffer(key) for key, trial in search.trials.items() if trial.violation <= 0]
    return min([theta, *met], key=aim)


def _anywhere(search: Search) -> Float[Array, "n"] | None:
    """Any θ in the box that violates nothing, by differential evolution."""
    box = search.change.box
    generations = int(WIDE_SHARE * search.budget.left / (POPULATION * len(box))) - 1
    if generations < 1:
        return None
    differential_evolution(
        lambda theta: search.evaluate(theta).violation,
        box.tolist(),
        maxiter=generations,
        popsize=POPULATION,
        rng=SEED,
        polish=False,
        init="sobol",
        callback=lambda *_, **__: any(trial.violation <= 0 for trial in search.trials.values()),
    )
    met = [np.frombuffer(key) for key, trial in search.trials.items() if trial.violation <= 0]
    return min(met, key=search.change.effort) if met else None


def sharpest(search: Search, most_effort: float) -> Float[Array, "n"] | None:
    """The θ of least predicted σ within `most_effort` and the vehicle's limits; None if no tried θ is within both."""

    def aim(theta: Array) -> float:
        trial = search.evaluate(theta)
        too_much = max(0.0, trial.violation) + max(0.0, search.change.effort(theta) / most_effort - 1)
        return WALL if trial.figures is None else math.log(max(trial.figures.sigma, 1e-9)) + PENALTY * too_much

    tried = [search.change.ray(end, share) for end in search.change.rays for share in RAY]
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
    met = [np.frombuffer(key) for key, trial in search.trials.items() if trial.violation <= 0]
    met = [theta for theta in met if search.change.effort(theta) <= most_effort]
    return min(met, key=aim) if met else None
