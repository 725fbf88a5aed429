"""The JSON objects of `rangenav study`."""

from pathlib import Path
from typing import Any

from rangenav.studies import requirements
from rangenav.studies import summary as summaries
from rangenav.studies.metrics import METRICS
from rangenav.studies.plan import Plan
from rangenav.studies.store import Store
from rangenav.studies.study import Study
from rangenav.studies.summary import Extremes
from rangenav.studies.tally import State

PARTS_PER_SECOND = 250.0
"""Parts that one program and its scheduler deal out, whatever the number of workers (docs/scale.md)."""


def plan_report(
    of: Study, planned: Plan, *, name: str, workers: int, cores: int, without_effect: tuple[str, ...]
) -> dict[str, Any]:
    """The JSON object of `rangenav study plan`."""
    return {
        "study": name,
        "title": of.file.title,
        "dimensions": dict(zip(of.dimensions, of.shape, strict=True)),
        "points": planned.points,
        "runs": planned.runs,
        "least_runs": planned.least_runs,
        "parts": planned.parts,
        "cpu_seconds": planned.seconds,
        "bytes": planned.bytes,
        "cpu_seconds_per_point": planned.cost.point,
        "cpu_seconds_per_run": planned.cost.run,
        "points_tried": planned.cost.tried,
        "points_tried_invalid": planned.cost.invalid,
        "invalid_reason": planned.cost.reason or None,
        "invalid_reasons": list(planned.cost.reasons),
        "workers": workers,
        "workers_busy": min(workers, planned.parts),
        "cores": cores,
        "seconds": max(planned.seconds / min(workers, planned.parts), planned.parts / PARTS_PER_SECOND),
        "without_effect": list(without_effect),
        "unused": list(of.file.unused),
    }


def run_report(of: Study, state: State, *, store: Path, seconds: float) -> dict[str, Any]:
    """The JSON object of `rangenav study run`."""
    return {
        "store": str(store),
        "title": of.file.title,
        "points": state.points,
        "invalid": state.invalid,
        "runs": state.runs,
        "parts": state.parts,
        "computed": state.computed,
        "seconds": seconds,
        "cpu_seconds": state.seconds,
        "interval": state.width,
        "stopping_rule_met": state.met,
    }


def show_report(of: Store) -> dict[str, Any]:
    """The JSON object of `rangenav study show`."""
    study, held = of.study, summaries.summary(of)

    return {
        "store": str(of.path),
        "title": study.file.title,
        "dimensions": dict(zip(study.dimensions, study.shape, strict=True)),
        "parts": {"all": held.parts, "done": held.done, "damaged": held.damaged},
        "points": held.points,
        "invalid": held.invalid,
        "runs": held.runs,
        "cpu_seconds": held.seconds,
        "stopping_rule_met": held.stopped,
        "windows": study.file.windows_judged,
        "varied_requirement": summaries.varied(study),
        "all_met": [
            {"estimator": estimator or None, "points": one.count, "at": list(map(study.place, one.first))}
            for estimator, one in held.together.items()
        ],
        "metrics": [_metric_report(study, name, estimator, one) for (name, estimator), one in held.metrics.items()],
        "reasons": [{"words": words, "points": count} for words, count in held.reasons.most_common(20)],
    }


def _metric_report(study: Study, name: str, estimator: str, of: Extremes) -> dict[str, Any]:
    """What a store holds of one metric of one estimator."""
    row, bounds = METRICS[name], [one for one in of.bounds if one is not None]
    levels = sorted({one.level for one in bounds})

    def place(index: int) -> dict[str, float | str] | None:
        return None if index < 0 else study.place(index)

    return {
        "metric": name,
        "title": row.title,
        "unit": row.unit,
        "estimator": estimator or None,
        "sampled": row.needs == "analysis" and not study.file.every_window,
        "finite": of.finite,
        "least": of.least if of.finite else None,
        "least_at": place(of.least_at),
        "largest": of.largest if of.finite else None,
        "largest_at": place(of.largest_at),
        "best": of.best if of.best_at >= 0 else None,
        "best_at": place(of.best_at),
        "middle": row.middle,
        "bound": {"level": levels[0], "at_most": bounds[0].most} if len(levels) == 1 else None,
        "bounds": levels,
        "bound_of": requirements.whose(name) if bounds else None,
        "bound_words": " or ".join(dict.fromkeys(one.words for one in bounds)) or None,
        "meets": of.meets if bounds else None,
        "meets_at": list(map(study.place, of.met.first)),
        "misses": of.missed.count if bounds else None,
        "misses_at": list(map(study.place, of.missed.first)),
        "meets_within": {study.parameter(k).path: list(ends) for k, ends in of.within.items()},
        "meets_across": [study.parameter(k).path for k, ends in of.within.items() if ends == _ends(study, k)],
        "why": _why(study, name, of),
    }


def _ends(study: Study, dimension: str) -> tuple[float, float]:
    """The least and the largest value of a parameter."""
    values = study.values[dimension]
    return float(values.min()), float(values.max())


def _why(study: Study, name: str, of: Extremes) -> str | None:
    """That no limit applies, or which limits the first point that cannot be flown breaks; None of other metrics."""
    if all(one is not None and one.words == requirements.NO_LIMITS for one in of.bounds) and of.bounds:
        return requirements.NO_LIMITS
    if name != "flyable" or not of.missed.first:
        return None
    point = of.missed.first[0]
    return f"point {point}: {'; '.join(requirements.broken(study.preset_at(point)))}"
