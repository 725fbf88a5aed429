"""`rangenav repair`: the smallest change that makes a motion observable, as a new preset."""

import sys
from pathlib import Path
from typing import Annotated, Literal

import tyro

from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json, require_place
from rangenav.commands.progress import working


def repair(
    preset: PresetName,
    *,
    by: Literal["tones", "amplitude", "frequency", "timescale", "waypoints"] = "tones",
    improve: bool = False,
    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"], metavar="NEW.toml")] = None,
    json: bool = False,
) -> None:
    """Make a motion observable by the smallest change of one kind, within its vehicle's limits.

    Example: rangenav repair circle --by tones -o round.toml

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        by: The kind of change: added tones, the path's size, its tones' frequencies, its speed, or its waypoints.
        improve: Lower the predicted error of a motion that is observable already.
        output: Write the changed preset here.
        json: Print one JSON object.
    """
    from rangenav import repair as repairing
    from rangenav.commands.text import layout
    from rangenav.commands.text import repair as text

    require_place("--output", output, ".toml")
    chosen = presets.load(preset)
    try:
        with working(f"looking for a change of {preset}"):
            repaired = repairing.improve(chosen, by=by) if improve else repairing.repair(chosen, by=by)
    except repairing.CannotRepairError as error:
        print(f"{preset}: {error}", file=sys.stderr)
        raise SystemExit(1) from None
    if output is not None:
        presets.save(repaired.after, output)
    answer = repairing.report(repaired, name=preset)
    return print_json(answer) if json else layout.show(text.report(chosen, answer, name=preset, written=output))
