"""Repair: a small change of a chosen kind that makes a motion observable, within its vehicle's limits.

    repair(preset, by="tones")     a small change that meets μ, rank 13 and the predicted σ
    improve(preset, by="tones")    a change that lowers the predicted σ
A search tries motions by samples. Its result is written, read again and certified, with bounds. If the certificate does
not confirm the result, the search runs again with more margin.
"""

from collections.abc import Iterator

import msgspec
import numpy as np
from jaxtyping import Float
from numpy import ndarray as Array

from rangenav import provenance
from rangenav.certificate import Certificate, tone_search
from rangenav.certificate.figures import figures
from rangenav.inputs import require
from rangenav.observability import blindness
from rangenav.preset import Preset
from rangenav.progress import Cancelled, Progress, never, unheard
from rangenav.repair import confirmed, long_flight, path_changes, tones, ways_out
from rangenav.repair.change import KINDS, Change, ChangeKind
from rangenav.repair.export_target import ExportTarget
from rangenav.repair.outcome import (
    STAND_IN,
    CannotRepairError,
    Refused,
    Repair,
    WayOut,
    certificate_of,
    changed_preset,
    failure_reason,
    outcome,
    report,
)
from rangenav.repair.search import Budget, Search, Trial, sharpest
from rangenav.vehicle import FREE, WORDS

EVALUATIONS = 1500
"""Motions that a search may try, about 4 ms each."""
WORK = 3e8
"""The work of a whole search, in the units of `tone_search`; a long formula is tried less often."""
IMPROVEMENT = 0.9
"""An improvement must lower σ to this share or below."""
MOST_EFFORT: dict[ChangeKind, float] = {
    "tones": 1.0,
    "amplitude": 0.5,
    "frequency": 0.5,
    "timescale": 0.5,
    "waypoints": 0.5,
}
"""The largest effort of an improvement, unless the caller gives one."""
SLOWING: tuple[ChangeKind, ...] = ("amplitude", "frequency", "timescale")
"""Kinds of change that can also ask less of a vehicle."""
NOTHING = "nothing had to be changed"
REPAIRED, IMPROVED = ", repaired", ", improved"


def repair(
    preset: Preset,
    *,
    by: ChangeKind = "tones",
    target: ExportTarget | None = None,
    evaluations: int = EVALUATIONS,
    progress: Progress = unheard,
    cancelled: Cancelled = never,
) -> Repair:
    """The smallest change of one kind that meets the requirement within the vehicle's limits.

    target: the format that the changed motion is to be exported to; it then is, with a certificate.
    `progress` and `cancelled` are called before every motion that is tried. Raises CannotRepairError with the reason if
    this kind of change does not meet the requirement, and CancelledError when cancelled.
    """
    require(by in KINDS, f"by must be one of {', '.join(KINDS)}, got {by}")
    before = certificate_of(preset)
    budget = _budget(preset, evaluations, progress, cancelled)
    if before.meets and (target is None or target.refusal(preset) is None):
        return outcome(preset, msgspec.structs.replace(preset, expect="observable"), by, NOTHING, 0.0, budget)
    _refuse_hopeless(preset, by, before)
    _refuse_unjudged(preset, by, before)
    searched, repeats = (preset, False) if target is None else (target.searched(preset), True)
    why = long_flight.too_long(preset)
    if why is not None:
        solution = long_flight.certified_tones(searched, budget, target=target) if by == "tones" else None
        if solution is None:
            raise CannotRepairError(f"{by}: {why}; {long_flight.way_out(by)}")
        return _confirmed(preset, by, *solution, budget)
    nearest_trials: list[Trial] = []
    refused: list[Refused] = []
    for limited in _limited(searched, by, budget):
        solution = confirmed.smallest(
            _changes(limited, by, before.excitation.at, budget, repeats=repeats),
            budget,
            target=target,
            nearest_trials=nearest_trials,
            refused=refused,
        )
        if solution is not None:
            return _confirmed(preset, by, *solution, budget)
    reason = failure_reason(preset, by, budget, nearest_trials, refused)
    raise ways_out.ways_out(preset, by, reason, before.excitation.at)


def improve(
    preset: Preset,
    *,
    by: ChangeKind = "tones",
    most_effort: float | None = None,
    evaluations: int = EVALUATIONS,
    progress: Progress = unheard,
    cancelled: Cancelled = never,
) -> Repair:
    """A change of one kind that lowers the predicted σ, keeping μ, within the vehicle's limits and `most_effort`.

    Raises CannotRepairError if the motion is blind, which is for `repair`, or if σ does not fall by a tenth.
    """
    require(by in KINDS, f"by must be one of {', '.join(KINDS)}, got {by}")
    refused = path_changes.refusal(by, preset) or long_flight.too_long(preset)
    if refused is not None:
        raise CannotRepairError(f"{by}: {refused}")
    current = figures(preset)
    if not np.isfinite(current.sigma):
        raise CannotRepairError(
            f"{by}: the motion is blind, so there is no predicted error to improve: repair it first", ways=("repair",)
        )
    budget = _budget(preset, evaluations, progress, cancelled)
    limit = MOST_EFFORT[by] if most_effort is None else most_effort
    for limited in _limited(preset, by, budget):
        change = _wide(limited, by)
        search = Search(change=change, budget=budget, margin=confirmed.MARGINS[0], needs=("excitation",))
        theta = sharpest(search, limit)
        if theta is None:
            continue
        after = changed_preset(change, change.rounded(theta), preset, IMPROVED)
        if figures(after).sigma <= IMPROVEMENT * current.sigma and _kept(after, limited):
            return outcome(preset, after, by, change.description(change.rounded(theta)), change.effort(theta), budget)
    raise CannotRepairError(
        f"{by}: no change of effort {limit:g} or less, within the limits, lowers the {current.sigma:.3g} m by a tenth"
    )


