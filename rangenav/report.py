"""Analysis and record as the JSON objects of the command line: finite numbers, or null with a reason."""

import math
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import msgspec
import numpy as np

from rangenav import continuity, motion, range_fit, record
from rangenav import verdict as verdicts
from rangenav.analysis import Analysis, analyse
from rangenav.observability import excitation
from rangenav.observability.accuracy import Accuracy
from rangenav.preset import Preset
from rangenav.record import Record, Summary
from rangenav.sensors import active_effects, effect_sentences, noise_assumption

Json = dict[str, Any]
Median = Callable[[str], float | None]
"""(a figure of `Summary`) → its median over the runs; None if it is not finite."""


def analysis_report(preset: Preset, analysis: Analysis, *, name: str) -> Json:
    """What `rangenav analyze --json` prints."""
    window = analysis.windows.window
    truth = record.simulated(record.truth_inputs(preset))
    return {
        "preset": name,
        "duration": preset.duration,
        "limits": asdict(motion.limits(truth.motion, world=preset.world)),
        "excitation": _excitation(preset, analysis, truth.motion),
        "gramian": {
            "window": window,
            "at": analysis.gramian_at,
            "eigenvalues": analysis.gramian.tolist(),
            "rank": analysis.rank,
            "tolerance": analysis.tolerance,
            "floor": analysis.floor,
            **_rank_claimed(analysis),
        },
        "nonlinear": {
            "window": window,
            "at": analysis.nonlinear_at,
            "eigenvalues": analysis.nonlinear.tolist(),
            "rank": analysis.nonlinear_rank,
            "floor": analysis.nonlinear_floor,
        },
        "blind_directions": [{"vector": d.vector.tolist(), "words": d.summary} for d in analysis.directions],
        "accuracy": {
            "window": window,
            "at": analysis.accuracy_at,
            "range_sigma": preset.sensors.sigma.range,
            "range_rate": preset.sensors.range_rate,
            "lifted": {
                "start": _accuracy(analysis.lifted_start, analysis.below_rounding),
                "end": _accuracy(analysis.lifted_end, analysis.below_rounding),
            },
            "nonlinear": {"start": _accuracy(analysis.nonlinear_start), "end": _accuracy(analysis.nonlinear_end)},
            **_every_window(analysis),
            **_ignored(preset),
        },
        **_jumps(preset),
        **_caveats(preset, analysis),
        **verdict(preset, analysis),
    }


def _caveats(preset: Preset, analysis: Analysis) -> Json:
    sentences = analysis.caveats(preset)
    return {"caveats": list(sentences)} if sentences else {}


def _jumps(preset: Preset) -> Json:
    """The derivatives that jump inside the flight, and what the excitation then counts; nothing for a smooth path."""
    sentences = continuity.jump_sentences(preset.path, preset.duration)
    alone = continuity.pieces_alone(preset.path, preset.duration)
    return ({"jumps": list(sentences)} if sentences else {}) | ({} if alone is None else {"excitation_counts": alone})


def verdict(preset: Preset, analysis: Analysis) -> Json:
    """The verdict; null, and why, of a path that was fitted to a record or that jumps."""
    source = {} if preset.source is None else {"source": msgspec.to_builtins(preset.source)}
    stated = {"verdict_words": analysis.verdict.summary, "verdict_sign": analysis.verdict.sign}
    if analysis.verdict.judged:
        reason = {"verdict_reason": str(analysis.verdict)} if analysis.verdict.reason else {}
        return {"verdict": analysis.verdict.word, **stated, **reason, **source}
    return {"verdict": None, **stated, "verdict_reason": f"null: {analysis.verdict}", **source}


def simulation_report(first: Record, others: list[Summary], *, name: str) -> Json:
    """What `rangenav simulate --json` prints: one run, or the medians of several seeds."""
    preset = first.preset
    summaries = [first.summary, *others]

    def median(key: str) -> float | None:
        values = [getattr(summary, key) for summary in summaries]
        middle = float(np.median([math.inf if value is None or math.isnan(value) else value for value in values]))
        return middle if math.isfinite(middle) else None

    report: Json = {
        "preset": name,
        "seed": preset.seed,
        "model": first.form,
        "steps": len(first.estimate.time) - 1,
        "microseconds_per_step": median("microseconds_per_step"),
        "peak": {"position": median("peak_position")},
        "settle": _settle(median),
        "steady": {
            "position_rmse": median("steady_position"),
            "velocity_rmse": median("steady_velocity"),
            "gravity_rmse": median("steady_gravity"),
            "attitude_rmse_deg": median("steady_attitude_deg"),
        },
        "final": {key: median(f"final_{key}") for key in ("position", "velocity", "gravity", "attitude_deg")},
    }
    analysed = analyse(preset)
    blind = analysed.blind
    report["fit"] = first.summary.fit.report(blind=blind)
    report |= _of_ranges(median, analysed)
    report |= verdict(preset, analysed)
    if any(_not_finite(summary) for summary in summaries):
        report["reason"] = "null: the estimate overflowed"
    reasons = [summary.divergence for summary in summaries if summary.divergence is not None]
    report["diverged"] = len(reasons) > 0
    if reasons:
        report["diverged_reason"] = reasons[0]
        many = f"{len(reasons)} of {len(summaries)} runs have diverged, the first: " if others else "diverged: "
        report["note"] = f"{many}{reasons[0]}" + ("; blind motion" if blind else "")
    elif blind:
        report["note"] = "blind motion: along what cannot be told the errors are this start's luck, no accuracy"
    if effect_sentences(preset.sensors):
        report["unmodelled"] = list(effect_sentences(preset.sensors))
    if others:
        report |= _of_runs(summaries, blind=blind)
    return report


