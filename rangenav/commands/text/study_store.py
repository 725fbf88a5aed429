"""`rangenav study show` for a person."""

import math

from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.study import MOST_REASONS, count, dimensions, done, duration, place, stopping
from rangenav.commands.text.verdict import Json
from rangenav.number_format import quantity, significant

SEVERAL = 2
"""Metrics that are compared with something, from which on it is said where all are met."""
RANKS = ("rank", "rank_nonlinear")


def shown(answer: Json) -> Report:
    """What a store holds."""
    parts = answer["parts"]
    complete = parts["done"] == parts["all"]
    damaged = f"{count(parts['damaged'], 'part')} damaged; study run computes what is missing"
    return Report(
        subject=layout.subject(answer["store"]),
        sign="✓" if complete else "!",
        answer="complete" if complete else f"{parts['done']} of {count(parts['all'], 'part')} done",
        title=answer["title"],
        groups=(
            *group("points", dimensions(answer["dimensions"]), damaged if parts["damaged"] else None),
            *group("done", f"{done(answer)}, {duration(answer['cpu_seconds'])} of CPU time"),
            *group("stop", stopping(answer)),
            *group("all together", *_together(answer)),
            *group("not compared", _varied(answer)),
            *(one for row in answer["metrics"] for one in group(row["metric"], *_extremes(row, answer))),
            *group("invalid", count(answer["invalid"], "point") if answer["invalid"] else None, _reasons(answer)),
        ),
    )


def _extremes(row: Json, answer: Json) -> list[str]:
    valid, of = answer["points"] - answer["invalid"], row["title"]
    of += f", {row['estimator']}" if row["estimator"] else ""
    of += f", {row['middle']} of the runs" if row["estimator"] and row["middle"] != "mean" else ""
    of += f", {answer['windows']}" if row["sampled"] else ""
    if not row["finite"]:
        return [f"{of}: no finite value"]
    of += f": finite at {row['finite']} of {valid} points" if row["finite"] < valid else ""
    if row["middle"] == "share" and not row["estimator"]:
        return [f"{of}: {_points(row, valid)}", *([row["why"]] if row["why"] else [])]
    if row["least"] == row["largest"]:
        ends = [f"{quantity(row['least'], row['unit'])} at all of them"]
    else:
        both = (("least", "from"), ("largest", "to"))
        ends = [f"{word} {quantity(row[key], row['unit'])} at {place(row[f'{key}_at'])}" for key, word in both]
    return [of, *ends, *_meeting(row, valid), *_best(row)]


def _best(row: Json) -> list[str]:
    """The best value where everything is met, if it is neither end."""
    if (
        row["best_at"] is None
        or row["least"] == row["largest"]
        or row["best_at"] in (row["least_at"], row["largest_at"])
    ):
        return []
    return [f"best where all is met: {quantity(row['best'], row['unit'])} at {place(row['best_at'])}"]


def _meeting(row: Json, valid: int) -> list[str]:
    """At how many points a metric meets its bound, and which they are."""
    if not row["bounds"]:
        return []
    return [f"{_bound(row)}: {_points(row, valid)}"]


def _bound(row: Json) -> str:
    """What a metric is compared with: `position error wanted (at most 0.5 m)`."""
    if row["middle"] != "share":
        return f"{row['bound_words']}{_rule(row)}"
    return f"{row['bound_words']} {'in half of the runs or more' if row['estimator'] else ''}".strip()


def _rule(row: Json) -> str:
    """`(at most 0.5 m)`; of presets with different requirements `(each preset's own: 0.5 m to 1 m)`."""
    if row["bound"] is None:
        return f" (each preset's own: {' to '.join(quantity(row['bounds'][k], row['unit']) for k in (0, -1))})"
    level = row["bound"]["level"]
    level = math.ceil(level) if row["metric"] in RANKS else level
    return f" ({'at most' if row['bound']['at_most'] else 'at least'} {quantity(level, row['unit'])})"


def _points(row: Json, valid: int) -> str:
    """`2 of 81 points: point 3, x = 0; point 4, x = 1`, `all but point 7, x = 2`, or the bounding box of many."""
    said = f"{row['meets']} of {valid} points"
    if not 0 < row["meets"] < valid:
        return said
    if row["meets"] <= len(row["meets_at"]):
        return f"{said}: {_named(row['meets_at'])}"
    if row["misses"] <= len(row["misses_at"]):
        return f"{said}, all but {_named(row['misses_at'])}"
    within = {path: ends for path, ends in row["meets_within"].items() if path not in row["meets_across"]}
    if not within:
        return f"{said}, from end to end of every parameter" if row["meets_within"] else said
    ends = ((path, significant(low), significant(high)) for path, (low, high) in within.items())
    where = (f"{path} = {low}" if low == high else f"{path} from {low} to {high}" for path, low, high in ends)
    return f"{said}; bounding box: {', '.join(where)}"


def _together(answer: Json) -> list[str]:
    """At how many points every requirement and limit is met, where more than one metric has such."""
    compared = {row["metric"] for row in answer["metrics"] if row["bounds"]}
    if len(compared) < SEVERAL:
        return []
    valid, lines = answer["points"] - answer["invalid"], []
    for one in answer["all_met"]:
        of = f"{one['estimator']}: " if len(answer["all_met"]) > 1 else ""
        named = f": {_named(one['at'])}" if 0 < one["points"] <= len(one["at"]) else ""
        such = f", such as {place(one['at'][0])}" if one["points"] > len(one["at"]) else ""
        lines.append(f"{of}all requirements and limits met: {one['points']} of {valid} points{named}{such}")
        lines += _failing(answer, one["estimator"], valid) if one["points"] < valid else []
    return lines


def _failing(answer: Json, estimator: str | None, valid: int) -> list[str]:
    """What fails at most points, and who requires it."""
    compared = (row for row in answer["metrics"] if row["bounds"] and row["estimator"] in (None, estimator))
    worst = max(compared, key=lambda row: row["misses"])
    where = f"at {worst['misses']} of {valid} points"
    return [f"fails most often, {where}: {worst['metric']}, {_bound(worst)}, {worst['bound_of']}"]


def _varied(answer: Json) -> str | None:
    path = answer["varied_requirement"]
    return path and f"numbers with requirements and limits: {path} changes them from point to point"


def _named(places: list[Json]) -> str:
    return "; ".join(map(place, places))


def _reasons(answer: Json) -> list[str]:
    shown = [f"{one['points']} × {one['words']}" for one in answer["reasons"][:MOST_REASONS]]
    return shown + (["and others; study export has all"] if len(answer["reasons"]) > MOST_REASONS else [])
