"""Every requirement with a sentence on whether it is met, and the comparison with what the preset expects."""

import math
from dataclasses import dataclass

import msgspec
import numpy as np

from rangenav import continuity, provenance, window_text
from rangenav.certificate import schema
from rangenav.certificate.schema import Certificate, Check, Expectation
from rangenav.model import STATES
from rangenav.observability import blindness
from rangenav.preset import Preset
from rangenav.provenance import Source
from rangenav.vehicle import FREE
from rangenav.verdict import Verdict, below_rounding, excitation_reached, says_nothing

NO_LIMITS = "no vehicle limits stated"
"""The sentence on a vehicle without limits: met, because nothing is required."""


@dataclass(frozen=True)
class _Windows:
    """How the sentences of a certificate name windows; of version 1, which named less, the duration is infinite."""

    window: float
    duration: float

    def one(self, at: float) -> str:
        return f"the {self.window:g} s from t = {at:.4g} s{window_text.later_round(at, self.window, self.duration)}"

    def every(self, scope: schema.Scope) -> str:
        return window_text.every(self.window, self.duration, scope.starts)

    def none(self, scope: schema.Scope | msgspec.UnsetType) -> str:
        if scope is msgspec.UNSET:
            return "no window"
        return window_text.none(self.window, self.duration, scope.starts)


def requirements(
    excitation: schema.Excitation,
    rank: schema.Rank,
    accuracy: schema.Accuracy,
    jumps: schema.Jumps,
    flyability: schema.Flyability,
    preset: Preset,
) -> tuple[Check, ...]:
    """Every requirement, and whether it is met. Each sentence has the number required and the number reached."""
    source = preset.source
    current = rank.scope is not msgspec.UNSET  # version 1 has none
    named = _Windows(preset.requirement.window, preset.duration if current else math.inf)
    return (
        _excitation(excitation, named),
        _rank(rank, named),
        _accuracy(accuracy, named),
        _smooth(jumps),
        _vehicle(flyability, current=current),
        *(() if source is None else (_source(source, preset),)),
    )


def failures(
    checks: tuple[Check, ...], excitation: schema.Excitation, expect: Expectation, *, undetermined: bool, rounded: bool
) -> tuple[str, ...]:
    """Why the checks differ from what the preset expects, one sentence each; none if they agree.

    observable: every check must be met.
    weak: excitation and rank must be met, and the accuracy must be missed, by an error that is determined.
    unobservable: the excitation must be missed (by a bound, where one is known), or the rank must be below 13, or the
    ranges of a window must leave the position undetermined.
    undetermined: whether the ranges of a window leave the position undetermined; version 1 did not ask.
    rounded: whether rank or position are undetermined because of rounding alone, which shows no motion to be
    unobservable.
    A path that jumps, or that the preset's vehicle cannot fly, is a failure whatever is expected.
    """
    check = {one.name: one for one in checks}
    missed = [one.words for one in checks if not one.met]
    if "source" in check and not check["source"].met:  # all other figures then describe the fit, not the flight
        return tuple(check[name].words for name in ("source", "smooth") if not check[name].met)
    if expect == "observable":
        return tuple(missed)
    wrong = [check[name].words for name in ("smooth", "vehicle") if not check[name].met]
    excited, full_rank = check["excitation"], check["rank"]
    if expect == "weak":
        wrong += [one.words for one in (excited, full_rank) if not one.met]
        if check["accuracy"].met or undetermined:
            wrong.append(f"expected weak, but {check['accuracy'].words}")
        return tuple(wrong)
    unexcited = not excited.met and (excited.proven or excitation.upper is None)
    deficient = not rounded and (undetermined or not full_rank.met)
    if not unexcited and not deficient:
        wrong.append(f"expected unobservable, but {excited.words}, and {full_rank.words}")
    return tuple(wrong)


def verdict_of(certificate: Certificate) -> Verdict:
    """The verdict that a certificate states, with whether the μ that its requirement asks for is reached."""
    excited, reason = certificate.excitation, certificate.verdict_reason
    return Verdict(
        word=certificate.verdict,
        reason="" if reason is msgspec.UNSET else reason,
        excitation=excitation_reached(excited.found or 0.0, excited.lower, excited.required),
    )


def gate(certificate: Certificate) -> str | None:
    """None if the preset may be exported; else one sentence: what is missing, where and by how much."""
    if certificate.meets:
        return None
    missed = [one for one in certificate.checks if not one.met]
    if any(one.name == "source" for one in missed):
        missed = [one for one in missed if one.name in ("source", "smooth")]
    blind = "rank" in [one.name for one in missed]
    # of a blind motion no accuracy can be predicted, so that sentence would add nothing
    sentences = "; ".join(one.words for one in missed if not (blind and one.name == "accuracy"))
    return f"{certificate.title}: refused: {sentences}"


