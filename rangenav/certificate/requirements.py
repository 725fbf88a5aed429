"""The requirements held against what was found, in words; and whether that is what the preset says it expects."""

import msgspec
import numpy as np

from rangenav import continuity, provenance
from rangenav.certificate import schema
from rangenav.certificate.schema import Certificate, Check, Expectation
from rangenav.model import STATES
from rangenav.observability import blindness
from rangenav.preset import Preset
from rangenav.provenance import Source
from rangenav.vehicle import FREE


def requirements(
    excited: schema.Excitation,
    rank: schema.Rank,
    predicted: schema.Accuracy,
    jumps: schema.Jumps,
    flying: schema.Flyability,
    preset: Preset,
) -> tuple[Check, ...]:
    """Every requirement, met or missed, and by how much."""
    window, came = preset.requirement.window, preset.source
    return (
        _excitation(excited, window),
        _rank(rank, window),
        _accuracy(predicted, window),
        _smooth(jumps),
        _vehicle(flying),
        *(() if came is None else (_source(came, preset),)),
    )


def failures(found: tuple[Check, ...], excited: schema.Excitation, expect: Expectation) -> tuple[str, ...]:
    """Why the checks do not come out as expected, a sentence each; none if they do.

    Expected unobservable, the motion must fail to be excited (by a bound where one is known) or have a rank below 13;
    expected weak, it must have both and miss the accuracy. What no vehicle could follow is never as expected.
    """
    check = {one.name: one for one in found}
    missed = [one.words for one in found if not one.met]
    if "source" in check and not check["source"].met:  # whatever is found besides is the fit's
        return tuple(check[name].words for name in ("source", "smooth") if not check[name].met)
    if expect == "observable":
        return tuple(missed)
    wrong = [check[name].words for name in ("smooth", "vehicle") if not check[name].met]
    seen = [check["excitation"], check["rank"]]
    if expect == "weak":
        wrong += [one.words for one in seen if not one.met]
        if check["accuracy"].met:
            wrong.append(f"expected weak, but {check['accuracy'].words}")
        return tuple(wrong)
    unexcited = not seen[0].met and (seen[0].proven or excited.upper is None)
    if not unexcited and seen[1].met:
        wrong.append(f"expected unobservable, but {seen[0].words}, and {seen[1].words}")
    return tuple(wrong)


def gate(certificate: Certificate) -> str | None:
    """None if the file may be exported; else one sentence: what is missing, where, by how much, and what would help."""
    if certificate.meets:
        return None
    missed = [one for one in certificate.checks if not one.met]
    if any(one.name == "source" for one in missed):
        missed = [one for one in missed if one.name in ("source", "smooth")]
    blind = "rank" in [one.name for one in missed]
    said = "; ".join(one.words for one in missed if not (blind and one.name == "accuracy"))  # which follows
    helps = "" if certificate.remedy is msgspec.UNSET else f"; it would do to {certificate.remedy}"
    return f"{certificate.title}: refused: {said}{helps}"


def _excitation(excited: schema.Excitation, window: float) -> Check:
    along, where = blindness.name(np.asarray(excited.direction)), f"the {window:g} s from t = {excited.at:.4g} s"
    needed = f"{excited.required:.4g} m²/s⁷ required"
    if excited.lower is None or excited.upper is None:
        found = excited.found or 0.0
        met, least = found >= excited.required, f"{found:.4g}" if found else "nothing"
        words = (
            f"on sampled windows the excitation is at least {least}, {needed}"
            if met
            else (f"the excitation along {along} over {where} is {least}, {needed}")
        )
        return Check(name="excitation", met=met, proven=False, words=words)
    if excited.lower >= excited.required:
        words = f"no window has an excitation below {excited.lower:.4g}, {needed}"
        return Check(name="excitation", met=True, proven=True, words=words)
    proven = excited.upper < excited.required
    found = "nothing" if excited.found is None else f"{excited.found:.4g}"
    words = f"the excitation along {along} over {where} is {found}, {needed}"
    if not proven:
        words = f"the excitation is only known to be at least {excited.lower:.4g} everywhere, {needed}"
    return Check(name="excitation", met=False, proven=proven, words=words)


def _rank(rank: schema.Rank, window: float) -> Check:
    met = rank.rank == STATES
    words = f"the rank is {rank.rank} of {STATES}"
    if not met:
        told = f": {'; '.join(rank.blind)}" if rank.blind else ""
        words += f" on the {window:g} s from t = {rank.at:.4g} s{told}"
    return Check(name="rank", met=met, proven=False, words=words)


def _accurate(predicted: schema.Accuracy) -> bool:
    sigma = predicted.lifted.end.position
    return sigma is not None and sigma <= predicted.required


def _accuracy(predicted: schema.Accuracy, window: float) -> Check:
    sigma = predicted.lifted.end.position
    said = "cannot be told" if sigma is None else f"is predicted to {sigma:.3g} m (1-σ)"
    words = (
        f"position {said} after the {window:g} s from t = {predicted.at:.4g} s, "
        f"{predicted.required:.3g} m required, by {predicted.noise}"
    )
    return Check(name="accuracy", met=_accurate(predicted), proven=False, words=words)


def _smooth(jumps: schema.Jumps) -> Check:
    jump = continuity.unflyable_jump(jumps.position, jumps.velocity)
    words = "neither position nor velocity jumps" if jump is None else jump
    return Check(name="smooth", met=jump is None, proven=True, words=words)


def _source(came: Source, preset: Preset) -> Check:
    why = provenance.restriction(came, preset.path)
    words = provenance.description(came, preset.path) if why is None else why
    return Check(name="source", met=why is None, proven=True, words=words)


def _vehicle(flying: schema.Flyability) -> Check:
    if flying.name == FREE.name and flying.flyable:
        words = "no vehicle's limits are asked to be kept"
    elif flying.flyable:
        words = f"within the limits of {flying.name}"
    else:
        words = f"{flying.name} cannot fly it: {'; '.join(flying.broken)}"
    return Check(name="vehicle", met=flying.flyable, proven=False, words=words)
