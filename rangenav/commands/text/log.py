"""`rangenav log` for a person."""

import re
from collections.abc import Mapping

from rangenav.commands.text import layout
from rangenav.commands.text.layout import SIGNS, Report, Sign, group, met
from rangenav.commands.text.spectrum_bar import spectrum_bar
from rangenav.commands.text.verdict import Json, plus_minus
from rangenav.number_format import CLOSE_UNITS, quantity, significant, vector

ANSWERS = {
    "observable": "observable in every window",
    "weak": "weak in every window: the predicted error exceeds the requirement",
    "blind": "blind in every window",
    "rank 13": "rank 13 in every window; without ranges no error is predicted",
    "partly": "informative in parts only",
}

STATED, CONFIRMED = "the file says", ", as confirmed"
"""How a finding about a unit, or about gravity and field, tells where it comes from."""
SINGLE = re.compile(r"(\S+) to \1 s")
"""A stretch of one window."""
NO_RANGES = {
    True: "no ranges to run on: --synthetic-ranges makes some from the true position",
    False: "no ranges to run on, and no true position to make some from",
}
"""Why no observer ran, by whether the file has true positions."""


def report(
    answer: Json, *, file: str, options: Mapping[str, str], has_truth: bool, required: float, sensed: int
) -> Report:
    """What a recorded flight could tell, and what the observers make of it.

    answer: the command's JSON object. options: those typed with `file`, each flag with its values. has_truth: whether
    the file has true positions. required: m, above which a window is weak. sensed: eigenvalues of the worst window
    that noise does not make.
    """
    windows, observer = answer["informative"], answer["observer"]
    sign: Sign = SIGNS[answer["verdict"]]  # pyright: ignore[reportAssignmentType]
    shown = windows["eigenvalues"]
    noise = shown[len(shown) - sensed - 1] if sensed < len(shown) else 0.0
    return Report(
        subject=answer["file"],
        sign=sign,
        answer=ANSWERS[answer["verdict"]],
        groups=(
            *group("the file", _file(answer), _findings(answer["findings"])),
            *group("what can be seen", _counts(windows), _worst(windows)),
            *group("how well", _accuracy(windows, required)),
            *group("the observer", NO_RANGES[has_truth] if observer is None else _observer(answer)),
            *group("the world", _world(answer)),
            *group("spectrum", spectrum_bar(shown, noise), "of the worst window"),
            *layout.next_commands(*(_command(file, {**options, **one}) for one in _next(answer, options, has_truth))),
        ),
    )


def _file(answer: Json) -> str:
    rate = "" if answer["rate"] is None else f" at {quantity(answer['rate'], 'Hz')}"
    return f"{answer['format']}, {answer['rows']} rows{rate}, {quantity(answer['duration'], 's')}, {answer['frame']}"


def _findings(findings: list[str]) -> list[str]:
    """What a person should know of a file: its statements in one line, those of the person, and the rest in full."""
    stated = [one for one in findings if STATED in one]
    confirmed = [one for one in findings if one.endswith(CONFIRMED)]
    others = [one for one in findings if one not in stated and one not in confirmed]
    units = "the other units" if confirmed else "units"
    names = dict.fromkeys(units if ":" in one else one.partition(" as ")[0] for one in stated)
    answers = ", ".join(one.removesuffix(CONFIRMED).replace(":", "") for one in confirmed)
    return [
        *([f"as confirmed: {answers}"] if answers else []),
        *([f"{', '.join(names)} as the file states them"] if names else []),
        *others,
    ]


def _counts(windows: Json) -> str:
    """How many windows there are of each kind, if there are several kinds, and where they are blind."""
    counts = {word: count for word, count in windows["windows"].items() if count}
    kinds = ", ".join(f"{count} {word}" for word, count in counts.items())
    stretches = SINGLE.sub(r"\1 s", windows["words"].partition("; ")[2])
    said = f"{sum(counts.values())} windows of {quantity(windows['window'], 's')}"
    return f"{said}: {kinds}; {stretches}" if len(counts) > 1 else said


def _worst(windows: Json) -> str:
    return f"worst from {quantity(windows['at'], 's')}: rank {windows['rank']} of 13"


def _accuracy(windows: Json, required: float) -> list[str]:
    """The predicted position error of the windows that have one."""
    median, worst = windows["position_median"], windows["position"]
    if median is None:
        return [] if windows["windows"]["rank 13"] else ["no window predicts a position error"]
    at_worst = "" if worst is None else f", {plus_minus(worst)} after the worst"
    return [
        f"position {plus_minus(median)} (median of the windows of rank 13){at_worst}",
        f"required {plus_minus(required)}: {met(worst is not None and worst <= required)}",
    ]


def _observer(answer: Json) -> list[str]:
    observer, lines = answer["observer"], []
    for key, name, unit in (("position", "position", "m"), ("attitude_deg", "attitude", "°")):
        if observer[key] is None:
            continue
        quarters = ", ".join(_number(value) for value in observer[key]["quarters_rmse"])
        lines.append(f"{name} error {quarters}{'' if unit in CLOSE_UNITS else ' '}{unit}")
    lines = [*lines, "(in the four quarters of the flight)"] if lines else ["no errors: the file has no truth"]
    if None not in observer["final_position"]:
        lines.append(f"ends at {vector(observer['final_position'])} m")
    if observer["innovation_rms"] is not None:
        lines.append(f"innovation of ½d²: {quantity(observer['innovation_rms'], 'm²')} rms")
    return [*lines, *([observer["reason"].removeprefix("null: ")] if "reason" in observer else [])]


def _number(value: float | None) -> str:
    return "–" if value is None else significant(value)


def _world(answer: Json) -> list[str]:
    world = answer.get("world")
    if world is None:
        return []
    return [
        f"gravity {vector(world['gravity'])} m/s², anchor {vector(world['anchor'])} m",
        f"magnetic field along {vector(world['magnetic'])}",
    ]


def _next(answer: Json, options: Mapping[str, str], has_truth: bool) -> list[dict[str, str]]:
    """Options worth adding: ranges where the observers had none, else another window or part of the record."""
    if answer["observer"] is None and has_truth:
        return [{"--anchor": options.get("--anchor", "X Y Z"), "--synthetic-ranges": "0.1"}]
    if answer["verdict"] in ("observable", "rank 13"):
        return []
    window = 2 * answer["informative"]["window"]
    longer = [{"--window": f"{window:g}"}] if window < answer["duration"] else []
    return [*longer, {"--begin": "SECONDS", "--end": "SECONDS"}]


def _command(file: str, options: Mapping[str, str]) -> str:
    return " ".join(["log", layout.argument(file), *(f"{flag} {value}" for flag, value in options.items())])
