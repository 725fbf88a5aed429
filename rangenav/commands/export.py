"""`rangenav export`: a preset's motion or run for other tools, only if it delivers what it asks of its motion."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from rangenav import formats
from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json
from rangenav.commands.progress import working

if TYPE_CHECKING:
    from rangenav.certificate.certified_export import CertifiedExport  # imported when used: it takes long

    FormatName = str
else:
    FormatName = Literal[tuple(row.name for row in (*formats.writable(), *formats.unsupported()))]
TO = f"The format; {formats.names(formats.unsupported())} only say why they are not written."
OUTPUT = f"File to write; a folder for {formats.names(tuple(row for row in formats.writable() if row.folder))}."
OTHERWISE = "--uncertified writes it all the same, marked"


def export(
    preset: PresetName,
    *,
    to: Annotated[FormatName, tyro.conf.arg(help=TO)],
    output: Annotated[Path, tyro.conf.arg(aliases=["-o"], metavar="PATH", help=OUTPUT)],
    attitude: Literal["flown", "preset"] = "flown",
    ramp: float = formats.RAMP,
    once: bool = False,
    loop: bool = False,
    window: float | None = None,
    slower: float | None = None,
    duration: float | None = None,
    uncertified: bool = False,
    json: bool = False,
) -> None:
    """Write a preset, its motion or one run of it for other tools.

    Example: rangenav export paper-slow --to reference -o path.csv

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        attitude: For reference: what flying the path takes, or the preset's own.
        ramp: For reference and polynomial: seconds from hover into the path, and back to hover.
        once: For polynomial: the flight as long as the pieces last, also of a path that repeats; no loop.
        loop: Fly a path of pieces again and again that ends where it begins.
        window: Window δ (s) over which the motion is judged, instead of the preset's.
        slower: Fly the motion so many times slower.
        duration: Fly so many seconds, instead of the preset's.
        uncertified: Write it although the preset misses its requirement; the name then says so.
        json: Print one JSON object.
    """
    from rangenav.certificate import certified_export, cures
    from rangenav.commands.text import exchange as text
    from rangenav.commands.text import layout

    chosen = cures.changed(
        presets.load(preset), source=preset, loop=loop, window=window, slower=slower, duration=duration
    )
    with working(f"exporting {preset}"):
        try:
            export = certified_export.write(
                chosen,
                to,
                output,
                name=preset,
                attitude=attitude,
                ramp=ramp,
                once=once,
                uncertified=uncertified,
                otherwise=OTHERWISE,
            )
        except certified_export.RefusedExportError as error:
            raise ValueError(f"{error}; {text.cured(cures.cures(error), preset, to, output)}") from None
    answer = report(export, preset, to)
    return print_json(answer) if json else layout.show(text.exported(chosen, answer, name=preset))


def report(export: "CertifiedExport", name: str, to: str) -> dict[str, Any]:
    """The JSON object of an export of the preset `name` to the format `to`."""
    written = export.output
    answer: dict[str, Any] = {
        "preset": name,
        "format": to,
        "files": [str(file) for file in written.files],
        "frame": written.frame,
        "uncertified": export.complaint is not None,
        **written.figures,
    }
    if export.certificate is None:
        answer |= {"certificate": None, "certificate_reason": f"null: {export.reason}"}
    else:
        answer["certificate"] = str(export.certificate)
    if written.steady is not None:
        begin, end = written.steady
        answer["steady"] = {"from": begin, "to": end}
        if written.loop:
            first, count = answer.pop("loop_first"), answer.pop("loop_pieces")
            answer["loop"] = {"from": begin, "to": end, "first_piece": first + 1, "pieces": count}
    return answer | {"notes": list(export.notes)}
