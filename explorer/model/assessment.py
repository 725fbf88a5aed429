"""What the page says of a picture: five questions, each with a level, and the level of all, that of the worst answer.

    what can be seen · how well · does the observer get there · can it be flown · is the model right
    good: nothing is wrong      mind: read this before you trust the rest      bad: it cannot be had this way
So nothing is good while a sensor has an effect that the observer does not model, or while a limit is broken.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from explorer.model import palette
from explorer.model.compute import Picture
from explorer.model.slower import MOST_THRUST
from rangenav import continuity, sensors
from rangenav import verdict as verdicts
from rangenav.model import STATES
from rangenav.number_format import quantity, significant
from rangenav.record import SETTLED_POSITION, SETTLED_SHARE
from rangenav.vehicle import FREE

Level = Literal["good", "unjudged", "mind", "bad"]
LEVELS: tuple[Level, ...] = ("good", "unjudged", "mind", "bad")
"""The better one first."""
SIGNS: dict[Level, tuple[str, palette.Color]] = {
    "good": ("●", palette.GOOD),
    "unjudged": ("○", palette.NEUTRAL),
    "mind": ("▲", palette.WARNING),
    "bad": ("✕", palette.ERROR),
}
"""Shape and colour (Okabe–Ito hues, dark enough to read on white, and light enough on black) of a level."""
Question = Literal["seen", "accuracy", "arrival", "flight", "model"]
QUESTIONS: dict[Question, str] = {
    "seen": "what can be seen",
    "accuracy": "how well",
    "arrival": "does the observer get there",
    "flight": "can it be flown",
    "model": "is the model right",
}
Cure = Literal["repair", "tune", "slow down", "model", "effects", "vehicle"]
"""What helps: another motion, other gains, a slower path, the observer's model as derived, sensors without the effects
that the observer does not model, another vehicle."""
LAST = "last tenth of the run"
"""What SETTLED_SHARE is called."""
SIGMAS = 3.0
"""The wanted error is one σ: an estimate that stays within this many has arrived."""
REMEMBERS = 3.0
"""An error this many times smaller than one window allows is explained: the observer also uses earlier windows."""


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The answer to one question."""

    question: Question
    level: Level
    summary: str
    """A clause with the number that decides."""
    remarks: tuple[str, ...] = ()
    """Further sentences."""
    cure: Cure | None = None
    """What would help; None where nothing is wrong, or where no button of the page helps."""
    term: str = ""
    """The term of the glossary that defines the number."""


def answers(picture: Picture) -> tuple[Answer, ...]:
    """The answers to all five questions, in their order."""
    return seen(picture), accuracy(picture), arrival(picture), flight(picture), model(picture)


def level(given: tuple[Answer, ...]) -> Level:
    """The level of the worst answer. A motion that is not judged is never good, and may be worse."""
    return LEVELS[max(LEVELS.index(answer.level) for answer in given)]


def decisive(given: tuple[Answer, ...]) -> Answer:
    """The first of the worst answers; where all are good, the accuracy, whose number is the verdict's."""
    worst = level(given)
    return next(
        answer for answer in given if (answer.question == "accuracy" if worst == "good" else answer.level == worst)
    )


def seen(picture: Picture) -> Answer:
    """Whether the ranges determine all states, and whether the excitation meets the requirement."""
    analysis, needed = picture.analysis, picture.preset.requirement
    if not analysis.verdict.judged:
        return Answer(
            question="seen", level="unjudged", summary=f"not judged: {analysis.verdict.reason}", term="verdict"
        )
    if analysis.below_rounding:
        return Answer(question="seen", level="mind", summary=analysis.verdict.reason, cure="repair", term="rank")
    determined = f"{analysis.rank} of {STATES} quantities determined"
    if analysis.rank < STATES:
        blind = tuple(direction.summary for direction in analysis.directions)
        return Answer(question="seen", level="bad", summary=determined, remarks=blind, cure="repair", term="rank")
    if analysis.verdict.word == "blind":
        reason = analysis.verdict.reason
        return Answer(question="seen", level="bad", summary=f"blind {reason}", cure="repair", term="verdict")
    if analysis.verdict.excitation != "met":
        excited = quantity(analysis.resolved_mu, "m²/s⁷")
        summary = f"all {STATES} quantities determined, but the excitation μ is {excited}, wanted {needed.mu:g}"
        return Answer(question="seen", level="mind", summary=summary, cure="repair", term="excitation")
    return Answer(question="seen", level="good", summary=f"all {STATES} quantities determined", term="rank")


