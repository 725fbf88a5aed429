"""The numbers that a lesson's text may name, each computed by the library from a state, with its unit.

A text never holds a typed number of a run: `{mu}` is the excitation of what is shown, `{start.mu}` that of the lesson's
first state, `{solved.mu}` that of its solution, and `{pinned.mu}` that of the pinned run A.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from explorer.lessons.state import State
from explorer.model import details
from explorer.model.compute import Picture, compute
from rangenav import analysis, motion, record
from rangenav.model import STATES
from rangenav.number_format import quantity, significant
from rangenav.twin import Twin


@dataclass(frozen=True)
class Figure:
    """One number: what it is, its unit, and how it follows from a state."""

    meaning: str
    unit: str
    of: Callable[[State], float | None]

    def text(self, state: State) -> str:
        """The number with its unit, as everywhere on the page; "not determined" where there is none."""
        value = self.of(state)
        if value is None or not math.isfinite(value):
            return quantity(None, self.unit)
        return quantity(value, self.unit)


def picture(state: State) -> Picture:
    """What the page shows of a state. Its stages are cached, so that several figures compute it once."""
    return compute(state.settings)


def _twin(state: State) -> Twin | None:
    found = details.details(state.preset, turn=state.settings.twin_turn).twin
    return found if isinstance(found, Twin) else None


def _mu(state: State) -> float:
    found = analysis.sampled(state.preset)
    return found.mu if found.mu >= found.mu_floor else 0.0


def _limits(state: State) -> motion.Limits:
    p = state.preset
    return motion.limits(record.simulated(record.truth_inputs(p)).motion, world=p.world)


def _anchor_distance(state: State) -> float:
    p = state.preset
    position = record.simulated(record.truth_inputs(p)).motion.position
    return float(np.linalg.norm(position - np.array(p.world.anchor), axis=1).min())


FIGURES = {
    "mu": Figure("the least excitation over all windows", "m²/s⁷", _mu),
    "mu_required": Figure("the excitation required", "m²/s⁷", lambda s: s.preset.requirement.mu),
    "mu_printed": Figure(
        "the printed excitation of its worst window",
        "m²/s⁷",
        lambda s: details.details(s.preset).printed.mu_printed,
    ),
    "rank": Figure(
        f"how many of the {STATES} quantities are determined",
        "",
        lambda s: float(analysis.sampled(s.preset).known_rank),
    ),
    "sigma": Figure(
        "the position error of one window, linear model", "m", lambda s: analysis.sampled(s.preset).lifted_end.position
    ),
    "sigma_nonlinear": Figure(
        "the position error of one window, true model", "m", lambda s: analysis.sampled(s.preset).nonlinear_end.position
    ),
    "window": Figure("the window δ", "s", lambda s: s.preset.requirement.window),
    "duration": Figure("the duration of the flight", "s", lambda s: s.preset.duration),
    "speed": Figure("the largest speed", "m/s", lambda s: _limits(s).speed),
    "acceleration": Figure("the largest acceleration", "m/s²", lambda s: _limits(s).acceleration),
    "thrust": Figure("the largest thrust over weight", "", lambda s: _limits(s).thrust_to_weight),
    "anchor_distance": Figure("the least distance to the anchor", "m", _anchor_distance),
    "twin_apart": Figure("the least distance of the twin", "m", lambda s: t.nearest if (t := _twin(s)) else None),
    "twin_mismatch": Figure(
        "the largest difference of the two ranges", "m", lambda s: t.mismatch if (t := _twin(s)) else None
    ),
    "error": Figure("the steady position error of the run", "m", lambda s: picture(s).summary.steady_position),
    "peak": Figure("the largest position error of the run", "m", lambda s: picture(s).summary.peak_position),
    "settled": Figure("when the position has settled", "s", lambda s: picture(s).summary.settle_position_s),
    "attitude_settled": Figure("when the attitude has settled", "s", lambda s: picture(s).summary.settle_attitude_s),
    "attitude_error": Figure(
        "the attitude error at the end of the run", "°", lambda s: picture(s).summary.final_attitude_deg
    ),
}
"""By the name that a text writes between braces."""


def text(name: str, state: State) -> str:
    """One figure as a text shows it. Raises KeyError for a name that no row has."""
    return FIGURES[name].text(state)


def short(value: float, unit: str = "") -> str:
    """A number of a check's hint, as everywhere on the page."""
    return f"{significant(value)} {unit}".rstrip()