def _excitation(excitation: schema.Excitation, named: _Windows) -> Check:
    along, where = blindness.name(np.asarray(excitation.direction)), named.one(excitation.at)
    needed = f"{excitation.required:.4g} m²/s⁷ required"
    if excitation.lower is None or excitation.upper is None:
        reached = excitation.found or 0.0
        met, least = reached >= excitation.required, f"{reached:.4g}" if reached else "nothing"
        words = (
            f"on sampled windows the excitation is at least {least}, {needed}"
            if met
            else (f"the excitation along {along} over {where} is {least}, {needed}")
        )
        return Check(name="excitation", met=met, proven=_missed(excitation), words=words)
    if excitation.lower >= excitation.required:
        no_window = named.none(excitation.scope)
        words = f"{no_window} has an excitation below {excitation.lower:.4g}, {needed}"
        return Check(name="excitation", met=True, proven=True, words=words)
    proven = excitation.upper < excitation.required or _missed(excitation)
    least = "nothing" if excitation.found is None else f"{excitation.found:.4g}"
    words = f"the excitation along {along} over {where} is {least}, {needed}"
    if not proven and (excitation.lower > 0 or excitation.scope is msgspec.UNSET):
        words = f"the excitation is only known to be at least {excitation.lower:.4g} everywhere, {needed}"
    elif not proven:
        words = f"{words}, and of the windows between the evaluated ones nothing is proven"
    return Check(name="excitation", met=False, proven=proven, words=words)


def _missed(excitation: schema.Excitation) -> bool:
    """Whether a computed window proves that the required μ is missed. Version 1 does not ask."""
    current = excitation.scope is not msgspec.UNSET
    return current and (excitation.found or 0.0) + excitation.floor < excitation.required


def _rank(rank: schema.Rank, named: _Windows) -> Check:
    met = rank.rank == STATES
    proven = rank.scope is not msgspec.UNSET and rank.scope.basis == "proven"
    if rank.rounded is True:
        words = f"on {named.one(rank.at)}: {below_rounding(rank.rank)}"
        return Check(name="rank", met=False, proven=False, words=words)
    words = f"the rank is {rank.rank} of {STATES}"
    if met and rank.scope is not msgspec.UNSET:
        words += f" on {named.every(rank.scope)}" if proven else " on sampled windows"
    if not met:
        directions = f": {'; '.join(rank.blind)}" if rank.blind else ""
        words += f" on {named.one(rank.at)}{directions}"
    return Check(name="rank", met=met, proven=proven, words=words)


def _accuracy(accuracy: schema.Accuracy, named: _Windows) -> Check:
    if accuracy.scope is msgspec.UNSET:  # version 1: by the worst sampled window
        return _sampled_accuracy(accuracy, named)
    sigma, bound = accuracy.lifted.end.position, None if accuracy.bound is msgspec.UNSET else accuracy.bound
    needed = f"{accuracy.required:.3g} m required of the prediction, by {accuracy.noise}"
    sphere = math.inf if accuracy.sphere is msgspec.UNSET else accuracy.sphere
    if bound is not None and bound <= min(accuracy.required, sphere):
        words = f"position is predicted to {bound:.3g} m (1-σ) or better after {named.every(accuracy.scope)}, {needed}"
        return Check(name="accuracy", met=True, proven=True, words=words)
    where, within = named.one(accuracy.at), sigma is not None and sigma <= accuracy.required
    prediction = f"is predicted to {sigma:.3g} m (1-σ)" if sigma is not None else "cannot be told"
    if sigma is None and accuracy.scope.basis == "sampled":
        prediction = "is not determined at this precision"
    words = f"position {prediction} after {where}, {needed}"
    if sigma is not None and sphere < sigma <= accuracy.required:
        words = f"{words}; {says_nothing(sigma, sphere / 2)}"
        return Check(name="accuracy", met=False, proven=True, words=words)
    if within:
        words = f"position is only known to be predicted to {bound or 0:.3g} m (1-σ) or better, {needed}"
    resolved = sigma is not None or accuracy.scope.basis == "proven"
    return Check(name="accuracy", met=False, proven=not within and resolved, words=words)


def _sampled_accuracy(accuracy: schema.Accuracy, named: _Windows) -> Check:
    """Of version 1, whose bound and scope are unset."""
    sigma, noise = accuracy.lifted.end.position, f"{accuracy.required:.3g} m required, by {accuracy.noise}"
    prediction = "cannot be told" if sigma is None else f"is predicted to {sigma:.3g} m (1-σ)"
    met = sigma is not None and sigma <= accuracy.required
    return Check(
        name="accuracy", met=met, proven=False, words=f"position {prediction} after {named.one(accuracy.at)}, {noise}"
    )


def _smooth(jumps: schema.Jumps) -> Check:
    jump = continuity.unflyable_jump(jumps.position, jumps.velocity, jumps.acceleration)
    words = "neither position nor velocity jumps" if jump is None else jump
    return Check(name="smooth", met=jump is None, proven=True, words=words)


def _source(source: Source, preset: Preset) -> Check:
    why = provenance.restriction(source, preset.path)
    words = provenance.description(source, preset.path) if why is None else why
    return Check(name="source", met=why is None, proven=True, words=words)


def _vehicle(flyability: schema.Flyability, *, current: bool) -> Check:
    if flyability.name == FREE.name and flyability.flyable:
        words = NO_LIMITS if current else "no vehicle's limits are asked to be kept"
    elif flyability.flyable:
        words = f"within the limits of {flyability.name}"
    else:
        who = "no vehicle can" if flyability.name == FREE.name else f"{flyability.name} cannot"
        words = f"{who} fly it: {'; '.join(flyability.broken)}"
    return Check(name="vehicle", met=flyability.flyable, proven=False, words=words)
