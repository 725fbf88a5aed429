"""`rangenav simulate` for a person."""

import math
from pathlib import Path

from rangenav import record
from rangenav.analysis import analyse
from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.verdict import Json
from rangenav.number_format import quantity
from rangenav.preset import Preset
from rangenav.verdict import Sign

LIMITS = {
    "position": quantity(record.SETTLED_POSITION, "m"),
    "attitude": quantity(math.degrees(record.SETTLED_ATTITUDE), "°"),
}
"""Below which an error counts as settled."""


def report(preset: Preset, answer: Json, *, name: str, saved: Path | None) -> Report:
    """How well the cascaded observer does on a preset; `answer` is the command's JSON object."""
    sign, said = _headline(answer)
    verdict = analyse(preset).verdict
    blind = verdict.word == "blind" or "note" in answer
    if not verdict.judged:
        sign, said = "?", f"{verdict}; this run {said}"
    elif blind and "reason" not in answer:
        sign, said = "✗", "blind: the position cannot be told, and the errors say nothing about accuracy"
    typed = layout.argument(name)
    following = (f"explain {typed}",) if blind else (f"analyze {typed}", f"tune {typed}")
    return Report(
        subject=layout.subject(name),
        sign=sign,
        answer=said,
        title=preset.title,
        groups=(
            *group("what ran", _run(answer)),
            *group("settles", _settling(answer["settle"])),
            *group("ranges", answer.get("fits", answer["fit"]["words"])),
            *group("steady error", _errors(answer["steady"], "_rmse"), "root mean square over the last quarter"),
            *group("at the end", _errors(answer["final"], "")),
            *group("why", answer.get("note"), answer.get("reason", "").removeprefix("null: ")),
            *group("sensors", answer.get("unmodelled")),
            *group("saved", str(saved) if saved else None),
            *layout.next_commands(*following),
        ),
    )


def _headline(answer: Json) -> tuple[Sign, str]:
    if "reason" in answer:
        return "✗", "the estimate overflows"
    unsettled = [name for name in LIMITS if answer["settle"][f"{name}_s"] is None]
    if unsettled:
        return "!", " and ".join(f"{name} does not settle below {LIMITS[name]}" for name in unsettled)
    steady = answer["steady"]
    position, attitude = quantity(steady["position_rmse"], "m"), quantity(steady["attitude_rmse_deg"], "°")
    return "✓", f"settles, and is then off by {position} and {attitude}"


def _run(answer: Json) -> list[str]:
    seed = f"seed {answer['seed']}"
    runs = f"medians of {answer['runs']} runs from {seed}" if "runs" in answer else seed
    time = quantity(answer["microseconds_per_step"], "µs")
    return [f"{answer['model']} model, {runs}", f"{answer['steps']} steps, {time} each"]


def _settling(settle: Json) -> list[str]:
    lines = []
    for what, limit in LIMITS.items():
        since = settle[f"{what}_s"]
        lines.append(
            f"✗ {what}: does not stay below {limit} over the last tenth of the run"
            if since is None
            else f"✓ {what}: below {limit} from {quantity(since, 's')}"
        )
    return lines


def _errors(errors: Json, suffix: str) -> list[str]:
    position, attitude = quantity(errors[f"position{suffix}"], "m"), quantity(errors[f"attitude{suffix}_deg"], "°")
    velocity, gravity = quantity(errors[f"velocity{suffix}"], "m/s"), quantity(errors[f"gravity{suffix}"], "m/s²")
    return [f"position {position}, attitude {attitude}", f"velocity {velocity}, gravity {gravity}"]
