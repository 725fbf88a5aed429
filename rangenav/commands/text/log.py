"""`rangenav log` for a person."""

from rangenav.commands.text import layout
from rangenav.commands.text.layout import SIGNS, Report, Sign, group
from rangenav.commands.text.spectrum_bar import spectrum_bar
from rangenav.commands.text.verdict import Json, plus_minus
from rangenav.number_format import quantity, significant, vector

ANSWERS = {
    "observable": "observable in every window",
    "weak": "weak in every window: the predicted error exceeds the requirement",
    "blind": "blind in every window",
    "rank 13": "rank 13 in every window; without ranges no error is predicted",
    "partly": "informative in parts only",
}


def report(answer: Json, *, file: str, required: float, sensed: int) -> Report:
    """What a recorded flight could tell, and what the observers make of it.

    answer: the command's JSON object. required: m, above which a window is weak. sensed: eigenvalues of the worst
    window that noise does not make.
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
            *group("the file", _file(answer), "; ".join(answer["findings"])),
            *group("what can be seen", windows["words"], _worst(windows)),
            *group("how well", _accuracy(windows, required)),
            *group("the observer", _observer(answer)),
            *group("the world", _world(answer)),
            *group("spectrum", spectrum_bar(shown, noise), "of the worst window"),
            *layout.next_commands(*(_next(answer, file) if observer is None or sign != "✓" else ())),
        ),
    )


def _file(answer: Json) -> str:
    rate = "" if answer["rate"] is None else f" at {quantity(answer['rate'], 'Hz')}"
    return f"{answer['format']}, {answer['rows']} rows{rate}, {quantity(answer['duration'], 's')}, {answer['frame']}"


def _worst(windows: Json) -> str:
    return f"worst from {quantity(windows['at'], 's')}: rank {windows['rank']} of 13"


def _accuracy(windows: Json, required: float) -> list[str]:
    """The predicted position error of the windows that have one."""
    median, worst = windows["position_median"], windows["position"]
    if median is None:
        return ["no window predicts a position error"]
    at_worst = "" if worst is None else f", {plus_minus(worst)} after the worst"
    return [
        f"position {plus_minus(median)} (median of the windows of rank 13){at_worst}",
        f"required {plus_minus(required)}",
    ]


def _observer(answer: Json) -> list[str]:
    observer = answer["observer"]
    if observer is None:
        return [answer["observer_reason"].removeprefix("null: ")]
    lines = []
    for key, name, unit in (("position", "position", "m"), ("attitude_deg", "attitude", "°")):
        if observer[key] is None:
            continue
        quarters = ", ".join(_number(value) for value in observer[key]["quarters_rmse"])
        lines.append(f"{name} error {quarters} {unit}")
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


def _next(answer: Json, file: str) -> tuple[str, ...]:
    typed = layout.argument(file)
    if answer["observer"] is None:
        return (f"log {typed} --anchor X Y Z --synthetic-ranges 0.1",)
    window = 2 * answer["informative"]["window"]
    longer = (f"log {typed} --window {window:g}",) if window < answer["duration"] else ()
    return (*longer, f"log {typed} --begin SECONDS --end SECONDS")