def _of_ranges(median: Median, analysed: Analysis) -> Json:
    """The predicted 1-σ of the position after the worst window, the observer's own one at the end, and how far |p̂| is
    off the ranges (RMS); all in m."""
    sigma, residual, own = analysed.lifted_end.position, median("range_residual"), median("own_position")
    report: Json = {
        "predicted": {"position": sigma if math.isfinite(sigma) else None},
        "own": {"position": own},
        "range_residual": residual,
    }
    if own is None:
        report["own"]["reason"] = "null: the covariance overflowed"
    if not math.isfinite(sigma):
        report["predicted"]["reason"] = "null: the worst window does not determine the position"
    if residual is None:
        report["range_residual_reason"] = "null: no ranges, or the estimate overflowed"
    return report


def _of_runs(summaries: list[Summary], *, blind: bool) -> Json:
    """How many of several runs settle, have diverged, and fit their ranges in which way."""
    words = [summary.fit.word for summary in summaries]
    return {
        "runs": len(summaries),
        "runs_settled": {
            "position": sum(summary.settle_position_s is not None for summary in summaries),
            "attitude": sum(summary.settle_attitude_s is not None for summary in summaries),
        },
        "runs_diverged": sum(summary.diverged for summary in summaries),
        "runs_fit": {word: words.count(word) for word in range_fit.WORDS},
        "fits": range_fit.counted([summary.fit for summary in summaries], blind=blind),
    }


def _excitation(preset: Preset, analysis: Analysis, truth: motion.Motion) -> Json:
    window = analysis.windows.window
    signal = excitation.chosen_signal(truth, printed_formula=True, body_axes=True)
    printed = excitation.sampled_eigenvalues(signal, truth.time, analysis.windows.start, window)
    least = int(np.argmin(printed[:, 0]))
    report: Json = {
        "window": window,
        "mu": analysis.mu,
        "at": analysis.mu_at,
        "eigenvalues": analysis.excitation.tolist(),
        "floor": analysis.mu_floor,
        "required": preset.requirement.mu,
        "requirement": analysis.verdict.excitation,
        "bound_for_all_t": analysis.bound_for_all_t,
        "printed": {
            "mu": float(printed[least, 0]),
            "at": float(analysis.windows.start[least]),
            "eigenvalues": printed[least].tolist(),
        },
    }
    if analysis.proof is not None:
        found = analysis.proof.excitation
        lower, needed = found.lower or None, preset.requirement.mu
        report |= {"proven": found.proven(needed), "starts": found.starts, "lower": lower}
        why = found.reason or "no bound of μ above 0 is known"
        if found.lower is None:
            report["reason"] = f"lower: null, sampled only: {why}"
        elif lower is None:
            report["reason"] = "lower: null, no bound of μ above 0 is known"
            if found.proven(needed):
                report["reason"] += "; a computed window proves that the required μ is missed"
        elif found.reason is not None:
            report["reason"] = f"not every t: {found.reason}"
        if analysis.bound_for_all_t is None:
            report["bound_reason"] = f"null: {why}"
    return report


def _rank_claimed(analysis: Analysis) -> Json:
    """Whether the rank is proven of every window, or that of sampled windows."""
    if analysis.proof is None:
        return {}
    proven, found = analysis.proof.rank_proven, analysis.proof.rank
    claimed: Json = {"proven": proven, "starts": found.starts, "rank_bound": found.rank if proven else None}
    why = "" if found.reason is None else f": {found.reason}"
    if found.rounded:
        return {**claimed, "rounded": True, "reason": f"rank_bound: null: {verdicts.below_rounding(found.rank)}"}
    return claimed if proven else {**claimed, "reason": f"rank_bound: null, sampled only{why}"}


def _every_window(analysis: Analysis) -> Json:
    """How many ranges the worst window holds, and the σ that no window of the flight exceeds."""
    report: Json = {"ranges": analysis.ranges, "sphere": verdicts.sphere(analysis.farthest)}
    if analysis.proof is not None:
        found = analysis.proof.accuracy
        bound = found.windows.bound
        report |= {"proven": analysis.proof.accuracy_proven, "starts": found.starts}
        report |= {"bound": bound if math.isfinite(bound) else None}
        report |= {"rounded": True} if analysis.ranges_rounded else {}
        sentences = [f"not every t: {found.reason}"] if found.reason is not None else []
        if not math.isfinite(bound):
            sentences.append(f"bound: null, the worst window does not determine the position{_at_this(analysis)}")
        report |= {"reason": "; ".join(sentences)} if sentences else {}
    return report


def _at_this(analysis: Analysis) -> str:
    return " at this precision" if analysis.below_rounding else ""


def _accuracy(accuracy: Accuracy, rounded: bool = False) -> Json:
    report: Json = {key: value if math.isfinite(value) else None for key, value in asdict(accuracy).items()}
    if None in report.values():
        report["reason"] = verdicts.undetermined(rounded)
    return report


def _ignored(preset: Preset) -> Json:
    """A note on the predicted accuracy where sensors have effects that it does not model."""
    return {"assumes": noise_assumption(preset.sensors)} if active_effects(preset.sensors) else {}


def _settle(median: Median) -> Json:
    settle: Json = {"position_s": median("settle_position_s"), "attitude_s": median("settle_attitude_s")}
    limits = f"{record.SETTLED_POSITION:g} m, {math.degrees(record.SETTLED_ATTITUDE):g}°"
    if None in settle.values():
        settle["reason"] = f"null: does not stay below {limits} over the last tenth of the run"
    return settle


def _not_finite(summary: Summary) -> bool:
    numbers = {key: value for key, value in asdict(summary).items() if key not in ("range_residual", "own_position")}
    return not all(math.isfinite(value) for value in numbers.values() if isinstance(value, float))
