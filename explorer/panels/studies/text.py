"""What a map says in words: its best cell, the share that meets the requirement, and where the present design lies."""

from explorer.model.study_axes import Candidate
from explorer.model.study_judgement import Judged, without_effect
from explorer.model.study_map import FLYABLE
from explorer.widgets.html import upper_first
from rangenav.number_format import percent, quantity
from rangenav.studies.maps import StudyMap
from rangenav.studies.metrics import METRICS
from rangenav.studies.requirements import NO_LIMITS, Bound

Names = tuple[Candidate, Candidate]
Values = tuple[float, float]
BLIND = "the motion leaves a direction blind at each of them, so try other values, other axes or another motion"
MATCHED = ": the gains are noise-matched, so they follow from the noise"
SAMPLED = "Values are those of the worst of some windows. Others may be worse; in tests their σ was at most 1 % larger."


def sentence(
    of: StudyMap,
    names: Names,
    metric: str,
    bound: Bound | None,
    judged: Judged,
    present: Values | None,
    *,
    inside: bool,
    matched: bool = False,
) -> str:
    """All of it. `present`: the values of the design on the page; None if the map is of another design. matched:
    whether its gains are noise-matched."""
    count = int(of.computed.sum())
    if not count:
        return "No point is computed yet."
    parts = _judgement(of, names, metric, bound, judged)
    parts += _idle(of, names, metric, matched=matched)
    if METRICS[metric].needs == "analysis" and judged.best is not None:
        parts.append(SAMPLED)
    invalid = int((of.reason != "").sum())
    if invalid:
        parts.append(f"{invalid} cannot be computed.")
    if present is not None:
        outside = "" if inside else ", outside this map"
        parts.append(f"The present design: {at(names, present)}{outside}.")
    return " ".join(parts)


def _judgement(of: StudyMap, names: Names, metric: str, bound: Bound | None, judged: Judged) -> list[str]:
    """The best cell and the shares; a metric without any finite value has neither."""
    if bound is not None and bound.words == NO_LIMITS:
        return [f"{upper_first(NO_LIMITS)}."]
    if judged.best is None:
        return [_no_value(of, metric)]
    count, parts = int(of.computed.sum()), [_best(of, names, metric, judged)]
    share = "" if judged.flyable in (None, 1.0) or metric == FLYABLE else " and keep the vehicle's limits"
    if judged.meeting is not None and bound is not None:
        parts.append(f"{percent(judged.meeting)} of {count} points meet “{bound.words}”{_rule(metric, bound)}{share}.")
    elif share:
        parts.append(f"{percent(judged.flyable or 0.0)} of {count} points keep the vehicle's limits.")
    return parts


def _no_value(of: StudyMap, metric: str) -> str:
    """Why there is nothing to compare."""
    row, valid = METRICS[metric], of.computed & (of.reason == "")
    begin = f"No computed point has a finite value of {row.title}"
    if not valid.any():
        return f"{begin}."
    return f"{begin}: {BLIND if row.needs == 'analysis' else 'it is infinite at each of them'}."


def _idle(of: StudyMap, names: Names, metric: str, *, matched: bool) -> list[str]:
    """Which parameters change nothing, and why where that is known."""
    idle = [names[axis] for axis in without_effect(of, metric)]
    if not idle:
        return []
    labels = " nor ".join(one.label for one in idle)
    subject = f"Neither {labels} changes" if len(idle) > 1 else f"{upper_first(labels)} does not change"
    why = matched and any(one.path.startswith("gains.riccati.") for one in idle)
    return [f"{subject} “{METRICS[metric].title}” on this map{MATCHED if why else ''}."]


def at(names: Names, values: Values) -> str:
    """The values of both parameters with their labels."""
    return ", ".join(f"{name.label} {quantity(value, name.unit)}" for name, value in zip(names, values, strict=True))


def written(metric: str, value: float) -> str:
    """A value of a metric: a number with its unit, yes or no, or a share of the runs."""
    row = METRICS[metric]
    if row.middle == "share":
        return f"{percent(value)} of the runs" if row.needs == "run" else "yes" if value else "no"
    return quantity(value, row.unit, otherwise="infinite")


def wanted(metric: str, bound: Bound) -> str:
    """A requirement with its level, for the legend."""
    row = METRICS[metric]
    if row.middle == "share":
        return f"{bound.words} in half of the runs" if row.needs == "run" else bound.words
    return f"{bound.words}: {quantity(bound.level, row.unit)}"


def _rule(metric: str, bound: Bound) -> str:
    row = METRICS[metric]
    if row.middle == "share":
        return " in half of the runs or more" if row.needs == "run" else ""
    return f" ({'at most' if bound.most else 'at least'} {quantity(bound.level, row.unit)})"


def _best(of: StudyMap, names: Names, metric: str, judged: Judged) -> str:
    assert judged.best is not None, "a map without values has no best cell"
    i, j = judged.best
    several = f"{judged.equal} points, such as " if judged.equal > 1 else ""
    place = at(names, (float(of.first[i]), float(of.second[j])))
    return f"Best: {written(metric, float(of.values[metric][i, j]))} at {several}{place}."
