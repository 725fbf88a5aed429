"""`rangenav study` for a person."""

from typing import TYPE_CHECKING

from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.verdict import Json
from rangenav.number_format import percent, quantity, significant

if TYPE_CHECKING:
    from rangenav.studies.running import State

MINUTE, HOUR, DAY = 60.0, 3600.0, 86400.0
SIZES = ("B", "kB", "MB", "GB", "TB")
THOUSAND = 1000.0
MOST_REASONS = 5
STAGES = {"workers": "workers start", "kernels": "loading kernels (compiles the first time)"}


def progress(state: "State", watched: str | None) -> str:
    """One line behind the bar: parts, rate, time left, and the 95 % interval of the watched metric."""
    parts = [f"{state.done}/{state.parts} parts"]
    if state.done < state.parts and state.stage != "points":
        return " · ".join([*parts, STAGES[state.stage]])
    if state.workers == 0 and state.done < state.parts:
        return " · ".join([*parts, "waiting for workers"])
    if state.computed:
        parts.append(f"{significant(state.rate)} {'runs' if state.runs else 'points'}/s")
    if state.left is not None:
        parts.append(f"{duration(state.left)} left")
    if state.width is not None and watched is not None:
        parts.append(f"±{percent(state.width)} (95 %, {watched})")
    return " · ".join(parts)


def planned(answer: Json) -> Report:
    """What a study will take."""
    runs = f"{answer['runs']:,} runs".replace(",", " ")
    if answer["least_runs"] != answer["runs"]:
        runs = f"{answer['least_runs']:,} to {runs}".replace(",", " ")
    each = [f"{1e3 * answer['cpu_seconds_per_point']:.3g} ms for each point"]
    each += [f"{1e3 * answer['cpu_seconds_per_run']:.3g} ms for each run"] if answer["runs"] else []
    tried, invalid = answer["points_tried"], answer["points_tried_invalid"]
    return Report(
        subject=layout.subject(answer["study"]),
        sign="!" if invalid else "✓",
        answer=f"{_count(answer['points'], 'point')}, {duration(answer['cpu_seconds'])} of one core",
        title=answer["title"],
        groups=(
            *group("points", _dimensions(answer["dimensions"])),
            *group("runs", runs if answer["runs"] else "none: no metric is of a run"),
            *group("invalid", f"{invalid} of {tried} points that were tried; study show has the reasons after a run")[
                : 1 if invalid else 0
            ],
            *group("time", f"{duration(answer['cpu_seconds'])} of one core, shared by all workers", *each),
            *group("store", f"at most {size(answer['bytes'])} in {_count(answer['parts'], 'part')}"),
            *layout.next_commands(f"study run {layout.argument(answer['study'])}"),
        ),
    )


def computed(answer: Json) -> Report:
    """A study that is complete."""
    store = layout.argument(answer["store"])
    return Report(
        subject=layout.subject(answer["store"]),
        sign="✓",
        answer=f"complete: {_count(answer['points'], 'point')}, {_count(answer['runs'], 'run')}",
        title=answer["title"],
        groups=(
            *group("now", f"{answer['computed']} of {answer['parts']} parts in {duration(answer['seconds'])}"),
            *group("stop", _stopping(answer)),
            *group("invalid", f"{_count(answer['invalid'], 'point')}; study show has the reasons")[
                : 1 if answer["invalid"] else 0
            ],
            *layout.next_commands(f"study show {store}", f"study export {store} --csv table.csv"),
        ),
    )


def shown(answer: Json) -> Report:
    """What a store holds."""
    parts = answer["parts"]
    complete = parts["done"] == parts["all"]
    damaged = f"{_count(parts['damaged'], 'part')} damaged; study run computes what is missing"
    return Report(
        subject=layout.subject(answer["store"]),
        sign="✓" if complete else "!",
        answer="complete" if complete else f"{parts['done']} of {parts['all']} parts are done",
        title=answer["title"],
        groups=(
            *group("points", _dimensions(answer["dimensions"]), damaged if parts["damaged"] else None),
            *group("done", f"{_count(answer['points'], 'point')}, {_count(answer['runs'], 'run')}"),
            *group("stop", _stopping(answer)),
            *(
                one
                for row in answer["metrics"]
                for one in group(row["metric"], *_extremes(row, answer["points"] - answer["invalid"]))
            ),
            *group("invalid", _count(answer["invalid"], "point") if answer["invalid"] else None, _reasons(answer)),
        ),
    )


