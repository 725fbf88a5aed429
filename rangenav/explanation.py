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


def explanation(preset: Preset, found: Twin | Refusal, *, name: str) -> Json:
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
        "twin": _twin(found) if isinstance(found, Twin) else _refusal(found),
    }


def _horizon(preset: Preset) -> Json:
    found = how_long(preset)
    return {
        "full_rank": {"from_start": found.full_rank[0], "worst": found.full_rank[1]},
        "accurate": {"from_start": found.accurate[0], "worst": found.accurate[1]},
        "words": found.summary,
    }


def _functions(preset: Preset, analysed: Analysis) -> Json:
    at, window = analysed.gramian_at, preset.requirement.window
    found = functions.functions(preset.path, preset.world.gravity, at, window)
    return {"at": at, "rank": found.rank, "relations": list(found.relations), "unseen": list(found.unseen)}


def _printed(preset: Preset, truth: Motion, analysed: Analysis) -> Json:
    found = printed.compare(
        truth,
        analysed.windows.start,
        preset.requirement.window,
        mu=analysed.mu,
        floor=analysed.mu_floor,
        required=preset.requirement.mu,
        rank=analysed.rank,
    )
    return {
        "mu": found.mu,
        "mu_printed": found.mu_printed,
        "mu_formula": float(np.min(found.least_formula)),
        "mu_axes": float(np.min(found.least_axes)),
        "phi": found.phi,
        "phi_printed": found.phi_printed,
        "false_certificate": found.false_certificate,
        "words": found.summary,
    }


def _twin(found: Twin) -> Json:
    return {
        "kind": found.kind,
        "words": found.summary,
        "mismatch": found.mismatch,
        "nearest": found.nearest,
        "farthest": found.farthest,
        "turn": list(found.turn),
        "shift": found.shift.tolist(),
        "drift": found.drift.tolist(),
    }


def _refusal(found: Refusal) -> Json:
    numbers = {"sensitivity": found.sensitivity, "mismatch": found.mismatch}
    finite = {key: value if math.isfinite(value) else None for key, value in numbers.items()}
    return {"kind": None, "words": found.reason, "refused": found.kind, **finite}
