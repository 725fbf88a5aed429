"""`rangenav export` and `rangenav import` for a person."""

import re
from pathlib import Path

from rangenav.analysis import Analysis
from rangenav.certificate.cures import Cure
from rangenav.commands.text import layout
from rangenav.commands.text.analyze import excitation_lines
from rangenav.commands.text.layout import Report, group
from rangenav.commands.text.verdict import Json, flight_lines, headline, unjudged_help
from rangenav.number_format import quantity
from rangenav.preset import Preset

PLACEHOLDER = re.compile(r"NAME|OUT\.csv|NEW\.toml")
"""What stands in a cure's command for the names that were typed."""
UNCHANGED = re.compile(r"μ changed by [+-]0\.00%")
"""What a note says of a change that its digits do not show."""
ANSWERED = {
    "preset",
    "format",
    "files",
    "frame",
    "uncertified",
    "certificate",
    "certificate_reason",
    "steady",
    "loop",
    "notes",
}
"""Keys of an export's answer that a group of their own tells; the others are figures of the format."""


def exported(preset: Preset, answer: Json, *, name: str) -> Report:
    """What was written and whether it is certified; `answer` is the command's JSON object."""
    marked = answer["uncertified"]
    written = f"written as {answer['format']}"
    reason = answer.get("certificate_reason", "").removeprefix("null: ")
    proof = [answer["certificate"] or f"none: {reason.removeprefix(f'{preset.title}: refused: ')}"]
    return Report(
        subject=layout.subject(name),
        sign="!" if marked else "✓",
        answer=f"{written}, UNCERTIFIED" if marked else written,
        title=preset.title,
        groups=(
            *group("files", answer["files"]),
            *group("frame", answer["frame"]),
            *group("certificate", proof),
            *group("size", _figures(answer)),
            *group("to be known", _notes(answer)),
            *layout.next_commands(
                f"repair {layout.argument(name)} -o repaired.toml"
                if marked
                else f"verify {layout.argument(answer['files'][0])}"
            ),
        ),
    )


def cured(cures: tuple[Cure, ...], name: str, format_name: str, output: Path) -> str:
    """What would cure a refused export, as a clause with a command for each cure."""
    typed = {"NAME": layout.argument(name), "OUT.csv": layout.argument(output), "NEW.toml": "repaired.toml"}
    each = [f"{cure.text}: rangenav {PLACEHOLDER.sub(lambda found: typed[found[0]], cure.command)}" for cure in cures]
    if not each:
        search = f"rangenav repair {typed['NAME']} --export {format_name} -o repaired.toml"
        return f"no small change cures that; a search for a larger one: {search}"
    return f"what cures it: {'; or '.join(each)}"


def _notes(answer: Json) -> list[str]:
    """The notes of an export. A marked file has no certificate, whose reason its own group gives."""
    notes = [UNCHANGED.sub("μ unchanged", note) for note in answer["notes"]]
    if not answer["uncertified"]:
        return [note.replace("any certificate covers", "the certificate covers") for note in notes]
    begin, end = (
        (quantity(answer["steady"][key], "s", digits=5) for key in ("from", "to")) if "steady" in answer else ("", "")
    )
    ramps = [f"the motion itself is {begin} to {end} of the file, between its ramps"] if begin else []
    return [*ramps, *(note for note in notes if not note.startswith(("UNCERTIFIED:", "any certificate covers")))]


def _figures(answer: Json) -> list[str]:
    """Counts that no note tells: rows, messages, pieces."""
    counts = {key: value for key, value in answer.items() if key not in ANSWERED and isinstance(value, int)}
    notes = " ".join(answer["notes"])
    return [f"{value} {key}" for key, value in counts.items() if str(value) not in notes]


def imported(made: Preset, analysis: Analysis, answer: Json, *, source: str) -> Report:
    """How a file was understood, and what its path lets one range tell; `answer` is the command's JSON object."""
    sign, said = headline(made, analysis)
    output = layout.argument(Path(answer["preset"]))
    sampled, fit = answer["rate"] is not None, answer["fit_error"]
    rows = f"rows at {quantity(answer['rate'], 'Hz')}" if sampled else "pieces without samples"
    length, used = quantity(answer["duration"], "s"), quantity(answer["used"], "s")
    frame = "" if answer["frame"] in " ".join(answer["findings"]) else f", {answer['frame']}"
    part = "" if made.path.period or used == length else f", {used} of {length} used"
    near = "the file's own" if fit is None else f"within {quantity(fit, 'm')} of every position of the file"
    seen = [f"rank {analysis.rank} of 13", *excitation_lines(made, analysis)] if analysis.verdict.judged else []
    return Report(
        subject=source,
        sign=sign,
        answer=said,
        groups=(
            *group(
                "the file",
                f"{answer['format']}, {rows}{frame}{part}",
                answer["findings"],
            ),
            *group("the path", near, f"snap from {answer['snap_from']}"),
            *group("assumed", answer["assumed"], "other values: --anchor, --window, --duration, --ends"),
            *group("what can be seen", seen),
            *group("can it be flown", flight_lines(made), f"attitude: {answer['attitude']}"),
            *group("would help", unjudged_help(made)),
            *group("written", answer["preset"]),
            *layout.next_commands(
                *(() if sign == "✓" else (f"repair {output} -o repaired.toml",)),
                f"analyze {output}",
                f"explain {output}",
            ),
        ),
    )


def copied(source: Path, output: Path) -> Report:
    """A preset that was read, checked and written again."""
    typed = layout.argument(output)
    return Report(
        subject=layout.subject(source),
        sign="✓",
        answer="is a preset already; it was checked and written again",
        groups=(*group("written", str(output)), *layout.next_commands(f"analyze {typed}")),
    )