def exported(answer: Json) -> Report:
    """Tables that are written."""
    missing, parts = answer["parts_missing"], answer["parts"]
    points = _count(answer["points_missing"], "point")
    return Report(
        subject=layout.subject(answer["store"]),
        sign="!" if missing else "✓",
        answer=f"exported without {points}: {missing} of {parts} parts are not computed" if missing else "exported",
        groups=group("files", *(f"{one['file']}: {_count(one['rows'], 'row')}" for one in answer["files"])),
    )


def copied(answer: Json) -> Report:
    """A study's file that is there to be changed."""
    file = layout.argument(answer["file"])
    return Report(
        subject=layout.subject(answer["study"]),
        sign="✓",
        answer=f"copied to {answer['file']}",
        groups=layout.next_commands(f"study plan {file}", f"study run {file}"),
    )


def saved(answer: Json) -> Report:
    """The preset of a point."""
    file = layout.argument(answer["file"])
    return Report(
        subject=layout.subject(answer["store"]),
        sign="✓",
        answer=f"point {answer['point']} is the preset {answer['file']}",
        groups=(
            *group("values", _place(answer["values"])),
            *layout.next_commands(f"analyze {file}", f"simulate {file}"),
        ),
    )


def duration(seconds: float) -> str:
    """A time in the unit that a person uses for it."""
    for unit, name in ((DAY, "days"), (HOUR, "h"), (MINUTE, "min")):
        if seconds >= 2 * unit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds:.3g} s" if seconds >= 1 else "less than 1 s"


def size(count: float) -> str:
    """Bytes in the unit that a person uses for so many."""
    for name in SIZES[:-1]:
        if count < THOUSAND:
            return f"{count:.3g} {name}"
        count /= THOUSAND
    return f"{count:.3g} {SIZES[-1]}"


def _extremes(row: Json, valid: int) -> list[str]:
    of = f"{row['title']}, {row['estimator']}" if row["estimator"] else row["title"]
    if row["estimator"] and row["middle"] != "mean":
        of += f", {row['middle']} of the runs"
    if not row["finite"]:
        return [f"{of}: no finite value"]
    of += f": finite at {row['finite']} of {valid} points" if row["finite"] < valid else ""
    if row["middle"] == "share" and not row["estimator"]:
        return [f"{of}: {_points(row, valid)}"]
    both = (("least", "from"), ("largest", "to"))
    ends = (f"{word} {quantity(row[key], row['unit'])} at {_place(row[f'{key}_at'])}" for key, word in both)
    return [of, *ends, *_meeting(row, valid)]


def _meeting(row: Json, valid: int) -> list[str]:
    """At how many points a metric meets its bound, and between which values of each parameter they lie."""
    if row["bound"] is None:
        return []
    sign, level = "at most" if row["bound"]["at_most"] else "at least", quantity(row["bound"]["level"], row["unit"])
    rule = " in half of the runs" if row["middle"] == "share" else f" ({sign} {level})"
    return [f"{row['bound_words']}{rule}: {_points(row, valid)}"]


def _points(row: Json, valid: int) -> str:
    """`3 of 81 points; there x from 0 to 0.375, y = 0`."""
    said = f"{row['meets']} of {valid} points"
    if not 0 < row["meets"] < valid:
        return said
    ends = ((path, significant(low), significant(high)) for path, (low, high) in row["meets_within"].items())
    where = (f"{path} = {low}" if low == high else f"{path} from {low} to {high}" for path, low, high in ends)
    return f"{said}; there {', '.join(where)}"


def _stopping(answer: Json) -> str | None:
    met = answer["stopping_rule_met"]
    if met is None:
        return None
    left = answer["points"] - answer["invalid"] - met
    return f"the rule is met at {_count(met, 'point')}" + (f"; {left} have the most runs without it" if left else "")


def _place(at: Json) -> str:
    values = (f"{path} = {value if isinstance(value, str) else significant(value)}" for path, value in at.items())
    return ", ".join(values) or "the one point"


def _reasons(answer: Json) -> list[str]:
    shown = [f"{one['points']} × {one['words']}" for one in answer["reasons"][:MOST_REASONS]]
    return shown + (["and others; study export has all"] if len(answer["reasons"]) > MOST_REASONS else [])


def _dimensions(of: Json) -> str:
    return " × ".join(f"{name} {length}" for name, length in of.items())


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'' if number == 1 else 's'}".replace(",", " ")
