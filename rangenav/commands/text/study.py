"""`rangenav study` for a person."""

from typing import TYPE_CHECKING

from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.verdict import Json
from rangenav.number_format import percent, significant

if TYPE_CHECKING:
    from rangenav.studies.tally import State

MINUTE, HOUR, DAY = 60.0, 3600.0, 86400.0
SIZES = ("B", "kB", "MB", "GB", "TB")
THOUSAND = 1000.0
START = "and 10 to 30 s to start, more where kernels compile or other programs take the cores"
"""Imports, a trial and the start of workers: on an idle machine, and on one that is busy."""
MOST_REASONS = 5
STAGES = {"workers": "workers start", "kernels": "loading kernels (compiles the first time)"}


def progress(state: "State", watched: str | None, estimators: int = 1) -> str:
    """One line behind the bar: parts, rate, time left, and the 95 % interval of the watched metric at a median point,
    of several estimators that of the widest."""
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
        of = "the widest of all estimators at " if estimators > 1 else ""
        parts.append(f"{watched} ±{percent(state.width)} (95 %, {of}a typical point)")
    return " · ".join(parts)


def planned(answer: Json) -> Report:
    """What a study will take."""
    runs = count(answer["runs"], "run")
    if answer["least_runs"] != answer["runs"]:
        runs = f"{answer['least_runs']:,} to {runs}".replace(",", " ")
    tried, invalid = answer["points_tried"], answer["points_tried_invalid"]
    reasons = answer["invalid_reasons"][:MOST_REASONS]
    reasons += ["and others"] if len(answer["invalid_reasons"]) > MOST_REASONS else []
    each = [f"{about(answer['cpu_seconds_per_point'])} for each point"]
    each += [f"{about(answer['cpu_seconds_per_run'])} for each run"] if answer["runs"] else []
    each = each if invalid < tried else ["not known: no point that was tried is valid"]
    other = f" -o {layout.argument(answer['store'])}" if answer["store_taken"] else ""
    return Report(
        subject=layout.subject(answer["study"]),
        sign="!" if invalid or answer["without_effect"] or answer["unused"] or answer["store_taken"] else "✓",
        answer=f"{count(answer['points'], 'point')}, {about(answer['cpu_seconds'])} of one core",
        title=answer["title"],
        groups=(
            *group("points", dimensions(answer["dimensions"])),
            *group("runs", runs if answer["runs"] else "none: no metric is of a run"),
            *group("invalid", *([f"{invalid} of {tried} points that were tried"] if invalid else []), *reasons),
            *group("no effect", *(f"{path}: its values change no metric here" for path in answer["without_effect"])),
            *group("not used", *answer["unused"]),
            *group("time", f"{about(answer['cpu_seconds'])} of one core", *_shared(answer), *each),
            *group("store", f"at most {size(answer['bytes'])} in {count(answer['parts'], 'part')}"),
            *group("taken", answer["store_taken"]),
            *layout.next_commands(f"study run {layout.argument(answer['study'])}{other}"),
        ),
    )


def computed(answer: Json) -> Report:
    """A study that is complete."""
    store = layout.argument(answer["store"])
    return Report(
        subject=layout.subject(answer["store"]),
        sign="✓",
        answer=f"complete: {done(answer)}",
        title=answer["title"],
        groups=(
            *group(
                "now",
                f"{answer['computed']} of {count(answer['parts'], 'part')} in {duration(answer['seconds'])}",
                f"all parts together took {duration(answer['cpu_seconds'])} of CPU time",
            ),
            *group("stop", stopping(answer)),
            *group("invalid", f"{count(answer['invalid'], 'point')}; study show has the reasons")[
                : 1 if answer["invalid"] else 0
            ],
            *layout.next_commands(f"study show {store}", f"study export {store} --csv table.csv"),
        ),
    )


def exported(answer: Json) -> Report:
    """Tables that are written."""
    missing, parts = answer["parts_missing"], answer["parts"]
    points = count(answer["points_missing"], "point")
    return Report(
        subject=layout.subject(answer["store"]),
        sign="!" if missing else "✓",
        answer=f"exported without {points}: {missing} of {parts} parts are not computed" if missing else "exported",
        groups=group("files", *(f"{one['file']}: {count(one['rows'], 'row')}" for one in answer["files"])),
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
            *group("values", place(answer["values"])),
            *layout.next_commands(f"analyze {file}", f"simulate {file}"),
        ),
    )


def about(seconds: float) -> str:
    """An estimate: two digits, which is more than it is good for on a machine that does other work, too."""
    if seconds < 1:
        return f"about {significant(float(f'{THOUSAND * seconds:.2g}'), 2)} ms"
    return f"about {duration(seconds, digits=2)}"


def duration(seconds: float, *, digits: int = 3) -> str:
    """A time in the unit that a person uses for it."""
    for unit, name in ((DAY, "days"), (HOUR, "h"), (MINUTE, "min")):
        if seconds >= 2 * unit:
            return f"{significant(float(f'{seconds / unit:.{digits}g}'), digits)} {name}"
    return f"{significant(float(f'{seconds:.{digits}g}'), digits)} s" if seconds >= 1 else "less than 1 s"


def size(count: float) -> str:
    """Bytes in the unit that a person uses for so many."""
    for name in SIZES[:-1]:
        if count < THOUSAND:
            return f"{count:.3g} {name}"
        count /= THOUSAND
    return f"{count:.3g} {SIZES[-1]}"


def done(answer: Json) -> str:
    """How many points and runs are done."""
    runs = count(answer["runs"], "run") if answer["runs"] else "no runs needed"
    return f"{count(answer['points'], 'point')}, {runs}"


def _shared(answer: Json) -> list[str]:
    """The wall time of all workers, and what limits it."""
    workers, busy, cores = answer["workers"], answer["workers_busy"], answer["cores"]
    words = f"{about(answer['seconds'])} with {count(workers, 'worker')}"
    if workers > cores:
        words += f", if each has a core of its own: this machine has {cores}"
    limit = f"no more than {count(busy, 'worker')} have something to do: a part is not divided"
    dealt = "one program and its scheduler deal out no more parts in this time"
    limits = [limit] if busy < workers else []
    limits += [dealt] if answer["seconds"] > answer["cpu_seconds"] / busy else []
    return [words, *limits, START]


def stopping(answer: Json) -> str | None:
    """At how many points the stopping rule is met; None without one."""
    met = answer["stopping_rule_met"]
    if met is None:
        return None
    left = answer["points"] - answer["invalid"] - met
    return f"the rule is met at {count(met, 'point')}" + (f"; {left} have the most runs without it" if left else "")


def place(at: Json) -> str:
    """`point 12, x = 0.5`; of values alone, without a number, `x = 0.5`."""
    pairs = ((path, value if isinstance(value, str) else significant(value)) for path, value in at.items())
    values = [f"point {at['point']}" if path == "point" else f"{path} = {value}" for path, value in pairs]
    return ", ".join(values) or "the one point"


def dimensions(of: Json) -> str:
    """Each dimension and how many values it has."""
    return " × ".join(f"{name} {length}" for name, length in of.items())


def count(number: int, noun: str) -> str:
    """`1 point`, `2 points`."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}".replace(",", " ")
