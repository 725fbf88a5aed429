"""Why a motion is observable or not, as the JSON object of `rangenav explain`: numbers, or null with a reason."""

import math
from typing import Any

import numpy as np

from rangenav import record
from rangenav.analysis import Analysis, analyse, how_long, shortest
from rangenav.model import STATES
from rangenav.motion import Motion
from rangenav.observability import ellipsoid, frozen, functions, printed, shortest_windows
from rangenav.observability.horizon import STARTS
from rangenav.preset import Preset
from rangenav.report import verdict
from rangenav.twin import Refusal, Twin

Json = dict[str, Any]


def explanation(preset: Preset, outcome: Twin | Refusal, *, name: str) -> Json:
    """The JSON object of a preset: verdict, horizon, functions, excitation, frozen ranks, printed condition, twin."""
    analysed = analyse(preset)
    truth = record.simulated(record.truth_inputs(preset)).motion
    stopped = frozen.frozen(truth, analysed.gramian_at, windowed=analysed.known_rank)
    shaken = ellipsoid.ellipsoid(preset.path, analysed.mu_at, preset.requirement.window)
    return {
        "preset": name,
        "window": preset.requirement.window,
        **verdict(preset, analysed),
        "horizon": _horizon(preset),
        "functions": _functions(preset, analysed),
        "excitation": {"at": shaken.start, "weakest": shaken.weakest.tolist(), "words": shaken.summary},
        "frozen": {"at": stopped.time, "body": stopped.body, "turned": stopped.turned, "words": stopped.summary},
        "printed": _printed(preset, truth, analysed),
        "twin": _twin(outcome) if isinstance(outcome, Twin) else _refusal(outcome),
    }


def _horizon(preset: Preset) -> Json:
    """How long windows must be: for rank 13 (and the 13 ranges that it takes) and for the required accuracy."""
    curves, rate = how_long(preset), preset.sensors.range_rate
    at_start, worst = curves.full_rank
    full_rank = {
        "from_start": _within(preset, at_start, shortest_windows.first_length(rate)),
        "worst": _within(preset, worst, shortest_windows.every_length(rate)),
    }
    windows = shortest(preset)
    accurate = {"from_start": windows.from_start, "worst": windows.every}
    needed = f"σ ≤ {preset.requirement.position_sigma:g} m"
    sentences = (
        _lasting(f"Rank {STATES}", full_rank, f"at the worst of {STARTS + 1} starts"),
        _lasting(needed, accurate, "in every window of the flight"),
    )
    return {"full_rank": full_rank, "accurate": accurate, "words": " ".join(sentences)}


def _within(preset: Preset, length: float | None, ranged: float) -> float | None:
    """The longer of two lengths (s): of rank 13 by its motion, and of 13 ranges; None if the flight is shorter."""
    longer = math.inf if length is None else max(length, ranged)
    return longer if longer <= preset.duration else None


def _lasting(what: str, lengths: Json, where: str) -> str:
    start, worst = lengths["from_start"], lengths["worst"]
    at_start = "not from the start" if start is None else f"after {start:.3g} s from the start"
    return f"{what}: {at_start}, {'not' if worst is None else f'after {worst:.3g} s'} {where}."


def _functions(preset: Preset, analysed: Analysis) -> Json:
    at, window = analysed.gramian_at, preset.requirement.window
    dependence = functions.functions(preset.path, preset.world.gravity, at, window, until=preset.duration)
    return {
        "at": at,
        "rank": dependence.rank,
        "relations": list(dependence.relations),
        "unseen": list(dependence.unseen),
    }


def _printed(preset: Preset, truth: Motion, analysed: Analysis) -> Json:
    both_conditions = printed.compare(
        truth,
        analysed.windows.start,
        preset.requirement.window,
        mu=analysed.mu,
        floor=analysed.mu_floor,
        required=preset.requirement.mu,
        rank=analysed.known_rank,
    )
    return {
        "mu": both_conditions.mu,
        "mu_printed": both_conditions.mu_printed,
        "mu_formula": float(np.min(both_conditions.least_formula)),
        "mu_axes": float(np.min(both_conditions.least_axes)),
        "phi": both_conditions.phi,
        "phi_printed": both_conditions.phi_printed,
        "false_certificate": both_conditions.false_certificate,
        "words": both_conditions.summary,
    }


def _twin(twin: Twin) -> Json:
    return {
        "kind": twin.kind,
        "words": twin.summary,
        "mismatch": twin.mismatch,
        "nearest": twin.nearest,
        "farthest": twin.farthest,
        "turn": list(twin.turn),
        "shift": twin.shift.tolist(),
        "drift": twin.drift.tolist(),
    }


def _refusal(refusal: Refusal) -> Json:
    numbers = {"sensitivity": refusal.sensitivity, "mismatch": refusal.mismatch}
    finite = {key: value if math.isfinite(value) else None for key, value in numbers.items()}
    return {"kind": None, "words": refusal.reason, "refused": refusal.kind, **finite}