def _confirmed(preset: Preset, by: ChangeKind, change: Change, theta: Float[Array, "n"], budget: Budget) -> Repair:
    """The result of a change that a certificate has confirmed."""
    after = changed_preset(change, theta, preset, REPAIRED)
    return outcome(preset, after, by, change.description(theta), change.effort(theta), budget)


def _kept(after: Preset, limited: Preset) -> bool:
    """Whether the certificate confirms that excitation and rank are as required and the limits are kept."""
    checks = certificate_of(msgspec.structs.replace(after, vehicle=limited.vehicle)).checks
    return all(one.met for one in checks if one.name != "accuracy")


def _budget(preset: Preset, evaluations: int, progress: Progress, cancelled: Cancelled) -> Budget:
    work = tone_search.WORK_PER_TRY + tone_search.WORK_PER_OPERATION * preset.path.operations()
    most = min(evaluations, int(WORK / work))
    return Budget(total=most, most=most, progress=progress, cancelled=cancelled)


def _limited(preset: Preset, by: ChangeKind, budget: Budget) -> Iterator[Preset]:
    """The preset with the vehicles whose limits are to be kept: its own, or for a free one the stand-in's first.

    The stand-in gets half of the trials, and none if it cannot fly the path as it is: more motion is no easier.
    """
    if preset.vehicle == FREE:
        small = msgspec.structs.replace(preset, vehicle=STAND_IN)
        if by in SLOWING or figures(small).worst_excess <= 0:
            budget.most = budget.total // 2
            yield small
    budget.most = budget.total
    yield preset


def _refuse_hopeless(preset: Preset, by: ChangeKind, before: Certificate) -> None:
    """Raise CannotRepairError where no change of this kind can help: scaling adds no snap along a new direction."""
    refused = path_changes.refusal(by, preset)
    ways: tuple[WayOut, ...] = () if by == "tones" else ("tones",)
    along = blindness.name(np.asarray(before.excitation.direction))
    if refused is None and by in ("amplitude", "timescale") and before.excitation.found is None:
        change = "larger or smaller" if by == "amplitude" else "faster or slower"
        refused = (
            f"the path has no snap along {along} in the {before.claim.window:g} s from t = {before.excitation.at:.4g} "
            f"s, and {change} it has none either; added tones would give it some"
        )
    if refused is None and by not in SLOWING and preset.vehicle != FREE and before.vehicle.broken:
        broken = before.vehicle.broken[0]
        near = broken.startswith(WORDS["anchor_distance_min"][0])
        way_out = "move the anchor" if near else "fly it slower first"
        ways = ("anchor",) if near else ("slower",)
        refused = f"the path is too much for {preset.vehicle.name} already: {broken}; {way_out}"
    if refused is not None:
        raise CannotRepairError(f"{by}: {refused}", ways=ways)


def _refuse_unjudged(preset: Preset, by: ChangeKind, before: Certificate) -> None:
    """Raise CannotRepairError for a fitted path that would meet its requirement as a design: it needs no change."""
    why = provenance.restriction(preset.source, preset.path)
    if why is not None and all(one.met for one in before.checks if one.name != "source"):
        raise CannotRepairError(f"{by}: {why}; as a design it meets its requirement already: {provenance.ADOPT}")


def _changes(preset: Preset, by: ChangeKind, at: float, budget: Budget, *, repeats: bool) -> Iterator[Change]:
    """The ways of one kind to try, the simplest first. repeats: whether added tones keep the path's own period."""
    if by == "tones":
        added = tone_search.smallest_tones(preset, at, tries=_spent(budget), repeats=repeats)
        if added is not None:
            yield tones.searched_tones(preset, added)
    elif by == "waypoints":
        for directions in tone_search.directions(preset, at):
            yield path_changes.waypoints(preset, directions)
    if by != "waypoints":
        yield _wide(preset, by, repeats=repeats)


def _wide(preset: Preset, by: ChangeKind, *, repeats: bool = False) -> Change:
    """The kind of change with all its unknowns."""
    match by:
        case "tones":
            return tones.free_tones(preset, repeats=repeats)
        case "amplitude":
            return path_changes.amplitude(preset)
        case "frequency":
            return path_changes.frequency(preset)
        case "timescale":
            return path_changes.timescale(preset)
        case "waypoints":
            return path_changes.waypoints(preset, tuple(np.eye(3)))


def _spent(budget: Budget) -> Iterator[int]:
    """One number for each trial that the budget has left; taking a number spends the trial."""
    while budget.left > 0:
        budget.spend()
        yield budget.left


__all__ = ["KINDS", "CannotRepairError", "ChangeKind", "ExportTarget", "Repair", "improve", "repair", "report"]
