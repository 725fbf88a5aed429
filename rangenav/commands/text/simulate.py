"""`rangenav simulate` for a person."""

import math
from pathlib import Path

from rangenav import record
from rangenav.analysis import analyse
from rangenav.commands.text import layout
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.verdict import Json, plus_minus, short
from rangenav.number_format import quantity
from rangenav.preset import Preset
from rangenav.verdict import Sign

LIMITS = {
    "position": quantity(record.SETTLED_POSITION, "m"),
    "attitude": quantity(math.degrees(record.SETTLED_ATTITUDE), "°"),
}
"""Below which an error counts as settled."""
MATCHED = 'noise-matched gains may hold it: mode = "noise-matched" under [gains] in the preset (docs/trust.md)'
"""What to do about constant gains that have diverged on a motion that is not blind."""
BLIND = "blind: the position cannot be told, and the errors say nothing about accuracy"


def report(preset: Preset, answer: Json, *, name: str, saved: Path | None) -> Report:
    """How well the cascaded observer does on a preset; `answer` is the command's JSON object."""
    analysis = analyse(preset)
    verdict, motion = analysis.verdict, short(preset, analysis)
    blind = verdict.word == "blind"
    sign, said = _headline(answer)
    if not verdict.judged:
        sign, said = "?", f"{verdict}; this run {said}"
    elif blind and "reason" not in answer:
        sign, said = "✗", f"{BLIND}{_diverged(answer)}"
    elif sign == "✓" and verdict.sign != "✓":
        sign, said = "!", f"{said}, but the motion is {motion}"
    typed = layout.argument(name)
    following = (f"explain {typed}",) if blind else (f"analyze {typed}", f"tune {typed}")
    reserved = [f"! {sentence}" for sentence in analysis.caveats(preset)]
    helps = MATCHED if answer["diverged"] and not blind and answer["fit"]["mode"] == "constant" else None
    return Report(
        subject=layout.subject(name),
        sign=sign,
        answer=said,
        title=preset.title,
        groups=(
            *group("what ran", f"the motion: {verdict.sign} {motion}", reserved, _run(answer)),
            *group("settles", _settling(answer)),
            *group("on its ranges", _fit(answer, blind=blind)),
            *group("steady error", _errors(answer["steady"], "_rmse"), "root mean square over the last quarter"),
            *group("at the end", _errors(answer["final"], "")),
            *group("why", _note(answer, blind=blind), answer.get("reason", "").removeprefix("null: "), helps),
            *group("sensors", answer.get("unmodelled")),
            *group("saved", str(saved) if saved else None),
            *layout.next_commands(*following),
        ),
    )


def _headline(answer: Json) -> tuple[Sign, str]:
    """The worst that can be said of the run, or of so many of the runs."""
    runs = answer.get("runs", 1)
    if "reason" in answer:
        return "✗", "the estimate overflows"
    if answer["diverged"]:
        said = f"diverged: {answer['diverged_reason']}"
        return "✗", said if runs == 1 else f"{answer['runs_diverged']} of {runs} runs have diverged"
    if runs > 1 and answer["runs_fit"]["lost"]:
        return "✗", f"{answer['runs_fit']['lost']} of {runs} runs are lost: the ranges contradict them again and again"
    if answer["fit"]["word"] == "lost":
        return "✗", "lost: the ranges contradict the observer again and again"
    unsettled = [name for name in LIMITS if _settled(answer, name) < runs]
    if unsettled:
        texts = (
            f"{name} does not settle below {LIMITS[name]}"
            if runs == 1
            else f"{name} settles below {LIMITS[name]} in {_settled(answer, name)} of {runs} runs"
            for name in unsettled
        )
        return "!", " and ".join(texts)
    steady = answer["steady"]
    position, attitude = quantity(steady["position_rmse"], "m"), quantity(steady["attitude_rmse_deg"], "°")
    often = "settles" if runs == 1 else f"settles in all {runs} runs"
    return "✓", f"{often}, and is then off by {position} and {attitude}"


def _settled(answer: Json, what: str) -> int:
    """How many of the runs have settled in position or attitude."""
    if "runs_settled" in answer:
        return answer["runs_settled"][what]
    return int(answer["settle"][f"{what}_s"] is not None)


def _diverged(answer: Json) -> str:
    """That a run on a blind motion, or how many of the runs, have diverged; empty if none has."""
    if not answer["diverged"]:
        return ""
    runs = answer.get("runs", 1)
    return "; the run has diverged" if runs == 1 else f"; {answer['runs_diverged']} of {runs} runs have diverged"


def _note(answer: Json, *, blind: bool) -> str | None:
    """The note that the first line does not have already."""
    stated = answer["diverged"] and answer.get("runs", 1) == 1 and not blind
    return None if stated else answer.get("note")


def _run(answer: Json) -> list[str]:
    seed = f"seed {answer['seed']}"
    runs = f"medians of {answer['runs']} runs from {seed}" if "runs" in answer else seed
    time = quantity(answer["microseconds_per_step"], "µs")
    return [f"{answer['model']} model, {runs}", f"{answer['steps']} steps, {time} each"]


def _settling(answer: Json) -> list[str]:
    lines, runs = [], answer.get("runs", 1)
    for what, limit in LIMITS.items():
        since, count = answer["settle"][f"{what}_s"], _settled(answer, what)
        often = f" in {count} of {runs} runs" if runs > 1 else ""
        median = ", the median" if runs > 1 else ""
        lines.append(
            f"✗ {what}: {'stays' if often else 'does not stay'} below {limit} over the last tenth of the run{often}"
            if since is None
            else f"{'✓' if count == runs else '✗'} {what}: below {limit}{often}{median} from {quantity(since, 's')}"
        )
    return lines


def _fit(answer: Json, *, blind: bool) -> list[str]:
    """How the innovations look, with which gains; and what they do not tell, the error of the position."""
    residual, predicted = quantity(answer["range_residual"], "m"), plus_minus(answer["predicted"]["position"])
    lines = [answer.get("fits", answer["fit"]["words"]), answer["fit"]["gains"]]
    stated = "runs" not in answer and "from the anchor is wrong" in lines[0]
    if answer["range_residual"] and not stated:
        lines.append(f"distance from the anchor off the ranges by {residual} (rms)")
    own = plus_minus(answer["own"]["position"])
    design = ", a design quantity" if answer["fit"]["mode"] == "constant" else ""
    lines.append(f"the observer's own 1-σ at the end: position {own}{design}")
    return lines if blind else [*lines, f"predicted, after the worst window: position {predicted} (lifted)"]


def _errors(errors: Json, suffix: str) -> list[str]:
    position, attitude = quantity(errors[f"position{suffix}"], "m"), quantity(errors[f"attitude{suffix}_deg"], "°")
    velocity, gravity = quantity(errors[f"velocity{suffix}"], "m/s"), quantity(errors[f"gravity{suffix}"], "m/s²")
    return [f"position {position}, attitude {attitude}", f"velocity {velocity}, gravity {gravity}"]
