"""`rangenav repair`: a small change that makes a motion observable, as a new preset."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
import tyro

from rangenav import formats
from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json, require_place
from rangenav.commands.progress import working
from rangenav.inputs import require
from rangenav.vehicle import BY_NAME

if TYPE_CHECKING:
    FormatName = str
    VehicleName = str
else:
    VehicleName = Literal[tuple(BY_NAME)]
    FormatName = Literal[tuple(row.name for row in formats.writable())]


def repair(
    preset: PresetName,
    *,
    by: Literal["tones", "amplitude", "frequency", "timescale", "waypoints"] = "tones",
    improve: bool = False,
    export: FormatName | None = None,
    ramp: float = formats.RAMP,
    vehicle: VehicleName | None = None,
    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"], metavar="NEW.toml")] = None,
    json: bool = False,
) -> None:
    """Make a motion observable by a small change of one kind, within its vehicle's limits.

    Example: rangenav repair circle --by tones -o round.toml

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        by: The kind of change: added tones, the path's size, its tones' frequencies, its speed, or its waypoints.
        improve: Lower the predicted error of a motion that is observable already.
        export: Accept only a motion that can be exported to this format with a certificate.
        ramp: Seconds of the ramps of that export.
        vehicle: The vehicle whose limits are kept, instead of the preset's.
        output: Write the changed preset here.
        json: Print one JSON object.
    """
    from rangenav import repair as repairing
    from rangenav.commands.text import layout
    from rangenav.commands.text import repair as text

    require_place("--output", output, ".toml")
    require(not (improve and export), "--improve and --export exclude each other: repair first, then improve")
    chosen = presets.load(preset)
    if vehicle is not None:
        chosen = msgspec.structs.replace(chosen, vehicle=BY_NAME[vehicle])
    options = formats.export_options(ramp=ramp)
    target = None if export is None else repairing.ExportTarget(format_name=export, options=options)
    try:
        with working(f"looking for a change of {preset}"):
            repaired = repairing.improve(chosen, by=by) if improve else repairing.repair(chosen, by=by, target=target)
    except repairing.CannotRepairError as error:
        print(f"{preset}: {error}", file=sys.stderr)
        raise SystemExit(1) from None
    if output is not None:
        presets.save(repaired.after, output)
    answer = repairing.report(repaired, name=preset)
    if export is not None:
        answer["export"] = export
    return print_json(answer) if json else layout.show(text.report(chosen, answer, name=preset, written=output))