def accuracy(picture: Picture) -> Answer:
    """The predicted error of the worst window against the requirement; and why the estimate may be better."""
    analysis, needed = picture.analysis, picture.preset.requirement
    predicted, wanted = analysis.lifted_end.position, f"wanted ±{quantity(needed.position_sigma, 'm')}"
    if not math.isfinite(predicted):
        at_this = " at this precision" if analysis.below_rounding else ""
        summary = f"the ranges of one window do not determine the position{at_this} ({wanted})"
        undetermined: Level = "mind" if analysis.below_rounding else "bad"
        return Answer(question="accuracy", level=undetermined, summary=summary, cure="repair", term="window accuracy")
    summary = f"±{quantity(predicted, 'm')} from one window of {significant(needed.window, 4)} s, {wanted}"
    reached = picture.summary.steady_position
    remembers = math.isfinite(reached) and reached * REMEMBERS < predicted and not picture.summary.diverged
    remark = (
        f"At the end the estimate is off by {quantity(reached, 'm')} only: the observer also uses earlier ranges and "
        "its initial guess, which the prediction from one window does not."
    )
    if analysis.verdict.word == "weak" and analysis.verdict.reason:  # larger than any error that says anything
        reason = (analysis.verdict.reason, *((remark,) if remembers else ()))
        return Answer(question="accuracy", level="mind", summary=summary, remarks=reason, cure="repair", term="verdict")
    if predicted <= needed.position_sigma:
        return Answer(question="accuracy", level="good", summary=summary, term="window accuracy")
    return Answer(
        question="accuracy",
        level="mind",
        summary=summary,
        remarks=(remark,) if remembers else (),
        cure="repair",
        term="window accuracy",
    )


def arrival(picture: Picture) -> Answer:
    """Whether the estimate settles, fits its ranges, and is as near as the requirement asks."""
    summary, needed = picture.summary, picture.preset.requirement.position_sigma
    blind = picture.analysis.blind
    fit = summary.fit.statement(blind=blind, predicted=picture.analysis.lifted_end.position)
    error = quantity(summary.steady_position, "m")
    if summary.diverged and not blind:
        text = f"the observer has diverged: {summary.divergence}"
        return Answer(question="arrival", level="bad", summary=text, cure="tune", term="diverged")
    if summary.fit.word == "lost":
        return Answer(question="arrival", level="bad", summary="the observer is lost", cure="tune", term="range fit")
    if blind:
        text = f"{error} off at the end; this error depends on the initial guess"
        return Answer(
            question="arrival",
            level="bad" if summary.diverged else "mind",
            summary=text,
            remarks=(fit,),
            cure="repair",
            term="steady error",
        )
    wrong = tuple(_not_arrived(picture))
    if wrong:
        return Answer(
            question="arrival", level="mind", summary=wrong[0], remarks=(*wrong[1:], fit), cure="tune", term="settled"
        )
    since = f"within {SETTLED_POSITION:g} m from {significant(summary.settle_position_s or 0.0)} s on"
    if summary.settle_position_s is None:
        since = f"though not always within {SETTLED_POSITION:g} m over the {LAST}"
    text = f"yes, {since}, {error} off at the end, wanted {quantity(needed, 'm')}"
    return Answer(question="arrival", level="good", summary=text, remarks=(fit,), term="settled")


