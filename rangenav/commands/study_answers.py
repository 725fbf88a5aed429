"""The JSON objects of `rangenav study`."""

from pathlib import Path
from typing import Any

from rangenav.studies import summary as summaries
from rangenav.studies.metrics import METRICS
from rangenav.studies.plan import Plan
from rangenav.studies.running import State
from rangenav.studies.store import Store
from rangenav.studies.study import Study


def plan_report(of: Study, planned: Plan, *, name: str) -> dict[str, Any]:
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
        "interval": state.width,
        "stopping_rule_met": state.met,
    }


def show_report(of: Store) -> dict[str, Any]:
    """The JSON object of `rangenav study show`."""
    study, held = of.study, summaries.summary(of)

    def place(index: int) -> dict[str, float | str] | None:
        return None if index < 0 else study.at(index)

    return {
        "store": str(of.path),
        "title": study.file.title,
        "dimensions": dict(zip(study.dimensions, study.shape, strict=True)),
        "parts": {"all": held.parts, "done": held.done, "damaged": held.damaged},
        "points": held.points,
        "invalid": held.invalid,
        "runs": held.runs,
        "cpu_seconds": held.seconds,
        "stopping_rule_met": held.met,
        "metrics": [
            {
                "metric": name,
                "title": METRICS[name].title,
                "unit": METRICS[name].unit,
                "estimator": estimator or None,
                "finite": one.finite,
                "least": one.least if one.finite else None,
                "least_at": place(one.least_at),
                "largest": one.largest if one.finite else None,
                "largest_at": place(one.largest_at),
                "middle": METRICS[name].middle,
                "bound": None if one.bound is None else {"level": one.bound.level, "at_most": one.bound.most},
                "bound_words": None if one.bound is None else one.bound.words,
                "meets": one.meets if one.bound is not None else None,
                "meets_within": {study.parameter(k).path: list(ends) for k, ends in one.within.items()},
            }
            for (name, estimator), one in held.metrics.items()
        ],
        "reasons": [{"words": words, "points": count} for words, count in held.reasons.most_common(20)],
    }
