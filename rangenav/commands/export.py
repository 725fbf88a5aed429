"""`rangenav export`: a preset's motion or run for other tools, only if it delivers what it asks of its motion."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from rangenav import preset as presets
from rangenav.commands.output import print_json, print_table
from rangenav.preset import Preset

Format = Literal[
    "preset", "reference", "polynomial", "bag", "mcap", "tum", "euroc", "mat", "npz", "csv", "log", "bezier", "qgc"
]
Gate = Callable[[Preset], str | None]
"""Says why a preset may not leave the house, None if it may."""


def export(
    preset: tyro.conf.Positional[str],
    *,
    to: Format,
    output: Annotated[Path, tyro.conf.arg(aliases=["-o"], metavar="PATH")],
    attitude: Literal["flown", "preset"] = "flown",
    uncertified: bool = False,
    json: bool = False,
) -> None:
    """Write a preset's motion (reference, polynomial) or one run of it (all others) for other tools.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        to: The format; bezier and qgc only say why they are not written.
        output: File to write; a folder for bag and euroc.
        attitude: For reference: what flying the path takes, or the preset's own.
        uncertified: Write it although the preset misses its requirement; the name then says so.
        json: Print one JSON object.
    """
    from rangenav.formats import requirement

    found = exported(
        presets.load(preset),
        to,
        output,
        name=preset,
        attitude=attitude,
        uncertified=uncertified,
        gate=requirement.unmet,
    )
    return print_json(found) if json else print_table(f"{preset} as {to}", found)


def exported(
    chosen: Preset, to: str, output: Path, *, name: str, attitude: str, uncertified: bool, gate: Gate
) -> dict[str, Any]:
    """Write the files if the gate lets the preset through, and say what was written. Raises ValueError if it does not.

    What is written in spite of the gate has "uncertified" in its name and in its report.
    """
    from rangenav import formats

    complaint = None if to in formats.REFUSED else gate(chosen)
    if complaint is not None and not uncertified:
        raise ValueError(f"{name}: {complaint}; nothing was written (--uncertified writes it all the same, marked)")
    if complaint is not None:
        output = formats.marked(output)
    written = formats.export(chosen, to, output, attitude=attitude)
    if complaint is not None:
        written = replace(written, notes=(f"UNCERTIFIED: {complaint}", *written.notes))
    report: dict[str, Any] = {
        "preset": name,
        "format": to,
        "files": [str(file) for file in written.files],
        "frame": written.frame,
        "uncertified": complaint is not None,
        **written.figures,
    }
    if written.steady is not None:
        begin, end = written.steady
        covered = f"any certificate covers {begin:g} s to {end:.6g} s of the file, between its ramps, and no more"
        report |= {"steady": {"from": begin, "to": end}, "notes": [covered if begin else "no ramps", *written.notes]}
    else:
        report["notes"] = list(written.notes)
    return report
