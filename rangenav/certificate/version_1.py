"""Certificates of version 1, computed again as they were: what 0.1.0 claimed is verified as it was claimed.

Their rank is that of sampled windows, their accuracy that of the worst sampled window with ranges from its own start,
their μ that of second-order bounds alone. They name a remedy, which is the result of a search.
"""

import msgspec
import numpy as np

from rangenav import verdict
from rangenav.certificate import remedy, requirements, schema, sections
from rangenav.certificate.schema import Certificate, Claim, figure
from rangenav.model import STATES
from rangenav.observability import accuracy, excitation, worst_rank
from rangenav.observability.excitation_bound import oriented
from rangenav.observability.worst_excitation import EVERY, WorstExcitation, by_second_order, sampled_starts
from rangenav.preset import Preset
from rangenav.sensors import noise_assumption

SIGMA_TIE = 1e-3
"""Predicted errors that differ by less than this share were equally bad: they came from an integral over the ranges."""


def as_version_1(preset: Preset, current: Certificate) -> Certificate:
    """The certificate of the current version as version 1 computes and states it."""
    path, needed = preset.path, preset.requirement
    excited = _excitation(by_second_order(path, needed.window, preset.duration, needed.mu), preset)
    claim, excitation_part = sections.claim_section(preset, excited), _without_scope(excited, needed.mu)
    rank = _rank(preset, claim)
    accuracy_part = _accuracy(preset)
    checks = requirements.requirements(excitation_part, rank, accuracy_part, current.jumps, current.vehicle, preset)
    failures = requirements.failures(checks, excitation_part, preset.expect, undetermined=False, rounded=False)
    meets = all(check.met for check in checks)
    return msgspec.structs.replace(
        current,
        version=1,
        certified=not failures,
        meets=meets,
        verdict=_word(rank, accuracy_part, preset),
        verdict_reason=msgspec.UNSET,
        caveats=msgspec.UNSET,
        checks=checks,
        failures=failures,
        remedy=msgspec.UNSET if meets else remedy.remedy(preset, excitation_part.at) or msgspec.UNSET,
        claim=claim,
        excitation=excitation_part,
        rank=rank,
        accuracy=accuracy_part,
    )


def _word(rank: schema.Rank, predicted: schema.Accuracy, preset: Preset) -> verdict.Word:
    """Version 1 called a motion of full rank weak where its ranges determine no position."""
    restriction = verdict.restriction(preset.path, preset.source, preset.duration)
    sigma = predicted.lifted.end.position
    word = verdict.judge(rank.rank, sigma, predicted.required, restriction=restriction).word
    return "weak" if word == "blind" and rank.rank == STATES else word


def _excitation(found: WorstExcitation, preset: Preset) -> WorstExcitation:
    """Where μ is sampled: by the least of 201 windows and of those at knots."""
    if found.bounds is not None:
        return found
    path, window = preset.path, preset.requirement.window
    start = sampled_starts(path, window, preset.duration - window)
    every = excitation.eigenvalues(path, start, window)[:, 0]
    k = int(np.argmin(every))
    values, axes = excitation.directions(path, float(start[k]), window)
    return WorstExcitation(
        starts=found.starts,
        reason=found.reason,
        mu=float(every[k]),
        at=float(start[k]),
        direction=oriented(axes[:, 0]),
        floor=excitation.floor(values[None]),
        count=len(start),
        bounds=None,
    )


def _without_scope(found: WorstExcitation, required: float) -> schema.Excitation:
    part = msgspec.structs.replace(sections.excitation_section(found, required), scope=msgspec.UNSET)
    if found.bounds is None and found.mu <= found.floor and isinstance(part.reason, str):
        return msgspec.structs.replace(part, reason=part.reason.removesuffix(" of rounding"))
    return part


def _rank(preset: Preset, claim: Claim) -> schema.Rank:
    period, last = preset.path.period, preset.duration - preset.requirement.window
    end = (period or last) if claim.starts == EVERY else last
    found = worst_rank.sampled_rank(preset.path, preset.world, preset.requirement.window, end)
    return schema.Rank(
        rank=found.rank,
        of=STATES,
        tolerance=figure(found.tolerance),
        smallest_singular=figure(found.smallest) if found.rank == STATES else None,
        at=figure(found.at),
        nonlinear=found.nonlinear,
        windows=found.count,
        blind=tuple(direction.summary for direction in found.directions),
        reason=msgspec.UNSET if found.rank == STATES else "smallest_singular: null, below the tolerance",
    )


def _accuracy(preset: Preset) -> schema.Accuracy:
    path, window, world, sensors = preset.path, preset.requirement.window, preset.world, preset.sensors
    sigma, rate, share = sensors.sigma.range, sensors.range_rate, sensors.arriving
    start = sampled_starts(path, window, preset.duration - window)
    curve = accuracy.end_sigmas(path, world, start, window, sigma=sigma, rate=rate, kind="lifted", share=share)[:, 0]
    curve = np.nan_to_num(curve, nan=np.inf)
    at = float(start[int(np.argmax(curve >= float(curve.max()) * (1 - SIGMA_TIE)))])

    def ends(kind: accuracy.Problem) -> schema.Ends:
        start, end = (
            sections.sigma(
                accuracy.predict(path, world, at, window, sigma=sigma, rate=rate, kind=kind, at=moment, share=share)
            )
            for moment in ("start", "end")
        )
        return schema.Ends(start=start, end=end)

    return schema.Accuracy(
        required=preset.requirement.position_sigma,
        at=figure(at),
        range_sigma=sigma,
        range_rate=rate,
        noise=noise_assumption(sensors),
        lifted=ends("lifted"),
        nonlinear=ends("nonlinear"),
    )
