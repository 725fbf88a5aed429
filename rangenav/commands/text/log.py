"""`rangenav log` for a person."""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group, met
from rangenav.commands.text.spectrum_bar import spectrum_bar
from rangenav.commands.text.verdict import Json, plus_minus
from rangenav.flight_summary import more_ranges
from rangenav.logs import FEW, WholeRecord
from rangenav.model import STATES
from rangenav.number_format import CLOSE_UNITS, quantity, significant, vector
from rangenav.verdict import SIGNS, Sign

STATED, CONFIRMED = "the file says", ", as confirmed"
"""Words in a statement about a unit, or about gravity and field, that name its source."""
SINGLE = re.compile(r"(\S+) to \1 s")
"""A stretch of one window."""
NO_RANGES = {
    True: "no ranges to run on: --synthetic-ranges makes some from the true position",
    False: "no ranges to run on, and no true position to make some from",
}
"""Why no observer ran, by whether the file has true positions."""


def report(
    answer: Json, *, whole: WholeRecord, file: str, options: Mapping[str, str], has_truth: bool, required: float
) -> Report:
    """The report on a recorded flight: what it determines, and what the observers estimate.

    answer: the command's JSON object. whole: the verdict on the whole record. options: those typed with `file`, each
    flag with its values. has_truth: whether the file has true positions. required: m, above which a window is weak.
    """
    windows, observer = answer["informative"], answer["observer"]
    ranges, synthetic = answer["ranges_source"] or "", "--synthetic-ranges" in options
    few = more_ranges(windows["windows"])
    failure = "" if observer is None or whole.verdict not in ("observable", "weak") else observer.get("failure", "")
    sign: Sign = "?" if whole.verdict == "too few ranges" else SIGNS[whole.verdict]
    if failure:
        sign = "✗" if answer["observer"]["diverged"] else "!"
    verdict = f"{_answer(whole, required)}, {ranges}" if synthetic else _answer(whole, required)
    shown, sensed = windows["eigenvalues"], windows["motion_rank"]
    noise = shown[len(shown) - sensed - 1] if sensed < len(shown) else 0.0
    return Report(
        subject=answer["file"],
        sign=sign,
        answer=f"{verdict}; but {failure}" if failure else verdict,
        groups=(
            *group("the file", _file(answer), "" if synthetic else ranges, _findings(answer["findings"])),
            *group("what can be seen", _lengths(whole), _counts(windows), _worst(windows), few),
            *group("how well", _whole_accuracy(whole, required), _accuracy(windows, required)),
            *group("the observer", NO_RANGES[has_truth] if observer is None else _observer(answer, whole)),
            *group("the world", _world(answer)),
            *group("spectrum", spectrum_bar(shown, noise), "of the worst window"),
            *layout.next_commands(
                *(_command(file, {**options, **one}) for one in _next(answer, whole, options, has_truth))
            ),
        ),
    )


def columns(uses: Iterable[tuple[str, str]], file: Path) -> Report:
    """Every column of a file, and what it is used for."""
    named = [(name, use or "not used") for name, use in uses]
    width = max((len(use) for _, use in named), default=0)
    lines = [f"{use:<{width}}  {name}" for name, use in named]
    return Report(
        subject=layout.subject(file),
        sign="✓",
        answer=f"{len(lines)} columns",
        groups=group("columns", *lines) or group("columns", "the format has no named columns"),
    )


def _answer(whole: WholeRecord, required: float) -> str:
    """The verdict on the whole record, as the first line."""
    part = "the whole record" if whole.all_of_it else f"its part from {whole.begin:.4g} to {whole.end:.4g} s"
    match whole.verdict:
        case "observable":
            return f"observable: {part} determines the position within {quantity(whole.position, 'm')}"
        case "weak":
            size = quantity(whole.position, "m")
            return f"weak: {part} determines the position within {size}, and {quantity(required, 'm')} are required"
        case "blind":
            motion = whole.motion_rank < STATES
            what, rank = ("motion", whole.motion_rank) if motion else ("ranges", whole.rank)
            return f"blind: the {what} of {part} reach{'es' if motion else ''} rank {rank} of 13"
        case "too few ranges":
            count = "none" if whole.ranges == 0 else f"{whole.ranges} of them in {part}"
            moved = "its motion" if whole.all_of_it else f"its motion from {whole.begin:.4g} to {whole.end:.4g} s"
            return f"too few ranges: {count}, and 13 are needed at least; {moved} has rank 13"
        case "not judged":
            return f"not judged: {whole.restriction}"


def _lengths(whole: WholeRecord) -> str:
    """Which length of window suffices."""
    if whole.suffices is not None:
        return f"windows of {quantity(whole.suffices, 's')} are observable wherever they lie"
    if whole.shortest is not None:
        length = quantity(whole.shortest, "s")
        return f"some windows of {length} are observable; no length is observable everywhere"
    return "" if whole.restriction is not None or whole.verdict == FEW else "no length of window is observable"


