"""The first line of a report on a motion, and the groups that several reports share: accuracy and flyability."""

import math
from typing import Any

from rangenav import continuity, motion, provenance, record, vehicle, verdict, window_text
from rangenav.analysis import Analysis
from rangenav.commands.text.layout import met
from rangenav.model import STATES
from rangenav.number_format import quantity, significant
from rangenav.observability.accuracy import Accuracy
from rangenav.preset import Preset
from rangenav.sensors import noise_assumption
from rangenav.verdict import Sign

Json = dict[str, Any]
CHOOSE = "import --vehicle NAME, a table [vehicle] in the preset, or the page under World chooses one"
"""How a vehicle comes into a preset."""


def headline(preset: Preset, analysis: Analysis) -> tuple[Sign, str]:
    """The verdict in a sentence, with its sign."""
    window, duration, needed = preset.requirement.window, preset.duration, preset.requirement.position_sigma
    proven = analysis.proof is not None and analysis.proof.rank_proven
    unmet = analysis.verdict.unmet
    later = window_text.later_round(analysis.gramian_at, window, duration) != ""
    of = f"{quantity(window, 's')} of the repeated path" if later else window_text.of_flight(window, duration)
    windows = f"{'every window' if proven else 'all evaluated windows'} of {of}"
    starts = f"the weakest starts at {quantity(analysis.gramian_at, 's')}"
    where = f"; {starts}, outside this flight" if later else f" (weakest from {quantity(analysis.gramian_at, 's')})"
    too_large = f"the predicted error {quantity(analysis.lifted_end.position, 'm')} exceeds {quantity(needed, 'm')}"
    texts = {
        "observable": f"observable in {windows}{where}" + (f", but {unmet}" if unmet else ""),
        "weak": str(analysis.verdict)
        if analysis.rounded
        else f"weak: rank {STATES} in {windows}, but {analysis.verdict.reason or too_large}"
        + (f", and {unmet}" if unmet else ""),
        "blind": str(analysis.verdict)
        if analysis.verdict.reason
        else f"blind: rank {analysis.rank} of {STATES} in the window of {quantity(window, 's')} from "
        f"{quantity(analysis.gramian_at, 's')}{', outside this flight' if later else ''}",
        "not judged": str(analysis.verdict),
    }
    return analysis.verdict.sign, texts[analysis.verdict.word]


def short(preset: Preset, analysis: Analysis) -> str:
    """The verdict in a clause, for a report on something else: "weak: the predicted error 740 m exceeds 0.5 m"."""
    judged, needed = analysis.verdict, preset.requirement.position_sigma
    if judged.reason:
        return str(judged)
    if judged.word == "blind":
        return f"blind: rank {analysis.rank} of {STATES}"
    if judged.word == "weak":
        predicted = quantity(analysis.lifted_end.position, "m")
        return f"{judged.summary}: the predicted error {predicted} exceeds {quantity(needed, 'm')}"
    return judged.summary


def unjudged_help(preset: Preset) -> str | None:
    """What to do about a path that is not judged, one clause; None for a path that is."""
    if provenance.restriction(preset.source, preset.path) is not None:
        return provenance.ADOPT
    return None if continuity.discontinuity(preset.path, preset.duration) is None else continuity.JOIN


def accuracy_lines(preset: Preset, analysis: Analysis) -> list[str]:
    """Predicted errors at the end of the worst window, the requirement, and what the prediction assumes."""
    end, needed = analysis.lifted_end.position, preset.requirement.position_sigma
    return [
        *_positions(end, analysis.nonlinear_end.position),
        *_rates(analysis.lifted_end),
        f"required of the predicted error {plus_minus(needed)}: {_reached(preset, analysis)}",
        f"assumed: {noise_assumption(preset.sensors)}",
        *(f"! {sentence}" for sentence in analysis.caveats(preset)),
    ]


def _reached(preset: Preset, analysis: Analysis) -> str:
    """Whether the required σ is met, and that it asks for too little where the error says nothing."""
    most, sphere = _most(analysis), verdict.sphere(analysis.farthest)
    if sphere < most <= preset.requirement.position_sigma:
        return f"! met, but an error above {quantity(sphere, 'm')} says nothing of the position"
    return met(most <= preset.requirement.position_sigma)


def _most(analysis: Analysis) -> float:
    """The σ of the position (m) that no window exceeds; of sampled windows, that of the worst of them."""
    return analysis.lifted_end.position if analysis.proof is None else analysis.proof.accuracy.windows.bound


def _positions(lifted: float, nonlinear: float) -> list[str]:
    if not (math.isfinite(lifted) or math.isfinite(nonlinear)):
        return ["position not determined after the worst window, lifted or nonlinear"]
    return [
        f"position {plus_minus(lifted)} (1-σ, lifted) after the worst window",
        f"position {plus_minus(nonlinear)} after that same window (nonlinear, given a good start)",
    ]


def _rates(end: Accuracy) -> list[str]:
    velocity, gravity = quantity(end.velocity, "m/s"), quantity(end.gravity, "m/s²")
    return [f"velocity ±{velocity}, gravity ±{gravity} (lifted)"] if end.velocity == end.velocity else []


def plus_minus(metres: float | None) -> str:
    """±1.7 m, or that it is not determined."""
    said = quantity(metres, "m")
    return f"±{said}" if said[0].isdigit() else said


def flight_lines(preset: Preset) -> list[str]:
    """Whether the preset's vehicle can fly the motion, what stops it, and what the motion demands."""
    moved = record.simulated(record.truth_inputs(preset)).motion
    broken = vehicle.broken(moved, preset.vehicle, world=preset.world)
    limits = motion.limits(moved, world=preset.world)
    name = preset.vehicle.name
    jump = continuity.discontinuity(preset.path, preset.duration)
    if jump is not None:
        answer = ["✗ by no vehicle", f"✗ {jump}", *(f"✗ {one.summary}" for one in broken)]
    elif preset.vehicle == vehicle.FREE:
        how = "" if preset.source is None else f" ({CHOOSE})"
        answer = [f"no vehicle is chosen, so no limit applies{how}"]
    elif broken:
        answer = [f"✗ not by {name}", *(f"✗ {one.summary}" for one in broken)]
    else:
        answer = [f"✓ by {name}, within its limits"]
    return [
        *answer,
        f"at most {quantity(limits.speed, 'm/s')}, {significant(limits.thrust_to_weight)} × weight in thrust, "
        f"{quantity(limits.body_rate, 'rad/s')}",
        f"anchor at least {quantity(_metres(limits.anchor_distance_min), 'm')} away",
    ]


def _metres(distance: float) -> float:
    """A path through the anchor is 0 m from it, and not 1e-15 m."""
    return 0.0 if distance < 1e-9 else distance