def _not_arrived(picture: Picture) -> Iterator[str]:
    """What is wrong with an estimate on an observable motion, the most important first."""
    summary, needed = picture.summary, picture.preset.requirement.position_sigma
    if not summary.steady_position <= needed:
        yield f"{quantity(summary.steady_position, 'm')} off at the end, wanted {quantity(needed, 'm')}"
    if summary.settle_position_s is None and not _stays(picture, SIGMAS * needed):
        limit = quantity(max(SIGMAS * needed, SETTLED_POSITION), "m")
        yield f"the position does not stay within {limit} over the {LAST}"
    if summary.settle_attitude_s is None:
        yield f"the attitude does not stay within 5° over the {LAST}"
    if summary.fit.word in ("overconfident", "correlated"):
        yield f"the estimate does not fit its ranges: {summary.fit.summary(blind=False)}"


def _stays(picture: Picture, limit: float) -> bool:
    """Whether the position error stays within a limit (m) over the last part of the run."""
    last = picture.errors.position[-max(1, round(SETTLED_SHARE * len(picture.errors.position))) :]
    return bool(np.all(last <= limit))


def flight(picture: Picture) -> Answer:
    """Whether the vehicle can fly the motion; without a vehicle, whether any of the catalogue has the thrust."""
    p = picture.preset
    thrust = f"thrust {significant(picture.limits.thrust_to_weight)} times the weight"
    slower: Cure | None = None if picture.slower == 0 else "slow down"
    jump = continuity.discontinuity(p.path, p.duration)
    if jump is not None:
        return Answer(question="flight", level="bad", summary="by no vehicle", remarks=(jump,), term="jump")
    if picture.breaks:
        broken = tuple(one.summary for one in picture.breaks)
        summary = f"not by {p.vehicle.name}: {broken[0]}"
        return Answer(
            question="flight",
            level="mind",
            summary=summary,
            remarks=broken[1:],
            cure=slower or "vehicle",
            term="vehicle limits",
        )
    if p.vehicle != FREE:
        return Answer(
            question="flight", level="good", summary=f"yes, by {p.vehicle.name}: {thrust}", term="vehicle limits"
        )
    if picture.limits.thrust_to_weight > MOST_THRUST:
        summary = f"by no vehicle of the list: {thrust}, at most {significant(MOST_THRUST)}"
        return Answer(question="flight", level="mind", summary=summary, cure=slower, term="thrust")
    return Answer(
        question="flight",
        level="good",
        summary=f"no vehicle chosen; it takes a {thrust}",
        cure="vehicle",
        term="thrust",
    )


def model(picture: Picture) -> Answer:
    """Whether the observer models everything that the sensors do, and uses the model as derived."""
    p, misprinted = picture.preset, picture.settings.printed.model
    unmodelled = sensors.effects.unpredicted(p.sensors.unmodelled)
    remarks = (*sensors.effect_sentences(p.sensors), *verdicts.caveats(p.world.gravity, p.sensors.sigma.range))
    wrong = [*(["the paper's misprinted model"] if misprinted else []), *unmodelled]
    if wrong:
        summary = (
            f"no, the observer does not know of: {', '.join(unmodelled)}" if unmodelled else f"no: {wrong[0]} is in use"
        )
        if misprinted and unmodelled:
            summary += f"; {wrong[0]} is in use"
        cure: Cure = "model" if misprinted else "effects"
        return Answer(question="model", level="mind", summary=summary, remarks=remarks, cure=cure, term="model")
    if verdicts.caveats(p.world.gravity, p.sensors.sigma.range):
        return Answer(
            question="model", level="mind", summary="it holds of no real flight", remarks=remarks, term="model"
        )
    return Answer(
        question="model", level="good", summary="yes, the observer models every sensor", remarks=remarks, term="model"
    )


def subject_of(picture: Picture) -> str:
    """What the verdict is on: the motion that the page shows, and no recorded flight."""
    return f"The motion “{picture.preset.title or picture.settings.origin}”, as on the page."
