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
    from rangenav.certificate import exported as certificates

    chosen = presets.load(preset)
    found = exported(
        chosen,
        to,
        output,
        name=preset,
        attitude=attitude,
        uncertified=uncertified,
        gate=lambda asked: certificates.gate(asked, to),
    )
    if not found["uncertified"]:
        found |= _certified(chosen, to, found, name=preset)
    return print_json(found) if json else print_table(f"{preset} as {to}", found)


def _certified(chosen: Preset, to: str, report: dict[str, Any], *, name: str) -> dict[str, Any]:
    """The certificate of what was written, beside it. Raises ValueError, and takes the file away, if it fails."""
    from rangenav.certificate import exported as certificates

    file, steady = Path(report["files"][0]), report.get("steady")
    ends = None if steady is None else (steady["from"], steady["to"])
    found = certificates.certified(chosen, to, file, steady=ends)
    if found is None:
        return {"certificate": None, "certificate_reason": f"null: a {to} folder has no bytes of its own"}
    if not found.certified:
        file.unlink()
        raise ValueError(f"{name}: as {to} it does not keep what it promises: {'; '.join(found.failures)}")
    return {"certificate": str(certificates.write_beside(found, file))}


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
