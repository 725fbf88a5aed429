"""`rangenav explain`: why a motion is observable or not, how long it must be flown, and its evil twin."""

from pathlib import Path
from typing import Annotated

import msgspec
import tyro

from rangenav import preset as presets
from rangenav.commands.output import PresetName, print_json, require_place
from rangenav.commands.progress import working
from rangenav.twin import APART, TOLERANCE


def explain(
    preset: PresetName,
    *,
    window: float | None = None,
    tolerance: float = TOLERANCE,
    apart: float = APART,
    save: Annotated[Path | None, tyro.conf.arg(metavar="TWIN.toml")] = None,
    json: bool = False,
) -> None:
    """Say why a preset's motion is observable or not, how long it must be flown, and where its evil twin flies.

    Example: rangenav explain circle --save twin.toml

    The page docs/certificates.md has the conditions of each verdict, and what a certificate promises.

    Args:
        preset: A shipped preset's name or a path to a TOML file.
        window: Window δ in seconds; the preset's own by default.
        tolerance: How well the twin's range must agree, in metres.
        apart: How far off the twin must be, in metres (RMS over the flight).
        save: Write the preset that flies the twin here.
        json: Print one JSON object.
    """
    from rangenav import analysis, explanation, twin
    from rangenav.commands.text import explain as text
    from rangenav.commands.text import layout

    chosen = presets.load(preset)
    if window is not None:
        chosen = presets.with_window(chosen, window, source=f"{preset}, --window")
    require_place("--save", save, ".toml")
    with working(f"looking for a twin of {preset}"):
        outcome = twin.twin(chosen, tolerance=tolerance, apart=apart)
    if save is not None:
        if isinstance(outcome, twin.Refusal):
            raise ValueError(f"--save: {preset} has no twin to write: {outcome.reason}")
        title = f"Twin of {chosen.title}"[: presets.MAX_TITLE]
        presets.save(msgspec.structs.replace(chosen, path=outcome.path, title=title), save)
    with working(f"explaining {preset}"):
        answer = explanation.explanation(chosen, outcome, name=preset)
    if json:
        return print_json(answer)
    return layout.show(text.report(chosen, analysis.analyse(chosen), answer, name=preset, window=window))
