"""What a map says in words: its best cell, the share that meets the requirement, and where the present design lies."""

from explorer.model.study_axes import Candidate
from explorer.model.study_judgement import Judged
from rangenav.number_format import percent, quantity
from rangenav.studies.maps import StudyMap
from rangenav.studies.metrics import METRICS
from rangenav.studies.requirements import Bound

Names = tuple[Candidate, Candidate]
Values = tuple[float, float]


def sentence(
    of: StudyMap,
    names: Names,
    metric: str,
    bound: Bound | None,
    judged: Judged,
    present: Values | None,
    *,
    inside: bool,
) -> str:
    """All of it. `present`: the values of the design on the page; None if the map is of another design."""
    row, count = METRICS[metric], int(of.computed.sum())
    if not count:
        return "No point is computed yet."
    parts = [_best(of, names, metric, judged)]
    if judged.meeting is not None and bound is not None:
        sign = "at most" if bound.most else "at least"
        keeps = " and keep the vehicle's limits" if judged.flyable is not None and judged.flyable < 1 else ""
        level = quantity(bound.level, row.unit)
        parts.append(f"{percent(judged.meeting)} of {count} points meet “{bound.words}” ({sign} {level}){keeps}.")
    elif judged.flyable is not None and judged.flyable < 1:
        parts.append(f"{percent(judged.flyable)} of {count} points keep the vehicle's limits.")
    invalid = int((of.reason != "").sum())
    if invalid:
        parts.append(f"{invalid} cannot be computed.")
    if present is not None:
        outside = "" if inside else ", outside this map"
        parts.append(f"The present design: {at(names, present)}{outside}.")
    return " ".join(parts)


def at(names: Names, values: Values) -> str:
    """The values of both parameters with their labels."""
    return ", ".join(f"{name.label} {quantity(value, name.unit)}" for name, value in zip(names, values, strict=True))


def _best(of: StudyMap, names: Names, metric: str, judged: Judged) -> str:
    if judged.best is None:
        return f"No computed point has a finite value of {METRICS[metric].title}."
    i, j = judged.best
    value = quantity(float(of.values[metric][i, j]), METRICS[metric].unit)
    return f"Best: {value} at {at(names, (float(of.first[i]), float(of.second[j])))}."
