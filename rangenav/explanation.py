"""Why a motion is observable or not, as the JSON object of `rangenav explain`: numbers, or null with a reason."""

import math
from typing import Any

import numpy as np

from rangenav import record
from rangenav.analysis import Analysis, analyse, how_long
from rangenav.motion import Motion
from rangenav.observability import ellipsoid, frozen, functions, printed
from rangenav.preset import Preset
from rangenav.report import verdict
from rangenav.twin import Refusal, Twin

Json = dict[str, Any]


def explanation(preset: Preset, outcome: Twin | Refusal, *, name: str) -> Json:
    """The JSON object of a preset: verdict, horizon, functions, excitation, frozen ranks, printed condition, twin."""
    analysed = analyse(preset)
    truth = record.simulated(record.truth_inputs(preset)).motion
    stopped = frozen.frozen(truth, analysed.gramian_at, windowed=analysed.rank)
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
    horizon = how_long(preset)
    return {
        "full_rank": {"from_start": horizon.full_rank[0], "worst": horizon.full_rank[1]},
        "accurate": {"from_start": horizon.accurate[0], "worst": horizon.accurate[1]},
        "words": horizon.summary,
    }


def _functions(preset: Preset, analysed: Analysis) -> Json:
    at, window = analysed.gramian_at, preset.requirement.window
    dependence = functions.functions(preset.path, preset.world.gravity, at, window)
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
        rank=analysed.rank,
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