def _file(answer: Json) -> str:
    rate = "" if answer["rate"] is None else f" at {quantity(answer['rate'], 'Hz')}"
    part = answer["imu_rows"] != answer["rows"]
    rows = f"{answer['imu_rows']} rows{' of the IMU' if part else ''}{rate}, {quantity(answer['duration'], 's')}"
    every = f" ({answer['rows']} rows in the file)" if part else ""
    return f"{answer['format']}, {rows}, {answer['frame']}{every}"


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
    judged = windows["verdict"] != "not judged"
    stretches = SINGLE.sub(r"\1 s", windows["words"].partition("; ")[2]) if judged else ""
    said = f"{sum(counts.values())} windows of {quantity(windows['window'], 's')}"
    return f"{said}: {kinds}{'; ' if stretches else ''}{stretches}"


def _worst(windows: Json) -> str:
    worst = f"the worst of them begins at {quantity(windows['at'], 's')}: rank {windows['rank']} of 13"
    if windows["rank"] < windows["motion_rank"]:
        ranges = "1 range" if windows["ranges"] == 1 else f"{windows['ranges']} ranges"
        return f"{worst} from {ranges}; its motion has rank {windows['motion_rank']}"
    return worst


def _whole_accuracy(whole: WholeRecord, required: float) -> str:
    """The predicted position error of the whole record, or of the part that the verdict is on."""
    if whole.position is None or whole.restriction is not None:
        return ""
    part = "the whole record" if whole.all_of_it else f"its part from {whole.begin:.4g} to {whole.end:.4g} s"
    reached = f"at the end of {part}: position {plus_minus(whole.position)} by the best estimator"
    return f"{reached}, required {plus_minus(required)}: {met(whole.position <= required)}"


def _accuracy(windows: Json, required: float) -> list[str]:
    """The predicted position error of the windows that have one."""
    median, worst = windows["position_median"], windows["position"]
    length = quantity(windows["window"], "s")
    if windows["verdict"] == "not judged":
        return []
    if median is None:
        return [f"no window of {length} predicts a position error"]
    count = windows["windows"]["observable"] + windows["windows"]["weak"]
    of = "the only one of rank 13" if count == 1 else f"median of the {count} of rank 13"
    at_worst = "the worst predicts none" if worst is None else f"{plus_minus(worst)} after the worst"
    return [
        f"after windows of {length}: position {plus_minus(median)} ({of}), {at_worst}",
        f"required {plus_minus(required)} after each of them: {met(worst is not None and worst <= required)}",
    ]


def _observer(answer: Json, whole: WholeRecord) -> list[str]:
    observer, lines = answer["observer"], []
    predicted = "" if whole.position is None else f"; predicted position {plus_minus(whole.position)}"
    for key, name, unit in (("position", "position", "m"), ("attitude_deg", "attitude", "°")):
        if observer[key] is None:
            continue
        quarters = ", ".join(_number(value) for value in observer[key]["quarters_rmse"])
        lines.append(f"{name} error {quarters}{'' if unit in CLOSE_UNITS else ' '}{unit}")
    lines = (
        [*lines, "(rms in the four quarters of a run that starts from zero)"]
        if lines
        else ["no errors: the file has no truth"]
    )
    if None not in observer["final_position"]:
        lines.append(f"ends at {vector(observer['final_position'])} m")
    if observer["diverged"]:
        lines.append(f"✗ diverged: {observer['diverged_reason']}")
    lines.append(f"on its ranges: {observer['fit']['words']} ({observer['fit']['gains']}){predicted}")
    if observer["range_residual"] is not None:
        lines.append(f"distance from the anchor off the ranges by {quantity(observer['range_residual'], 'm')} (rms)")
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


def _next(answer: Json, whole: WholeRecord, options: Mapping[str, str], has_truth: bool) -> list[dict[str, str]]:
    """Options worth adding: ranges where the observers had none, the window that suffices, or part of the record."""
    if answer["observer"] is None and has_truth:
        return [{"--anchor": options.get("--anchor", "X Y Z"), "--synthetic-ranges": "0.1"}]
    few = whole.verdict == FEW and whole.ranges > 0
    if answer["informative"]["verdict"] == "observable" or whole.restriction is not None or few:
        return []
    window = whole.suffices or whole.shortest or 2 * answer["informative"]["window"]
    other = window != answer["informative"]["window"] and window < answer["duration"]
    return [*([{"--window": f"{window:g}"}] if other else []), {"--begin": "SECONDS", "--end": "SECONDS"}]


def _command(file: str, options: Mapping[str, str]) -> str:
    return " ".join(["log", layout.argument(file), *(f"{flag} {value}" for flag, value in options.items())])
