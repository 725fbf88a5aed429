"""The result of a repair: the changed preset with its certificate, or the reason why there is none."""

import math
from typing import Any, Literal

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import certificate
from rangenav import preset as presets
from rangenav.certificate import Certificate
from rangenav.certificate.figures import BLIND_MU, Figures, demanded, excess
from rangenav.number_format import quantity, significant
from rangenav.preset import MAX_STORY, MAX_TITLE, Preset
from rangenav.repair.change import Change, ChangeKind
from rangenav.repair.search import NOWHERE, Budget, Trial
from rangenav.results import result
from rangenav.vehicle import CRAZYFLIE, FREE, WORDS

WayOut = Literal["window", "anchor", "slower", "tones", "repair"]
"""What may help where no change was found: a longer window, another place of the anchor, a slower flight first, added
tones, or a repair before an improvement."""
STAND_IN = CRAZYFLIE
"""If a preset's vehicle has no limits, a repair keeps the limits of this one where it can."""


@result
class Refused:
    """A change that meets the requirement on samples, and what its certificate says against it."""

    description: str
    sentences: tuple[str, ...]


class CannotRepairError(ValueError):
    """This kind of change does not meet the requirement; the sentence says why."""

    def __init__(self, sentence: str, *, ways: tuple[WayOut, ...] = (), window: float | None = None) -> None:
        """ways: what the sentence advises. window: the longer window (s) with which tones were certified."""
        super().__init__(sentence)
        self.ways, self.window = ways, window


@result
class Repair:
    """A preset before and after a change, and the figures of both."""

    before: Preset
    after: Preset
    by: ChangeKind
    description: str
    """The change in a clause, or that none was needed."""
    effort: float
    """The size of the change: m and weights of acceleration for tones, m for waypoints, log factors for the rest."""
    evaluations: int
    figures_before: Figures
    """μ and σ are those of the worst of all windows, as certificates have them; σ is infinite where blind."""
    figures_after: Figures
    certificate: Certificate
    """Of the preset after, from its written bytes."""

    @property
    def changed(self) -> bool:
        """Whether the path was changed; not where the preset met its requirement already."""
        return self.after.path != self.before.path


def changed_preset(change: Change, theta: Float[Array, "n"], preset: Preset, suffix: str) -> Preset:
    """The changed preset with its own vehicle again, a title, and a story that says what was changed."""
    title = f"{preset.title}{suffix}"
    description = change.description(theta)
    return msgspec.structs.replace(
        change.make(theta),
        vehicle=preset.vehicle,
        angular_velocity=preset.angular_velocity,
        expect="observable",
        title=title if len(title) <= MAX_TITLE else preset.title,
        story=f"{description[0].upper()}{description[1:]}."[:MAX_STORY],
    )


def outcome(before: Preset, after: Preset, by: ChangeKind, description: str, effort: float, budget: Budget) -> Repair:
    return Repair(
        before=before,
        after=after,
        by=by,
        description=description,
        effort=effort,
        evaluations=budget.used,
        figures_before=_certified(before),
        figures_after=_certified(after),
        certificate=certificate_of(after),
    )


def _certified(preset: Preset) -> Figures:
    """The figures of a preset, with μ and σ from its certificate and not from samples."""
    issued = certificate_of(preset)
    bound = issued.accuracy.bound
    demands = demanded(preset)
    return Figures(
        mu=max(BLIND_MU, issued.excitation.found or 0.0),
        sigma=bound if isinstance(bound, float) else math.inf,
        excess=excess(demands, preset.vehicle),
        farthest=float(demands.anchor_distance.max()),
    )


def certificate_of(preset: Preset) -> Certificate:
    return certificate.certify(presets.dumps(preset).encode(), source="preset")


def report(repair: Repair, *, name: str) -> dict[str, Any]:
    """What `rangenav repair --json` prints."""
    stated = repair.certificate

    def figures_entry(figure: Figures) -> dict[str, Any]:
        blind = not np.isfinite(figure.sigma)
        entry: dict[str, Any] = {"mu": 0.0 if figure.mu <= BLIND_MU else figure.mu}
        entry["position_sigma"] = None if blind else figure.sigma
        return entry | ({"reason": "position_sigma: null, blind"} if blind else {})

    return {
        "preset": name,
        "by": repair.by,
        "words": repair.description,
        "effort": repair.effort,
        "evaluations": repair.evaluations,
        "changed": repair.changed,
        "before": figures_entry(repair.figures_before),
        "after": figures_entry(repair.figures_after)
        | {
            "title": repair.after.title,
            "rank": stated.rank.rank,
            "mu_bound": stated.excitation.lower,
            "sampled": sampled(stated),
            "flyable": stated.vehicle.flyable,
            "thrust_to_weight": stated.limits.thrust_to_weight,
            "certified": stated.certified,
        },
    }


def sampled(certificate: Certificate) -> list[str]:
    """The figures of a certificate that are those of evaluated windows, and not proven of all: "mu", "rank"."""
    parts = (("mu", certificate.excitation), ("rank", certificate.rank))
    return [name for name, part in parts if part.scope is not msgspec.UNSET and part.scope.basis == "sampled"]


def missed(certificate: Certificate, sampled: Figures) -> float:
    """log: by how much more a certificate misses μ or σ than samples do; 0 if it misses something else."""
    needed, reached = certificate.excitation, certificate.accuracy.lifted.end.position
    lower = needed.found if needed.lower is None else needed.lower
    short = {check.name for check in certificate.checks if not check.met}
    of_mu = math.log(sampled.mu / lower) if "excitation" in short and lower else 0.0
    of_sigma = math.log(reached / sampled.sigma) if "accuracy" in short and reached and sampled.sigma > 0 else 0.0
    return max(of_mu, of_sigma, 0.0)


def failure_reason(
    preset: Preset, by: ChangeKind, budget: Budget, nearest_trials: list[Trial], refused: list[Refused]
) -> str:
    """Why there is no repair: what the certificate of the last change says against it, or how near the search came."""
    reason = f"{by}: no change that meets the requirement was found among {budget.used} motions"
    if refused:
        against = "; ".join(refused[-1].sentences)
        return f"{reason}; on samples this one meets it: {refused[-1].description}; but {against}"
    free = preset.vehicle == FREE
    unlimited = [one for one in nearest_trials if one.figures is not None and not one.figures.excess]
    trial = min(unlimited if free and unlimited else nearest_trials, key=lambda one: one.violation, default=NOWHERE)
    if trial.figures is None:
        return reason
    sigma, needed = trial.figures.sigma, preset.requirement
    mu = 0.0 if trial.figures.mu <= BLIND_MU else trial.figures.mu
    reason += f"; the nearest has μ = {quantity(mu, 'm²/s⁷')} ({significant(needed.mu)} required) and "
    allowed = quantity(needed.position_sigma, "m")
    reason += f"σ = {quantity(sigma, 'm')} ({allowed} required)" if np.isfinite(sigma) else "is blind"
    excess = trial.figures.excess
    if trial.figures.worst_excess > 0 and not free:  # where no vehicle is chosen, no limit applies
        reason += (
            f", and breaks a limit of {preset.vehicle.name} ({WORDS[max(excess, key=lambda name: excess[name])][0]})"
        )
    return reason
