"""The numbers that a lesson's text may name, each computed by the library from a state, with its unit.

A text never holds a typed number of a run: `{mu}` is the excitation of what is shown, `{start.mu}` that of the lesson's
first state, `{solved.mu}` that of its solution, `{pinned.mu}` that of the pinned run A, and `{case-1.mu}` that of the
first case. To add a figure, add a row to FIGURES.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from explorer.lessons import measures
from explorer.lessons.measures import picture
from explorer.lessons.state import State
from explorer.model.settings import Settings
from rangenav import vehicle
from rangenav.model import STATES
from rangenav.number_format import NEVER, NOT_DETERMINED, quantity, significant

MU = "m²/s⁷"
CACHED = 512
"""Numbers that are kept: many times those of one lesson."""


@dataclass(frozen=True)
class Figure:
    """One number: what it is, its unit, and how it follows from a state."""

    meaning: str
    unit: str
    of: Callable[[State], float | None]
    never: str = NOT_DETERMINED
    """The word in place of a number that does not exist: None, NaN or infinite."""

    def text(self, value: float | None) -> str:
        """The number with its unit, as everywhere on the page; a word where there is none."""
        if value is None or not math.isfinite(value):
            return self.never
        return quantity(value, self.unit)


FIGURES = {
    "mu": Figure("the least excitation over all windows", MU, lambda s: measures.mu(s.preset)),
    "mu_required": Figure("the excitation required", MU, lambda s: s.preset.requirement.mu),
    "mu_printed": Figure("the printed excitation of its worst window", MU, lambda s: measures.mu_printed(s.preset)),
    "rank": Figure(f"how many of the {STATES} quantities are determined", "", lambda s: float(measures.rank(s.preset))),
    "sigma": Figure("the position error of one window, linear model", "m", lambda s: measures.sigma(s.preset)),
    "sigma_nonlinear": Figure(
        "the position error of one window, true model", "m", lambda s: measures.sigma_nonlinear(s.preset)
    ),
    "sigma_required": Figure("the position error required", "m", lambda s: s.preset.requirement.position_sigma),
    "window": Figure("the window δ", "s", lambda s: s.preset.requirement.window),
    "duration": Figure("the duration of the flight", "s", lambda s: s.preset.duration),
    "slower": Figure("how many times slower the path is run", "", lambda s: s.settings.time_scale),
    "speed": Figure("the largest speed", "m/s", lambda s: measures.limits(s.preset).speed),
    "acceleration": Figure("the largest acceleration", "m/s²", lambda s: measures.limits(s.preset).acceleration),
    "thrust": Figure("the largest thrust over weight", "", lambda s: measures.limits(s.preset).thrust_to_weight),
    "thrust_allowed": Figure(
        "the thrust over weight that the vehicle allows",
        "",
        lambda s: vehicle.bound(s.preset.vehicle, "thrust_to_weight"),
    ),
    "swing": Figure("how far the height goes to each side", "m", lambda s: measures.swing(s.preset)),
    "anchor_distance": Figure("the least distance to the anchor", "m", lambda s: measures.anchor_distance(s.preset)),
    "range_swing": Figure("how far the range goes to each side", "m", lambda s: measures.range_swing(s.preset)),
    "range_noise": Figure("the noise of a range", "m", lambda s: s.preset.sensors.sigma.range),
    "rate": Figure("the IMU's rate", "Hz", lambda s: s.preset.sensors.imu_rate),
    "twin_apart": Figure(
        "the least distance of the twin", "m", lambda s: t.nearest if (t := measures.twin(s)) else None
    ),
    "twin_mismatch": Figure(
        "the largest difference of the two ranges", "m", lambda s: t.mismatch if (t := measures.twin(s)) else None
    ),
    "error": Figure("the steady position error of the run", "m", lambda s: picture(s).summary.steady_position),
    "peak": Figure("the largest position error of the run", "m", lambda s: picture(s).summary.peak_position),
    "settled": Figure(
        "when the position has settled", "s", lambda s: picture(s).summary.settle_position_s, never=NEVER
    ),
    "attitude_error": Figure(
        "the steady attitude error of the run", "°", lambda s: picture(s).summary.steady_attitude_deg
    ),
    "attitude_settled": Figure(
        "when the attitude has settled", "s", lambda s: picture(s).summary.settle_attitude_s, never=NEVER
    ),
    "seeds_error": Figure(
        "the largest steady position error of five runs", "m", lambda s: measures.worst_of_seeds(s.preset)[0]
    ),
    "seeds_peak": Figure("the largest peak of five runs", "m", lambda s: measures.worst_of_seeds(s.preset)[1]),
    "slowest_start": Figure(
        "when the attitude has settled from the slowest half turn",
        "s",
        lambda s: measures.slowest_start(s.preset),
        never=NEVER,
    ),
    "q": Figure("the range weight (1/(m⁴ s))", "", lambda s: s.preset.gains.riccati.q),
    "k1": Figure("the attitude gain (1/s)", "", lambda s: s.preset.gains.attitude.k1),
    "rho": Figure("the trust in gravity (s⁴/m²)", "", lambda s: s.preset.gains.attitude.rho2),
    "stiffness": Figure("the fastest rate of the attitude filter times its step", "", measures.stiffness),
    "gravity": Figure("the mean length of the estimated gravity", "m/s²", lambda s: measures.gravity_estimate(s)[0]),
    "gravity_spread": Figure("its standard deviation", "m/s²", lambda s: measures.gravity_estimate(s)[1]),
    "lift": Figure("the mean of ξ̂₁ − ½|p̂|²", "m²", lambda s: measures.lift_mismatch(s)[0]),
    "lift_spread": Figure("its standard deviation", "m²", lambda s: measures.lift_mismatch(s)[1]),
    "innovation": Figure("the mean of y − ŷ", "m²", lambda s: measures.innovation(s)[0]),
    "innovation_spread": Figure("its standard deviation", "m²", lambda s: measures.innovation(s)[1]),
    "correction": Figure("what the attitude filter adds to the gyro, on average", "rad/s", measures.correction),
    "file_mu": Figure("the excitation of the exported file", MU, measures.file_mu),
}
"""By the name that a text writes between braces."""


def text(name: str, state: State) -> str:
    """One figure as a text shows it. Raises KeyError for a name that no row has."""
    return FIGURES[name].text(_value(name, state.settings, state.exported))


@lru_cache(maxsize=CACHED)
def _value(name: str, settings: Settings, exported: tuple[str, bytes] | None) -> float | None:
    """The number itself. The lesson's own states are computed once and kept apart: the caches hold what the page
    shows."""
    return FIGURES[name].of(State(settings=settings, exported=exported))


def short(value: float, unit: str = "") -> str:
    """A number in the hint of a check, written as everywhere on the page."""
    return f"{significant(value)} {unit}".rstrip()
