"""`rangenav repair`: the smallest change that makes a motion observable, as a new preset."""

import sys
from pathlib import Path
from typing import Annotated, Literal

import tyro

from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json, print_table, require_place


def repair(
    preset: PresetName,
    *,
    by: Literal["tones", "amplitude", "frequency", "timescale", "waypoints"] = "tones",
    improve: bool = False,
    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"], metavar="NEW.toml")] = None,
    json: bool = False,
) -> None:
    """Make a motion observable by the smallest change of one kind, within its vehicle's limits.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        by: The kind of change: added tones, the path's size, its tones' frequencies, its speed, or its waypoints.
        improve: Lower the predicted error of a motion that is observable already.
        output: Write the changed preset here.
        json: Print one JSON object.
    """
    from rangenav import repair as repairing

    require_place("--output", output, ".toml")
    chosen = presets.load(preset)
    try:
        found = repairing.improve(chosen, by=by) if improve else repairing.repair(chosen, by=by)
    except repairing.CannotRepairError as error:
        print(f"{preset}: {error}", file=sys.stderr)
        raise SystemExit(1) from None
    if output is not None:
        presets.save(found.after, output)
    report = repairing.report(found, name=preset)
    return print_json(report) if json else print_table(f"{chosen.title}: {found.words}", report)
