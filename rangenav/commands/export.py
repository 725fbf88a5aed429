"""`rangenav export`: a preset's motion or run for other tools, only if it delivers what it asks of its motion."""

import shutil
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from rangenav import formats
from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json, print_table
from rangenav.preset import Preset

if TYPE_CHECKING:
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
    uncertified: bool = False,
    json: bool = False,
) -> None:
    """Write a preset, its motion or one run of it for other tools.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        attitude: For reference: what flying the path takes, or the preset's own.
        uncertified: Write it although the preset misses its requirement; the name then says so.
        json: Print one JSON object.
    """
    found = exported(presets.load(preset), to, output, name=preset, attitude=attitude, uncertified=uncertified)
    return print_json(found) if json else print_table(f"{preset} as {to}", found)


def exported(
    chosen: Preset,
    to: str,
    output: Path,
    *,
    name: str,
    attitude: str = "flown",
    uncertified: bool = False,
    otherwise: str = OTHERWISE,
) -> dict[str, Any]:
    """Write a file or folder and its certificate, and say what was written; the command line and the page come by here.

    Raises ValueError, and nothing is written, if the gate does not let the preset through; with `uncertified` it is
    written all the same, with "uncertified" in its name and in what is said, and without a certificate. `otherwise`
    says how to ask for that.
    """
    from rangenav.certificate import exports as certificates

    row = formats.row(to)
    complaint = None if row.unsupported else certificates.gate(chosen, to)
    if complaint is not None and not uncertified:
        raise ValueError(f"{name}: {complaint}; nothing was written ({otherwise})")
    if complaint is not None:
        output = formats.marked(output)
    written = formats.export(chosen, to, output, attitude=attitude)
    report: dict[str, Any] = {
        "preset": name,
        "format": to,
        "files": [str(file) for file in written.files],
        "frame": written.frame,
        "uncertified": complaint is not None,
        **written.figures,
    }
    if complaint is not None:
        written = replace(written, notes=(f"UNCERTIFIED: {complaint}", *written.notes))
        report |= {"certificate": None, "certificate_reason": f"null: {complaint}"}
    elif row.certified_as == "neither":
        report |= {"certificate": None, "certificate_reason": f"null: nothing in a file of {to} can be certified"}
    else:
        place = _certificate(chosen, to, output, name=name, steady=written.steady, attitude=attitude)
        report["certificate"] = str(place)
    return report | _covered(written)


def _certificate(
    chosen: Preset, to: str, output: Path, *, name: str, steady: tuple[float, float] | None, attitude: str
) -> Path:
    """The certificate of what was written, from its bytes. Raises ValueError, and takes it away, if it fails."""
    from rangenav.certificate import exports as certificates

    try:
        found = certificates.certified(chosen, to, output, steady=steady, attitude=attitude)
        if not found.certified:
            raise ValueError(f"{name}: as {to} it does not keep what it promises: {'; '.join(found.failures)}")
        return certificates.write_beside(found, output)
    except BaseException:
        if output.is_dir():
            shutil.rmtree(output)
        else:
            output.unlink(missing_ok=True)
        raise


def _covered(written: Any) -> dict[str, Any]:
    """What of the file a certificate speaks of, and what is to be known about it."""
    if written.steady is None:
        return {"notes": list(written.notes)}
    begin, end = written.steady
    covered = f"any certificate covers {begin:g} s to {end:.6g} s of the file, between its ramps, and no more"
    return {"steady": {"from": begin, "to": end}, "notes": [covered if begin else "no ramps", *written.notes]}
